"""Energy terms in energy, residual and tangent: consistent derivatives, forces summed by hand."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Pressure,
    Stage,
)
from fx_membrane.assembly.actions import between
from fx_membrane.assembly.problem import Problem
from models import MIXED, TRIANGLES, close, inclined_sheet, same_state, sheet
from own_terms import ElasticBed, Everything, Follower, Water, WaterWork, random, under
from taylor import remainders

COUNT = len(TRIANGLES)
RNG = np.random.default_rng(8)
FORCE = RNG.normal(size=(COUNT, 3))
ALL = Everything("fabric", 300.0, (0.2, -0.1, 1.0), FORCE, 20 + RNG.random(COUNT))
SOME = Everything("fabric", RNG.random(5), (0, 0, 1.0), (1.0, 2, 3), 3.0, cells=[9, 2, 20, 21, 30])
WATER = Water("fabric", 2e3, 0.3)
SNOW = DistributedLoad((0, 0, -200.0), "fabric")
PULL = Follower("edge", (30.0, 0.0, 20.0))


PROBLEMS = {
    "all symbols": lambda: under(inclined_sheet(), ALL),
    "some cells": lambda: under(replace(inclined_sheet(), terms=[SOME]), SNOW, Pressure(30.0, "fabric")),
    "water": lambda: under(inclined_sheet(), WATER),
    "virtual work": lambda: under(inclined_sheet(), WaterWork("fabric", 2e3, 0.3)),
    "bars": lambda: under(replace(MIXED, terms=[ElasticBed("edge", 50.0), ElasticBed("mast", 7.0)]), PULL),
}


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", PROBLEMS)
def test_tangent_is_the_derivative_of_the_residual(name):
    """No switch is passed within the steps."""
    problem = PROBLEMS[name]()
    assert problem.terms.all
    norms = remainders(problem, random(problem, 1), random(problem, 2), 1e-4 / 2.0 ** np.arange(4))
    np.testing.assert_allclose(np.log2(norms[:-1] / norms[1:]), 2, rtol=0, atol=0.02)


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", ["all symbols", "some cells", "water"])
def test_residual_is_the_derivative_of_the_energy(name):
    """Remainders of the third order: with pressure, the energy along the step."""
    problem = PROBLEMS[name]()
    x, d = random(problem, 1), random(problem, 2)
    along, R, Kd = problem.energy_along(x, d), problem.residual(x), problem.discretization.create_vector()
    problem.tangent(x).mult(d, Kd)
    steps = 2e-2 / 2.0 ** np.arange(4)
    left = [along(h) - along(0.0) - h * R.dot(d) - h**2 / 2 * d.dot(Kd) for h in steps]
    assert np.log2(np.divide(left[:-1], left[1:])) == pytest.approx(3, abs=0.1)


@pytest.mark.parametrize(
    "loads", [[WaterWork("fabric", 2e3, 2.0)], [WaterWork("fabric", 2e3, 2.0), Pressure(50.0, "fabric")]]
)
def test_energy_along_includes_the_work_of_terms_without_potential(loads):
    """Under water the force is cubic in the displacement: three Gauss points integrate it exactly."""
    problem = under(inclined_sheet(), *loads)
    x, d = random(problem, 1), random(problem, 2)
    found, d_nodes = problem.energy_along(x, d), problem.discretization.to_numpy(d)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    for length in (0.3, 1.0, -0.7):
        power = []
        for s in (1 + nodes) / 2 * length:
            y = x.copy()
            y.axpy(s, d)
            power.append(np.sum(problem.pressure_loads(y) * d_nodes))
            power[-1] += sum(np.sum(forces * d_nodes) for _, forces in problem.term_forces(y))
        end = x.copy()
        end.axpy(length, d)
        assert problem.energy(end) - found(length) == pytest.approx(length / 2 * weights @ power, rel=1e-10)


WORK = WaterWork("fabric", 2e3, 0.3)
BED = ElasticBed("fabric", 100 + 10 * np.arange(3.0)[:, None], cells=[4, 0, 7])

# Term, parameter, and its change.
PARAMETERS = [
    (ALL, "k", 20.0),
    (ALL, "direction", (0.3, 1.0, -2.0)),
    (ALL, "force", RNG.normal(size=(COUNT, 3))),
    (ALL, "force", (1.0, 0.0, -3.0)),
    (ALL, "stiff", 2.0),
    (ALL, "stiff", RNG.random((COUNT, 1))),
    (SOME, "k", [1.0, -2, 3, 4, 5]),
    (BED, "k", [1.0, -2, 3]),  # of three cells: numbers, no vector
    (WORK, "level", 0.1),
    (WORK, "weight", -300.0),
]


def changed(term, name, direction, h):
    """Term with another parameter."""
    own, step = np.asarray(getattr(term, name)), np.asarray(direction)
    if step.size == own.size:
        step = step.reshape(own.shape)
    return replace(term, **{name: own + h * step})


@pytest.mark.mpi_once
@pytest.mark.parametrize("place", ["stage", "structure"])
@pytest.mark.parametrize(("term", "name", "direction"), PARAMETERS)
def test_derivative_by_a_parameter_of_a_term(term, name, direction, place):
    """Central differences; no switch is passed within them. Half of the load factor is half of a stage's term."""

    def view(term):
        if place == "structure":
            return Problem(replace(inclined_sheet(), terms=[WATER, term])).under()
        problem = under(replace(inclined_sheet(), terms=[]), SNOW, term)
        return problem.under(between(Problem(inclined_sheet()).under().actions, problem.actions, 0.5))

    problem = view(term)
    x = random(problem, 1)
    h = 1e-4
    above, below = (view(changed(term, name, direction, sign * h)).residual(x) for sign in (1, -1))
    found = problem.derivative(x, term, name, direction)
    above.axpy(-1.0, below)
    above.scale(1 / (2 * h))
    assert found.norm() > 1e-4
    rounding = 1e-15 * problem.residual(x).norm() / h
    above.axpy(-1.0, found)
    assert above.norm() < 1e-6 * found.norm() + rounding


