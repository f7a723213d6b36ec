"""Energy along a step includes the exact work of follower pressures."""

from itertools import pairwise

import numpy as np
import pytest

from fx_membrane import DistributedLoad, Membrane, Pressure, Structure, Support
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.line_search import line
from models import EDGE, FABRIC, INCLINED, end, flipped, inclined_sheet

LENGTHS = [0.0, 0.1, 0.5, 1.0, 1.7, -0.6]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(2)  # exact to cubics; the power of a pressure is quadratic

# A closed surface, its normals outwards.
OCTAHEDRON = np.array([[1, 0, 0], [0, 1.2, 0], [-0.9, 0, 0], [0, -1, 0.1], [0.1, 0, 1], [0, 0, -1.1]])
RING = [0, 1, 2, 3, 0]
FACES = np.array([[a, b, top] for a, b in pairwise(RING) for top in (4, 5)])
FACES[1::2] = FACES[1::2, [1, 0, 2]]


def random(seed, shape=INCLINED.shape):
    return 0.2 * np.random.default_rng(seed).normal(size=shape)


def along(problem, at, step):
    return problem.energy_along(*map(problem.discretization.to_petsc, (at, step)))


def energy(problem, at):
    return problem.energy(problem.discretization.to_petsc(at))


def work(problem, at, step):
    """Work of the pressures: the difference of energy_along and the energy, at all lengths."""
    found = along(problem, at, step)
    return np.array([energy(problem, at + t * step) - found(t) for t in LENGTHS])


def volume(points, triangles):
    return np.linalg.det(points[triangles]).sum() / 6


def under_pressure(structure, *pressures):
    problem = Problem(structure)
    return problem.under(end(problem, *pressures))


def test_without_pressure_it_is_the_energy():
    problem = under_pressure(inclined_sheet(), DistributedLoad((3.0, 4, -200), "fabric"))
    at, step = random(1), random(2)
    found = along(problem, at, step)
    for t in LENGTHS:
        assert found(t) == pytest.approx(energy(problem, at + t * step), rel=1e-13)


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", range(3))
def test_work_of_pressures_is_the_integral_of_their_power(seed):
    # Each cell has its own pressure, and the edge moves too: there is no potential.
    loads = [Pressure(100.0 + 10 * cell, "fabric", cell) for cell in range(0, 32, 3)]
    problem = under_pressure(inclined_sheet(flipped(seed)), *loads, DistributedLoad((3.0, 4, -200), "fabric"))
    at, step = random(10 + seed), random(20 + seed)

    def power(t):
        return np.sum(problem.pressure_loads(problem.discretization.to_petsc(at + t * step)) * step)

    expected = [t / 2 * sum(w * power(t * (1 + s) / 2) for s, w in zip(NODES, WEIGHTS, strict=True)) for t in LENGTHS]
    assert work(problem, at, step) == pytest.approx(expected, abs=1e-12 * energy(problem, at + step))


@pytest.mark.parametrize("p", [250.0, -40.0])
@pytest.mark.parametrize("kind", ["held along its edge", "closed"])
def test_work_of_an_even_pressure_is_pressure_times_volume(kind, p):
    if kind == "closed":
        points, triangles = OCTAHEDRON, FACES
        structure = Structure(points, {"fabric": Membrane(triangles, FABRIC)}, [Support(0)])
        assert volume(points, triangles) > 1
    else:
        structure = inclined_sheet()
        points, triangles = INCLINED, structure.parts["fabric"].cells
    problem = under_pressure(structure, Pressure(p, "fabric"))
    at, step = random(3, points.shape), random(4, points.shape)
    if kind != "closed":
        at[EDGE] = step[EDGE] = 0.0
    before = volume(points + at, triangles)
    expected = [p * (volume(points + at + t * step, triangles) - before) for t in LENGTHS]
    assert np.abs(expected).max() > 1
    assert work(problem, at, step) == pytest.approx(expected, abs=1e-12 * energy(problem, at + step))


@pytest.mark.mpi
def test_slope_is_that_of_the_residual():
    problem = under_pressure(inclined_sheet(), Pressure(300.0, "fabric", range(20)))
    at, step, h = random(5), random(6), 1e-5
    found = along(problem, at, step)
    for t in (0.0, 0.4, 1.0):
        x, b = problem.discretization.to_petsc(at + t * step), problem.discretization.create_vector()
        problem.residual(x, b)
        slope = np.sum(problem.discretization.to_numpy(b) * step)
        assert (found(t + h) - found(t - h)) / (2 * h) == pytest.approx(slope, rel=1e-7)


@pytest.mark.mpi
@pytest.mark.parametrize("loads", [[], [Pressure(300.0, "fabric")]], ids=["potential", "pressure"])
def test_point_of_a_line_search_sets_the_shape_once(loads, monkeypatch):
    """Each time takes messages between processes; the work of pressures is known from three points."""
    problem = under_pressure(inclined_sheet(), *loads)
    start, step = (problem.discretization.to_petsc(random(seed)) for seed in (1, 2))
    at = line(problem, start, step)
    at(1.0)
    scattered, scatter = [], problem.discretization.scatter
    monkeypatch.setattr(problem.discretization, "scatter", lambda x: (scattered.append(x), scatter(x)))
    found = [at(0.3), at(0.7)]
    assert len(scattered) == 2
    trial = start.duplicate()
    for point in found:
        trial.waxpy(point.length, step, start)
        assert point.slope == problem.residual(trial).dot(step)
        assert point.energy == problem.energy_along(start, step)(point.length)
