"""Form finding with prescribed stress: the form is in equilibrium, and an analysis takes it over unchanged."""

import numpy as np
import pytest
from mpi4py import MPI

from constrained import assert_last_good
from films import FABRIC, RIM, TRIANGLES, film, film_with_edge_cables, inflated, loaded, weighed_down, woven
from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    UnsettledFormWarning,
    polyline,
    updated_reference,
)
from fx_membrane.geometry.sizes import measures

MODELS = [film, film_with_edge_cables, woven, inflated, loaded, weighed_down]


@pytest.fixture(scope="module", params=MODELS, ids=lambda model: model.__name__)
def found(request):
    structure, loads = request.param()
    return structure, loads, updated_reference(structure, loads)


@pytest.mark.mpi_once
def test_found_form_is_in_equilibrium_as_it_is(found):
    _, loads, form = found
    assert form.converged
    (result,) = Analysis(form.structure).run([Stage("form", loads)]).values()
    size = np.ptp(form.structure.points, axis=0).max()
    assert np.abs(result.displacement).max() < 1e-12 * size
    assert result.equilibrium.residual <= 1e-8 * np.abs(result.reactions).max()


@pytest.mark.mpi_once
@pytest.mark.parametrize(("others", "tolerance"), [([], 1e-3), ([], 1e-6), ([PointLoad(7, (30.0, 50, -200))], 1e-3)])
def test_hanging_cable_is_in_equilibrium_as_it_is(others, tolerance):
    structure, loads = hanging_cable()
    loads += others
    form = updated_reference(structure, loads, tolerance=tolerance, max_iterations=300)
    (result,) = Analysis(form.structure).run([Stage("form", loads)]).values()
    assert np.abs(result.displacement).max() < 1e-12 * 10
    assert result.history[0][1].residual <= 1e-9 * np.abs(result.reactions).max()


def test_form_is_another_shape_on_the_same_supports(found):
    structure, _, form = found
    moved = np.abs(form.structure.points - structure.points).max(axis=1)
    assert moved.max() > 0.01
    assert not moved[structure.supported.all(axis=1)].any()
    assert list(form.structure.parts) == list(structure.parts)
    for name, part in structure.parts.items():
        assert np.array_equal(form.structure.parts[name].cells, part.cells)
        assert type(form.structure.parts[name]) is type(part)


def test_prestress_is_nearly_the_prescribed_one(found):
    structure, _, form = found
    last = form.steps[-1]
    for name, part in structure.parts.items():
        wanted = part.prestress_tensors()
        error = np.abs(form.structure.parts[name].prestress_tensors() - wanted).max() / np.abs(wanted).max()
        assert error <= last.stress_error * (1 + 1e-12)
    assert last.stress_error < 0.2


def test_steps_tell_area_and_change(found):
    structure, _, form = found
    area = measures(form.structure.points, structure.parts["film"].cells).sum()
    assert form.steps[-1].area == pytest.approx(area, rel=1e-12)
    assert form.steps[-1].change < form.steps[0].change
    assert form.steps[-1].change <= 1e-3


def test_result_of_an_analysis_has_the_found_stress(found):
    _, loads, form = found
    (result,) = Analysis(form.structure).run([Stage("form", loads)]).values()
    stress = form.structure.parts["film"].prestress_tensors()
    values = np.linalg.eigvalsh(stress)[:, ::-1]
    assert result.membrane("film").principal == pytest.approx(values, rel=1e-6)
    threads = stress[:, [0, 1], [0, 1]]
    assert result.membrane("film").warp_weft_stress == pytest.approx(threads, rel=1e-6)
    for name, part in form.structure.parts.items():
        if part.dimension == 1:
            assert result.cable(name).force == pytest.approx(part.prestress_tensors().ravel(), rel=1e-6)


@pytest.mark.mpi
@pytest.mark.parametrize("model", MODELS)
def test_all_processes_together_find_what_one_finds(model):
    structure, loads = model()
    together = updated_reference(structure, loads, comm=MPI.COMM_WORLD)
    alone = updated_reference(structure, loads, comm=MPI.COMM_SELF)
    size = np.ptp(structure.points, axis=0).max()
    assert len(together.steps) == len(alone.steps)
    assert together.structure.points == pytest.approx(alone.structure.points, abs=1e-9 * size)
    for name, part in alone.structure.parts.items():
        stress = part.prestress_tensors()
        mine = together.structure.parts[name].prestress_tensors()
        assert mine == pytest.approx(stress, abs=1e-9 * np.abs(stress).max())