def test_derivative_by_a_parameter_that_the_energy_does_not_have_is_zero():
    @dataclass(frozen=True)
    class Idle:
        part: str
        k: float
        other: float

        def energy(self, state, parameters):
            return parameters.k * state.u[2] ** 2

    term = Idle("fabric", 2.0, 3.0)
    problem = under(inclined_sheet(), term)
    x = random(problem, 1)
    assert problem.derivative(x, term, "k").norm() > 0
    assert problem.derivative(x, term, "other").norm() == 0


@pytest.mark.parametrize(
    ("arguments", "facts"),
    [
        ((replace(BED), "k"), r"^ElasticBed on 'fabric' is none of.*, ElasticBed on 'fabric'; give the object itself"),
        ((BED, "part"), r"ElasticBed on 'fabric'.*no parameter 'part'.*\['k'\]"),
        ((BED, "k", [1.0, 2.0]), r"'k' of ElasticBed on 'fabric'.*\(2,\).*a number or shape \(3,\) or shape \(3, 1\)"),
        ((BED, "k", np.nan), r"'k'.*finite"),
        ((ElasticBed, "k"), r"No part.*ElasticBed"),
    ],
)
def test_bad_parameters_of_terms_are_refused(arguments, facts):
    problem = under(inclined_sheet(), BED)
    with pytest.raises(ValueError, match=facts):
        problem.derivative(random(problem, 1), *arguments)


@pytest.mark.mpi
def test_forces_are_those_of_the_energy_summed_by_hand():
    structure, k = inclined_sheet(), 100 + 10 * np.arange(3.0)
    bed = ElasticBed("fabric", k[:, None], cells=[4, 0, 7])
    problem = under(structure, bed)
    u = 0.1 * np.random.default_rng(3).normal(size=structure.points.shape)
    ((acting, forces),) = problem.term_forces(problem.discretization.to_petsc(u))
    assert acting == (bed, 1.0)
    expected, energy = np.zeros_like(u), 0.0
    mass = (np.ones((3, 3)) + np.eye(3)) / 12  # of a triangle of area one
    for stiffness, cell in zip(k, [4, 0, 7], strict=True):
        nodes = structure.parts["fabric"].cells[cell]
        a, b = np.diff(structure.points[nodes], axis=0)
        area = np.linalg.norm(np.cross(a, b)) / 2
        expected[nodes, 2] -= stiffness * area * mass @ u[nodes, 2]
        energy += stiffness * area * u[nodes, 2] @ mass @ u[nodes, 2] / 2
    assert close(forces, expected)
    x = problem.discretization.to_petsc(u)
    without = Problem(structure).under()
    whole = without.energy(x)
    assert problem.energy(x) - whole == pytest.approx(energy, rel=1e-10, abs=1e-14 * abs(whole))
    assert close(problem.discretization.to_numpy(without.residual(x)) - forces,
                 problem.discretization.to_numpy(problem.residual(x)))  # fmt: skip


def test_distributed_load_as_a_term():
    """An energy linear in u is a distributed load."""

    @dataclass(frozen=True)
    class Uniform:
        part: str
        q: Any

        def energy(self, state, parameters):
            return -sum(parameters.q[i] * state.u[i] for i in range(3))

    own, given = (
        Analysis(inclined_sheet()).run([Stage("load", [load])])["load"]
        for load in (Uniform("fabric", (3.0, 4, -200)), DistributedLoad((3.0, 4, -200), "fabric"))
    )
    assert same_state(own, given)
    assert own.energy == pytest.approx(given.energy, rel=1e-9)


@pytest.mark.mpi_once
@pytest.mark.parametrize("where", ["energy", "virtual work"])
def test_pressure_as_a_term(where):
    @dataclass(frozen=True)
    class Inner:
        part: str
        p: float

        if where == "energy":

            def energy(self, state, parameters):  # along z, the edge is held
                return -parameters.p * state.x[2] * state.n[2]

        else:

            def virtual_work(self, state, v, parameters):
                return parameters.p * sum(state.n[i] * v[i] for i in range(3))

    own, given = (
        Analysis(sheet()).run([Stage("air", [load])])["air"]
        for load in (Inner("fabric", 300.0), Pressure(300.0, "fabric"))
    )
    assert close(own.displacement, given.displacement)
    free = ~given.actions.held
    assert close(own.loads[free], given.loads[free])
