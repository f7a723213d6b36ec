"""Inflation past the maximum pressure, and deflation past the minimum.

References: closed forms.
Bubble: a membrane of constant 2nd Piola-Kirchhoff stress N0 in all directions (its stiffness is next to none) on a
disc of the radius a with a held edge. Its energy is the Dirichlet integral, and equilibrium under a pressure p that
follows it is p x,1 cross x,2 = -N0 (x,11 + x,22) (H. C. Wente, J. Math. Anal. Appl. 26 (1969) 318-344). The disc goes
over into a spherical cap of the rise w and the radius r by stereographic projection: in the plane
x = (1 + k) X / (1 + k |X / a|^2), z = w (1 - |X / a|^2) / (1 + k |X / a|^2), with k = (w / a)^2. That map is conformal,
so that the stress per current length is N0 again, everywhere and in all directions, as in a soap film:

    p = 2 N0 / r = 4 N0 w / (a^2 + w^2),    largest at the half sphere, w = a.

Bubbles below the half sphere are stable, those above have one negative eigenvalue.
Sphere: with C = Eh / (2 (1 - nu)) the balloon of test_sphere_pressure.py, p = 2 / R ((N0 - C) / lambda + C lambda). It
has a limit point only through its prestress, the least pressure at lambda = sqrt(N0 / C - 1): without, Saint
Venant-Kirchhoff balloons become stiffer and stiffer. With N0 = 1.36 C that is at 0.6; smaller spheres are unstable.
Claim: at a given rise, or mean radius, the pressure converges with second order to these values before, at and after
the limit point. Newton's method converges quadratically there; negative pivots distinguish the branches.
Tolerance: orders: the next term has the relative size of the error, 4e-2 at most on the coarser mesh of the last pair
(3e-3 to 1e-2 on the finer): 0.02. Extrapolated values leave the square of the error of the coarser mesh, 1e-4 at
most. The film's stiffness adds its share 1e-7 times the strain (below 50): 1e-5 at the most.
"""

import numpy as np
import pytest

from balloons import eighth_of_a_balloon
from fx_membrane import Analysis, Fabric, Membrane, Pressure, Stage, Structure, Support, equilibrium_path
from fx_membrane.assembly.problem import Problem
from fx_membrane.solvers.bordered_newton import BorderedNewton, Plane, Point
from surfaces import half_disc

SOURCE = "H. C. Wente 1969; closed form of a sphere"

A, N0 = 2.0, 100.0
LARGEST = 2 * N0 / A
MESHES = (8, 16, 32)

R, EH, NU = 2.0, 1e5, 0.3
C = EH / (2 * (1 - NU))
PRESTRESS = 1.36 * C


def second_order(values, exact):
    """Assert the order of convergence, and the extrapolated value."""
    error = np.abs(np.array(values) - exact)
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.02)
    assert (4 * values[-1] - values[-2]) / 3 == pytest.approx(exact, rel=2e-4)


def corners(state, part):
    return state.position[state.structure.parts[part].cells].swapaxes(0, 1)


# Bubble


def film(n):
    unit, triangles, rim = half_disc(n)
    membrane = Membrane(triangles, Fabric(1e-7 * N0, 0.0), N0)
    symmetry = np.setdiff1d(np.flatnonzero(unit[:, 1] == 0), rim)
    return Structure(A * unit, {"film": membrane}, [Support(rim), Support(symmetry, "y")])


def blow(n, rise, **options):
    """Path from the flat film up to a rise of its centre, the first node."""
    stage = Stage("blow", [Pressure(LARGEST, "film")], increments=5)
    return equilibrium_path(film(n), stage, None, (0, "z", rise), **options)


@pytest.fixture(scope="module", params=[0.5, 1.0, 3.0])
def bubbles(request):
    """Rise, and the paths to it on all meshes."""
    return request.param * A, [blow(n, request.param * A) for n in MESHES]


def test_bubble(bubbles):
    rise, paths = bubbles
    assert all(path.complete for path in paths)
    second_order([path.load_factors[-1] * LARGEST for path in paths], 4 * N0 * rise / (A**2 + rise**2))


def test_largest_pressure(verified):
    """The pressure at the half sphere."""
    paths = [blow(n, 1.5 * A) for n in MESHES]
    assert all(len(path.limit_points) == 1 for path in paths)
    values = [LARGEST * path.load_factors.max() for path in paths]
    second_order(values, LARGEST)
    error = np.array(values) - LARGEST
    verified("largest pressure of a bubble [Pa]", LARGEST, values[-1], np.log2(error[-2] / error[-1]))
    rise = [path.displacements[path.limit_points[0], 0, 2] for path in paths]
    second_order(rise, A)