def test_orthotropic_prestress_follows_warp_and_weft():
    form = updated_reference(*woven())
    stress = form.structure.parts["film"].prestress_tensors()
    assert (stress[:, 1, 1] / stress[:, 0, 0]).mean() == pytest.approx(2, rel=0.05)


@pytest.mark.mpi
def test_distributed_load_is_per_area_of_the_form():
    # The area of the form is larger than that of the flat start.
    loads = [Pressure(2500.0, "film"), DistributedLoad((0, 0, -100.0), "film")]
    form = updated_reference(inflated()[0], loads)
    assert form.converged
    assert form.steps[-1].area > 1.1 * 4
    (result,) = Analysis(form.structure).run([Stage("form", loads)]).values()
    assert result.actions.loads[:, 2].sum() == pytest.approx(-100.0 * form.steps[-1].area, rel=1e-12)


def hanging_cable(load=100.0):
    points = np.column_stack([np.linspace(0, 10, 21), np.zeros((21, 2))])
    cable = Cable(polyline(np.arange(21)), 1e7, prestress=5e3)
    return Structure(points, {"cable": cable}, [Support([0, 20])]), [DistributedLoad((0, 0, -load), "cable")]


def test_stress_of_a_hanging_cable_is_not_the_prescribed_one():
    # No constant force balances a weight along the cable: between two points it changes by weight times height.
    structure, loads = hanging_cable()
    form = updated_reference(structure, loads, tolerance=1e-6, max_iterations=300)
    force = form.structure.parts["cable"].prestress
    assert np.ptp(force) > 0
    assert form.steps[-1].stress_error == pytest.approx(np.abs(force - 5e3).max() / 5e3, rel=1e-12)
    horizontal = force * np.diff(form.structure.points[:, 0]) / measures(form.structure.points, polyline(range(21)))
    assert horizontal == pytest.approx(horizontal[0], rel=1e-9)


def test_distributed_load_that_grows_faster_than_the_prestress_holds():
    structure, loads = hanging_cable(load=4000.0)
    with pytest.warns(UnsettledFormWarning, match=r"Form finding.*no shape.*4000 on part 'cable'.*larger prestress"):
        form = updated_reference(structure, loads)
    assert_last_good(form, loads)


def test_structure_that_is_found_is_found_again():
    structure, _ = film()
    form = updated_reference(structure)
    again = updated_reference(form.structure, tolerance=1e-6)
    assert len(again.steps) == 1
    assert again.structure.points == pytest.approx(form.structure.points, abs=1e-9)


@pytest.mark.mpi
def test_too_few_steps_are_in_equilibrium_all_the_same():
    structure, loads = film_with_edge_cables()
    if MPI.COMM_WORLD.rank:  # the first process warns for all
        form = updated_reference(structure, loads, max_iterations=1)
    else:
        message = (
            r"^The form has not settled: step 1, the last, .* than the tolerance 0\.001; .* \(max_iterations=\.\.\."
        )
        with pytest.warns(UnsettledFormWarning, match=message) as found:
            form = updated_reference(structure, loads, max_iterations=1)
        assert [entry.filename for entry in found] == [__file__]
    assert not form.converged
    assert len(form.steps) == 1
    (result,) = Analysis(form.structure).run([Stage("form")]).values()
    assert np.abs(result.displacement).max() < 1e-9 * 2


def test_elasticity_does_not_matter():
    forms = []
    for fabric in (FABRIC, Fabric(Et=1.0, nu=0.0)):
        points = film()[0].points
        structure = Structure(points, {"film": Membrane(TRIANGLES, fabric, prestress=2e3)}, [Support(RIM)])
        forms.append(updated_reference(structure))
    assert forms[1].structure.points == pytest.approx(forms[0].structure.points, abs=1e-9)


@pytest.mark.parametrize("make", [film_with_edge_cables, woven, inflated])
def test_form_tells_its_forces_and_reactions(make):
    structure, loads = make()
    form = updated_reference(structure, loads)
    assert form.points is form.structure.points or np.array_equal(form.points, form.structure.points)
    rest = Analysis(form.structure).run([Stage("rest", loads)])["rest"]
    for name, part in form.structure.parts.items():
        assert np.array_equal(
            form.forces[name].reshape(len(part.cells), -1), part.prestress_tensors().reshape(len(part.cells), -1)
        )
    assert form.reactions == pytest.approx(rest.reactions, abs=1e-7 * np.abs(rest.reactions).max())


def test_input_is_not_changed():
    structure, loads = film()
    points = structure.points.copy()
    updated_reference(structure, loads)
    assert np.array_equal(structure.points, points)
    assert structure.parts["film"].prestress_tensors().tolist() == [[[2e3, 0], [0, 2e3]]] * len(TRIANGLES)
