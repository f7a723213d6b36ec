"""A process keeps the code of its forms for the next structure; formulas that differ share none."""

import gc
import os
import weakref
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
import ufl
from dolfinx import fem

from fx_membrane import (
    Analysis,
    Axial,
    Cable,
    Fabric,
    Membrane,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    _dolfinx,
    boundary_edges,
    rectangle,
)
from kinds_of_structures import KINDS, run, structure


@pytest.mark.mpi_once
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.filterwarnings("ignore::fx_membrane.UnstableStateWarning")
def test_next_structure_loads_no_code(kind, searches):
    for n in (2, 3):  # the first compiles, in a cold cache
        run(n, **KINDS[kind])
    searches.clear()
    run(4, **KINDS[kind])
    assert searches == []


@dataclass(frozen=True)
class Stiff:
    """Law with a number in its formula that is no parameter."""

    EA: float
    factor: ClassVar[float] = 1.0

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + self.factor * parameters.EA * E[0, 0] ** 2 / 2

    @property
    def stiffness(self):
        return self.EA


@dataclass(frozen=True)
class Twice(Stiff):
    factor: ClassVar[float] = 2.0
    energy = Stiff.energy


@dataclass(frozen=True)
class Cubic(Stiff):
    """Law of another class with the same fields."""

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + parameters.EA * (E[0, 0] ** 2 / 2 + E[0, 0] ** 3 / 3)


@dataclass(frozen=True)
class Fixed(Stiff):
    """Law with its number in the formula."""

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + self.EA * E[0, 0] ** 2 / 2


def bar_force(law):
    """Force of a bar stretched to l = 1.5, divided by the stretch: the 2nd Piola-Kirchhoff stress at E = 0.625."""
    bar = Structure([(0, 0, 0), (1, 0, 0)], {"bar": Cable([[0, 1]], prestress=10.0, material=law)}, [Support([0])])
    pulled = Stage("pulled", displacements=[PrescribedDisplacement(1, (0.5, 0, 0))])
    return Analysis(bar).run([pulled])["pulled"].parts["bar"].force[0] / 1.5


@pytest.mark.mpi
def test_laws_with_other_numbers_in_their_formulas_share_no_form(monkeypatch):
    e = 0.625
    for _ in range(2):
        assert bar_force(Stiff(100.0)) == pytest.approx(10 + 100 * e, rel=1e-12)
        assert bar_force(Twice(100.0)) == pytest.approx(10 + 200 * e, rel=1e-12)
        assert bar_force(Cubic(100.0)) == pytest.approx(10 + 100 * (e + e**2), rel=1e-12)
        assert bar_force(Axial(100.0)) == pytest.approx(10 + 100 * e, rel=1e-12)
        for EA in (100.0, 300.0):
            assert bar_force(Fixed(EA)) == pytest.approx(10 + EA * e, rel=1e-12)
    monkeypatch.setattr(Stiff, "factor", 2.0)
    assert bar_force(Stiff(100.0)) == pytest.approx(10 + 200 * e, rel=1e-12)


@pytest.mark.mpi
def test_terms_with_other_numbers_in_their_formulas_share_no_form():
    def sag(factor):
        @dataclass(frozen=True)
        class Weight:
            part: str
            p: float

            def energy(self, state, parameters):
                return factor * parameters.p * state.u[2]

        points, triangles = rectangle(1.0, 1.0, 2, 2)
        edge = Support(np.unique(boundary_edges(triangles)))
        sheet = Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3)
        loads = Analysis(Structure(points, {"sheet": sheet}, [edge], terms=[Weight("sheet", 2.0)])).run(
            [Stage("own weight")]
        )
        return loads["own weight"].equilibrium.loads[2]

    assert [sag(factor) for factor in (1.0, 3.0, 1.0)] == pytest.approx([-2.0, -6.0, -2.0], rel=1e-12)


@dataclass(frozen=True)
class Tuned(Stiff):
    """Law that closes over a value that changes."""

    tuning: ClassVar[list] = [1.0]

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + self.tuning[-1] * parameters.EA * E[0, 0] ** 2 / 2


@pytest.mark.mpi
def test_value_that_changes_in_a_formula_makes_another_form():
    for tuning in (1.0, 2.0, 1.0):  # formulas of the laws above, compiled already
        Tuned.tuning.append(tuning)
        assert bar_force(Tuned(100.0)) == pytest.approx(10 + 100 * tuning * 0.625, rel=1e-12)


def forces_of_laws(laws):
    return [bar_force(law) for law in laws]


LAWS = [Stiff(100.0), Twice(100.0), Cubic(100.0), Fixed(100.0), Axial(100.0), Stiff(30.0), Twice(70.0)]


def test_processes_that_are_forked_find_the_same_forms():
    expected = forces_of_laws(LAWS)
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.write(write, np.array(forces_of_laws(LAWS[::-1])).tobytes())
        finally:
            os._exit(0)
    os.close(write)
    with open(read, "rb") as found:
        assert np.frombuffer(found.read()).tolist() == expected[::-1]
    assert os.waitpid(child, 0)[1] == 0
    assert forces_of_laws(LAWS) == expected


def test_quadrature_and_cells_make_other_forms():
    """Exact integral of x^2 on a triangle is area / 6, at one point area / 9; on an interval length / 3 and / 4."""
    meshes = [_dolfinx.create_mesh(np.eye(3)[: d + 1], np.array([range(d + 1)])) for d in (1, 2)]

    def integral(mesh, degree):
        dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": degree})
        return float(fem.assemble_scalar(_dolfinx.form(ufl.SpatialCoordinate(mesh)[0] ** 2 * dx)))

    length, area = np.sqrt(2), np.sqrt(3) / 2
    for _ in range(3):
        found = [integral(mesh, degree) for mesh in meshes for degree in (1, 2)]
        assert found == pytest.approx([length / 4, length / 3, area / 9, area / 6], rel=1e-12)


@pytest.mark.mpi
def test_kept_forms_keep_no_mesh():
    analysis = Analysis(structure(2, terms=KINDS["terms"]["terms"]))
    analysis.run([Stage("rest")])
    meshes = [weakref.ref(part.mesh.mesh) for part in analysis.problem.parts.values()]
    del analysis
    gc.collect()
    assert [mesh() for mesh in meshes] == [None] * len(meshes)