def test_nodes_of_the_bubble(bubbles):
    """Each is where the stereographic projection puts it; the mean of squares, whose order comes to 2 from below."""
    rise, paths = bubbles
    k = (rise / A) ** 2
    error = []
    for path in paths:
        X = path.structure.points
        square = np.sum((X / A) ** 2, axis=1, keepdims=True)
        exact = ((1 + k) * X + rise * (1 - square) * np.array([0, 0, 1])) / (1 + k * square)
        error.append(np.sqrt(np.mean((X + path.displacements[-1] - exact) ** 2)))
    orders = np.log2(np.divide(error[:-1], error[1:]))
    assert 1.6 < orders[0] < orders[1] < 2.02
    assert orders[1] > 1.85


def test_bubbles_above_the_half_sphere_are_unstable(bubbles):
    """The mesh shifts the limit point by a share of its error, 1 % of the radius."""
    for path in bubbles[1][1:]:
        rise = path.displacements[:, 0, 2]
        assert (path.negative_pivots[rise < 0.97 * A] == 0).all()
        assert (path.negative_pivots[rise > 1.03 * A] == 1).all()


def test_stress_of_the_bubble(bubbles):
    """Stress of a soap film: N0 in all directions; on average, since single cells are not spherical."""
    _, paths = bubbles
    mean = [abs(path.state(-1).membrane("film").principal.mean() / N0 - 1) for path in paths]
    assert mean[-1] < mean[-2] / 3.5 < mean[-3] / 3.5**2
    assert mean[-1] < 5e-3


@pytest.mark.mpi_once
@pytest.mark.parametrize("rise", [0.5, 1.0, 2.0])
def test_newton_with_the_plane_is_quadratic(rise):
    """Disturbed by h, in displacement and load factor, a step leaves h^2, even close to the limit point."""
    path = blow(8, rise * A, rtol=1e-13)
    problem = Problem(path.structure)
    distribute = problem.discretization.to_petsc
    x, factor = distribute(path.points[-1].displacement), path.points[-1].load_factor
    rng = np.random.default_rng(7)
    direction = distribute(np.where(path.start.held, 0, rng.normal(size=path.structure.points.shape)))
    plane = Plane(direction, 0.3, 0.0)
    plane = plane._replace(distance=plane.signed_distance(Point(x, factor)))
    newton = BorderedNewton(problem, path.start, path.end, x, 1e-13)
    left = []
    for h in 1e-4 / 2.0 ** np.arange(4):
        guess = x.copy()
        guess.axpy(h, direction)
        found = newton.find(Point(guess, factor + h), plane)
        assert found.factor == pytest.approx(factor, rel=1e-10)
        left.append(found.iterations[1].residual)
    newton.free()
    np.testing.assert_allclose(np.log2(np.divide(left[:-1], left[1:])), 2, rtol=0, atol=0.05)


# Sphere


def pressure(stretch):
    return 2 / R * ((PRESTRESS - C) / stretch + C * stretch)


def balloon(n):
    return eighth_of_a_balloon(n, Fabric(EH, NU), PRESTRESS, R)


def let_out(n, stretch):
    """Path from a full balloon to a pole moved inwards to the stretch."""
    structure = balloon(n)
    full = Pressure(pressure(1.0), "balloon")
    start = Analysis(structure).run([Stage("fill", [full])])["fill"]
    pole = int(np.argmax(structure.points[:, 2]))
    stage = Stage("let out", [Pressure(-full.pressure, "balloon")], increments=20, after="fill")
    return equilibrium_path(start, stage, None, (pole, "z", (stretch - 1) * R))


@pytest.mark.parametrize("stretch", [0.8, 0.6, pytest.param(0.5, marks=pytest.mark.mpi), 0.4])
def test_sphere(stretch):
    """Pressure and volume; the pole only ends the path."""
    shares = []
    for n in MESHES:
        path = let_out(n, stretch)
        assert path.complete
        a, b, c = corners(path.state(-1), "balloon")
        mean = np.cbrt(np.sum(np.cross(b - a, c - a) * a) / np.pi) / R
        assert mean == pytest.approx(stretch, rel=0.01)
        shares.append(pressure(1.0) * (1 - path.load_factors[-1]) / pressure(mean))
        radius = 1 + path.displacements[:, np.argmax(path.structure.points[:, 2]), 2] / R
        assert (path.negative_pivots[radius > 0.62] == 0).all()
        assert (path.negative_pivots[radius < 0.58] > 0).all()
    second_order(shares, 1.0)


def test_least_pressure(verified):
    paths = [let_out(n, 0.55) for n in MESHES]
    assert all(len(path.limit_points) == 1 for path in paths)
    values = [pressure(1.0) * (1 - path.load_factors.max()) for path in paths]
    second_order(values, pressure(0.6))
    error = np.array(values) - pressure(0.6)
    verified("least pressure of a sphere [Pa]", pressure(0.6), values[-1], np.log2(error[-2] / error[-1]))
