"""Sums over the parts are assembled once for each state."""

import itertools

import numpy as np
import pytest
from dolfinx import cpp, fem
from dolfinx.fem import petsc as fem_petsc

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Fabric,
    Membrane,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.assembly.actions import unloaded
from fx_membrane.assembly.problem import Problem


def square() -> Structure:
    points, triangles = rectangle(1.0, 1.0, 4, 4)
    fabric = Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3)
    return Structure(points, {"fabric": fabric}, [Support(np.unique(boundary_edges(triangles)))])


@pytest.fixture
def calls(monkeypatch):
    """Forms that were assembled or packed, each with the displacement on this process, in order."""
    seen = []

    def record(owner, name, kind):
        function = getattr(owner, name)

        def counted(*args, **kwargs):
            for form in (getattr(a, "_cpp_object", a) for a in args):
                if hasattr(form, "coefficients"):  # not an expression, which 0.11 packs by the same function
                    seen.append((kind, form.coefficients[0].x.array.tobytes()))
            return function(*args, **kwargs)

        monkeypatch.setattr(owner, name, counted)

    record(fem, "assemble_scalar", "energy")
    record(fem_petsc, "assemble_matrix", "tangent")
    record(cpp.fem, "pack_coefficients", "packing")
    return seen


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", ["energy", "tangent", "packing"])
def test_no_state_of_a_run_is_assembled_or_packed_twice(calls, kind):
    load = DistributedLoad((0, 0, -500.0), "fabric")
    analysis = Analysis(square(), progress=False)
    calls.clear()
    analysis.run([Stage("load", [load], increments=2)])
    states = [state for what, state in calls if what == kind]
    assert len(states) > 6
    assert all(a != b for a, b in itertools.pairwise(states))


@pytest.mark.mpi
def test_kept_sums_follow_displacement_actions_and_reference_shape():
    structure = square()
    problem = Problem(structure)
    rng = np.random.default_rng(0)
    x, y = (problem.to_petsc(0.01 * rng.normal(size=structure.points.shape)) for _ in range(2))
    loaded = Problem(structure).actions_of(Stage("wind", [Pressure(100.0, "fabric")]))
    views = [problem.under(), problem.under(loaded), problem.under().without_compression_stiffness()]

    def values(view, at):
        return view.energy(at), problem.to_numpy(view.residual(at))

    def fresh(index, at):
        other = Problem(structure)
        view = [other.under(), other.under(loaded), other.under().without_compression_stiffness()][index]
        return view.energy(at), other.to_numpy(view.residual(at))

    for index, at in [(0, x), (0, x), (1, x), (1, y), (2, y), (0, y), (0, x)]:
        found, expected = values(views[index], at), fresh(index, at)
        assert found[0] == pytest.approx(expected[0], rel=1e-14)
        assert np.allclose(found[1], expected[1], rtol=0, atol=1e-13 * np.abs(expected[1]).max())
    before = views[0].energy(x)
    problem.discretization.move(2 * structure.points)
    assert views[0].energy(x) != pytest.approx(before, rel=1e-3)
    problem.discretization.move(structure.points)
    assert views[0].energy(x) == before
    assert problem.under(unloaded(structure)).energy(x) == before
