"""Forms under constraints against closed forms: cables by length, sag and angle, sliding edges, floating rings.

Edge: an edge cable of force T in a membrane of equal stress n is an arc, T = n R. Over the chord c of a flat square,
    the length 2 R a, the sag R (1 - cos a) or the angle a, with sin a = c / 2 R, each give R.
Parabola: a cable under a load q per length of its span l, with the sag f at midspan, measured vertically, has the
    horizontal force H = q l^2 / 8 f, also with ends of unlike height; its funicular polygon has that sag exactly.
Catenary: a cable of length L over the span l under its weight w per length has L = 2 a sinh(l / 2 a), H = w a.
Ring on a rope: a frictionless ring under a force hangs where both parts of the rope have the same force and slope.
Half catenoid: a soap film between a held ring and an edge that slides on a plane meets it at right angles, as a whole
    one its plane of symmetry: r = b cosh(z / b) with z from the plane, held by the force 2 pi b n of the plane, normal
    to it.
Floating ring: a ring of given radius between two alike films floats at half height, in the plane of symmetry. Each
    film is a piece of a catenoid r = b cosh((z - s) / b). Their pulls on the ring of the radius R, with the slope
    tan t = dr / dz there, give the ring force 2 n R sin t.
Claim: the parabola and the ring on a rope are found up to the tolerance of the method, the others with second order.
    All are handed over at rest.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from fx_membrane import (
    Analysis,
    Cable,
    CableLength,
    CableSag,
    DistributedLoad,
    EdgeAngle,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    Ring,
    Slide,
    Stage,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    polyline,
    projected_stress,
    rectangle,
)
from models import rotation

SOURCE = "arc T = n R, parabola, catenary and catenoid"

FABRIC = Fabric(Et=6e5, nu=0.3)
STRESS = 2e3


def assert_at_rest(form, loads=()):
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    assert np.abs(state.displacement).max() < 1e-12 * np.ptp(form.points)


def square(n):
    """Straight edges, unlike their form."""
    points, triangles = rectangle(12.0, 12.0, n, n)
    corners = np.flatnonzero(np.abs(points[:, 0] * points[:, 1]) == 36)
    parts = {"film": Membrane(triangles, FABRIC, STRESS), "edge": Cable(boundary_edges(triangles), 2e7)}
    return Structure(points, parts, [Support(corners)])


ANGLE = np.radians(25.0)
RADIUS = 6.0 / np.sin(ANGLE)


@pytest.mark.parametrize(
    "constraint",
    [
        CableLength("edge", 2 * RADIUS * ANGLE),
        CableSag("edge", RADIUS * (1 - np.cos(ANGLE))),
        EdgeAngle("edge", np.degrees(ANGLE)),
    ],
    ids=lambda constraint: type(constraint).__name__,
)
def test_edge_cable_has_the_force_of_its_arc(constraint, verified):
    errors = []
    for n in (8, 16, 32):
        form = natural_force_density(square(n), iterations=40, tolerance=3e-4, constraints=[constraint])
        assert form.converged
        errors.append(np.abs(form.forces["edge"].mean() / (STRESS * RADIUS) - 1))
        assert np.ptp(form.forces["edge"]) < 2e-3 * STRESS * RADIUS
        assert_at_rest(form)
    if not isinstance(constraint, EdgeAngle):  # whose least force is that of the arc
        assert np.log2(errors[0] / errors[2]) / 2 == pytest.approx(2, abs=0.15)
    assert errors[-1] < 1e-3
    verified("force of an edge cable [N]", STRESS * RADIUS, form.forces["edge"].mean())


def rope(n, span=100.0, rise=0.0):
    x = np.linspace(0, span, n + 1)
    points = np.stack([x, 0 * x, rise * x / span], axis=1)
    return Structure(points, {"rope": Cable(polyline(range(n + 1)), 1e7)}, [Support([0, n])])


@pytest.mark.mpi_once
@pytest.mark.parametrize("rise", [0.0, 30.0])
@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
def test_parabola_of_given_sag(method, rise, verified):
    loads = [PointLoad(range(1, 16), (0, 0, -50.0 * 100 / 16))]
    form = method(rope(16, rise=rise), loads, constraints=[CableSag("rope", 8.0, along=(0, 0, 1))])
    verified("force of a cable of given sag [N]", 50.0 * 100**2 / 8 / 8, form.reactions[-1, 0])
    assert form.reactions[-1, 0] == pytest.approx(50.0 * 100**2 / 8 / 8, rel=1e-7)
    assert_at_rest(form, loads)


def test_catenary_of_given_length(verified):
    a = brentq(lambda a: 2 * a * np.sinh(50 / a) - 110, 10, 1000)
    errors = []
    for n in (8, 16, 32):
        weight = [DistributedLoad((0, 0, -50.0), "rope")]
        form = projected_stress(rope(n), weight, constraints=[CableLength("rope", 110.0)])
        force = np.hypot(*form.reactions[0, [0, 2]])
        errors.append([abs(-form.reactions[0, 0] - 50 * a), abs(form.points[n // 2, 2] + a * (np.cosh(50 / a) - 1))])
        assert force == pytest.approx(50 * a * np.cosh(50 / a), rel=5e-3)
        assert_at_rest(form, weight)
    orders = np.log2(np.array(errors)[1] / np.array(errors)[2])
    np.testing.assert_allclose(orders, 2, atol=0.05)
    verified("force of a catenary of given length [N]", 50 * a, -form.reactions[0, 0], orders[0])


def test_frictionless_ring_on_a_rope():
    points = [[0, 0, 0], [10, 0, 2], [5, 0, -1]]
    structure = Structure(points, {"rope": Cable([[0, 2], [2, 1]], 1e6)}, [Support([0, 1])])
    weight = [PointLoad(2, (0, 0, -1e4))]
    form = projected_stress(structure, weight, cables="force", constraints=[CableLength("rope", 12.0)], tolerance=1e-9)
    slope = np.arccos(10 / 12)  # both parts: horizontal share of the length
    assert form.forces["rope"] == pytest.approx(np.full(2, 1e4 / 2 / np.sin(slope)), rel=1e-8)
    assert form.points[2] == pytest.approx([3.4924432771, 0, -2.3166247904], abs=1e-7)
    assert_at_rest(form, weight)


def tube(n, radii, heights, turn):
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([r * circle + [0, 0, z] for r, z in zip(radii, heights, strict=True)]) @ turn.T
    i, j = (index.ravel() for index in np.mgrid[: len(radii) - 1, :around])
    a, b = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([a, b, b + around], axis=1), np.stack([a, b + around, a + around], axis=1)])
    return points, triangles, np.arange(around)


@pytest.mark.parametrize("seed", [None, 1])
def test_film_meets_the_plane_on_which_it_slides_at_right_angles(seed):
    turn = np.eye(3) if seed is None else rotation(seed)
    neck = brentq(lambda b: b * np.cosh(4 / b) - 10, 6, 10)
    errors = []
    for n in (6, 12, 24):
        points, triangles, circle = tube(n, [10.0] * (n + 1), np.linspace(4, 0, n + 1), turn)
        edge = n * len(circle) + circle
        structure = Structure(points, {"film": Membrane(triangles, FABRIC, STRESS)}, [Support(circle)])
        slide = Slide(edge, normal=turn[:, 2])
        form = natural_force_density(structure, iterations=100, tolerance=3e-5, constraints=[slide])
        assert form.converged
        place, force = form.points[edge] @ turn, form.reactions[edge] @ turn
        assert np.abs(place[:, 2]).max() < 1e-12
        assert np.abs(force[:, :2]).max() < 1e-12 * np.abs(force).max()
        errors.append([np.abs(np.hypot(place[:, 0], place[:, 1]) - neck).max()])
        errors[-1].append(abs(-force[:, 2].sum() - 2 * np.pi * neck * STRESS))
        assert_at_rest(form)
    np.testing.assert_allclose(np.log2(np.array(errors)[1] / np.array(errors)[2]), 2, atol=0.2)


def half_catenoid(radius, wide, height):
    """Least radius b, and its place s, of a catenoid through (radius, 0) and (wide, height) that opens all the way."""
    b = brentq(lambda b: b * (np.arccosh(wide / b) - np.arccosh(radius / b)) - height, 0.1 * radius, radius)
    return b, -b * np.arccosh(radius / b)


def between_films(n, turn, shift):
    """Ring between two films, moved from half height, and its nodes."""
    radii = [*np.linspace(4, 3, n + 1), *np.linspace(3, 4, n + 1)[1:]]
    points, triangles, circle = tube(n, radii, np.linspace(-2, 2, 2 * n + 1), turn)
    ring, ends = n * len(circle) + circle, np.concatenate([circle, 2 * n * len(circle) + circle])
    points[ring] += shift * turn[:, 2]
    lower = triangles.max(axis=1) <= ring.max()
    parts = {
        "lower": Membrane(triangles[lower], FABRIC, STRESS),
        "upper": Membrane(triangles[~lower], FABRIC, STRESS),
        "ring": Mast(polyline([*ring, ring[0]]), 1e8),
    }
    return Structure(points, parts, [Support(ends)]), ring


@pytest.mark.parametrize("seed", [None, 2])
def test_ring_floats_at_half_height(seed):
    turn = np.eye(3) if seed is None else rotation(seed)
    b, s = half_catenoid(3.0, 4.0, 2.0)
    slope = np.sinh(-s / b)  # of the radius, away from the ring
    hoop = 2 * STRESS * 3.0 * slope / np.sqrt(1 + slope**2)
    errors = []
    for n in (4, 8, 16):
        structure, ring = between_films(n, turn, 0.0)
        form = natural_force_density(structure, iterations=20, tolerance=1e-4, constraints=[Ring(ring, 3.0)])
        place = form.points[ring] @ turn
        assert np.abs(place[:, 2]).max() < 1e-11
        assert np.hypot(place[:, 0], place[:, 1]) == pytest.approx(np.full(len(ring), 3), rel=1e-11)
        errors.append(abs(form.forces["ring"].mean() - hoop))
        assert_at_rest(form)
    assert errors[-1] < 0.01 * hoop
    np.testing.assert_allclose(np.log2(errors[1] / errors[2]), 2, atol=0.15)


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", [None, 2])
def test_ring_rises_to_half_height_under_stress_in_projection(seed):
    turn = np.eye(3) if seed is None else rotation(seed)
    structure, ring = between_films(6, turn, -1.2)
    form = projected_stress(structure, direction=turn[:, 2], constraints=[Ring(ring, 3.0)])
    place = form.points[ring] @ turn
    assert np.abs(place[:, 2]).max() < 1e-11
    assert np.hypot(place[:, 0], place[:, 1]) == pytest.approx(np.full(len(ring), 3), rel=1e-11)
    assert_at_rest(form)
