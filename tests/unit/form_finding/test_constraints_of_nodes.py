"""Nodes that slide, rings and rigid bodies: reduction, balance, hand-over and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    CableLength,
    Fabric,
    Mast,
    Membrane,
    PlanLoad,
    PointLoad,
    Pressure,
    RigidBody,
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
from fx_membrane.form_finding.bodies import settled
from fx_membrane.form_finding.motions import motions_of
from models import rotation

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")

FABRIC = Fabric(Et=6e5, nu=0.3)


def sail(n=6):
    """Square of a saddle; two edges held, the other two free."""
    points, triangles = rectangle(4.0, 4.0, n, n)
    points[:, 2] = points[:, 0] * points[:, 1] / 4
    held = np.flatnonzero(np.abs(points[:, 0]) == 2)
    return Structure(points, {"film": Membrane(triangles, FABRIC, 2e3, (1, 0, 0))}, [Support(held)])


def free_edges(structure):
    x, y = structure.points[:, :2].T
    return np.flatnonzero((np.abs(y) == 2) & (np.abs(x) < 2))


def cone(n=4, radius=1.0, top=2.0, base=4.0, turn=None, hoop=0.0):
    """Ring of that radius at a height, a membrane around it, and masts along the ring."""
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    share = np.linspace(0, 1, n + 1)
    points = np.concatenate([(radius + s * (base - radius)) * circle + [0, 0, top * (1 - s)] for s in share])
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    a, b = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([a, b, b + around], axis=1), np.stack([a, b + around, a + around], axis=1)])
    points = points if turn is None else points @ turn.T
    ring = np.arange(around)
    parts = {
        "film": Membrane(triangles, FABRIC, 2e3, None if turn is None else turn @ [1, 0.3, 0]),
        "hoop": Mast(polyline([*ring, 0]), 1e8, hoop),
    }
    return Structure(points, parts, [Support(n * around + ring)]), ring


def moved(form, loads=()):
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    assert np.abs(state.reactions - form.reactions).max() <= 1e-9 * np.abs(form.reactions).max()
    return np.abs(state.displacement).max() / np.ptp(form.points)


@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
@pytest.mark.parametrize(
    ("slide", "held"),
    [({"normal": (0, 0, -2.0)}, "z"), ({"direction": (0, 3.0, 0)}, "xz"), ({"direction": (0, 0, 1e-200)}, "xy")],
)
def test_slide_along_axes_is_a_support(method, slide, held):
    structure = sail()
    nodes, loads = free_edges(structure), [Pressure(100.0, "film")]
    one = method(structure, loads, constraints=[Slide(nodes, **slide)])
    other = method(replace(structure, supports=[*structure.supports, Support(nodes, held)]), loads)
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.reactions, other.reactions)
    assert np.array_equal(one.structure.supported, other.structure.supported)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("slide", [{"normal": (0, 0, 1.0)}, {"direction": (0, 1.0, 0)}])
def test_inclined_slide_is_the_turned_one(seed, slide):
    structure, turn = sail(), rotation(seed)
    nodes = free_edges(structure)
    film = replace(structure.parts["film"], warp=turn @ [1, 0, 0])
    turned = replace(structure, points=structure.points @ turn.T, parts={"film": film})
    inclined = {name: turn @ value for name, value in slide.items()}
    loads = [Pressure(100.0, "film")]
    one = natural_force_density(structure, loads, 2, constraints=[Slide(nodes, **slide)])
    other = natural_force_density(turned, loads, 2, constraints=[Slide(nodes, **inclined)])
    assert other.points == pytest.approx(one.points @ turn.T, abs=1e-11)
    assert other.reactions == pytest.approx(one.reactions @ turn.T, abs=1e-9 * np.abs(one.reactions).max())
    assert other.structure.supported[nodes].all()
    assert moved(other, loads) < 1e-12


def test_slide_of_each_node_has_its_own_direction():
    structure, ring = cone()
    radial = structure.points[ring] * [1, 1, 0] + [0, 0, -0.5]
    form = projected_stress(structure, constraints=[Slide(ring, direction=radial)])
    way = form.points[ring] - structure.points[ring]
    assert np.linalg.norm(way, axis=1).min() > 0.1
    assert np.linalg.norm(np.cross(way, radial), axis=1).max() < 1e-12
    assert np.abs(np.sum(form.reactions[ring] * radial, axis=1)).max() < 1e-9 * np.abs(form.reactions).max()
    assert moved(form) < 1e-12


def test_slide_and_support_leave_what_both_allow():
    structure = sail()
    nodes = free_edges(structure)
    held = replace(structure, supports=[*structure.supports, Support(nodes, "z")])
    form = natural_force_density(held, constraints=[Slide(nodes, normal=(1, 1, 0))])
    way = form.points[nodes] - structure.points[nodes]
    assert np.abs(way[:, 2]).max() == 0
    assert np.abs(way[:, 0] + way[:, 1]).max() < 1e-14
    assert np.abs(way).max() > 1e-2


@pytest.mark.parametrize("seed", [None, 3])
@pytest.mark.parametrize("make", [lambda ring: Ring(ring, 1.0), RigidBody, lambda ring: Ring(ring, 1.3)])
def test_ring_stays_round_and_its_masts_take_its_force(make, seed):
    turn = np.eye(3) if seed is None else rotation(seed)
    structure, ring = cone(turn=turn)
    weight = [PointLoad(ring, turn @ (0, 0, 400.0))]
    form = natural_force_density(structure, weight, iterations=3, constraints=[make(ring)])
    place = form.points[ring] @ turn
    radius = getattr(make(ring), "radius", 1.0)
    assert np.hypot(place[:, 0], place[:, 1]) == pytest.approx(np.full(len(ring), radius), rel=1e-12)
    assert np.ptp(place[:, 2]) < 1e-12
    assert form.forces["hoop"] == pytest.approx(np.full(len(ring), form.forces["hoop"][0]), rel=1e-8)
    assert form.forces["hoop"][0] > 0  # the membrane pulls outwards
    assert np.abs(form.reactions[ring]).max() < 1e-9 * np.abs(form.reactions).max()
    assert len(form.structure.supports) == 1
    assert moved(form, weight) < 1e-12


def test_ring_without_masts_is_held_with_what_it_bears():
    structure, ring = cone()
    bare = replace(structure, parts={"film": structure.parts["film"]})
    form = natural_force_density(bare, constraints=[Ring(ring, 1.0)])
    assert form.structure.supported[ring].all()
    pull = form.reactions[ring]
    assert np.abs(pull.sum(axis=0)).max() < 1e-9 * np.abs(pull).max()
    assert np.sum(pull * form.points[ring], axis=1).max() < 0  # inwards: it holds the membrane's pull
    assert moved(form) < 1e-12


def test_ring_of_found_radius_is_round_under_uneven_pull():
    # Base moved sideways: a plain ring cable would be no circle.
    structure, ring = cone(hoop=0.0)
    points = structure.points.copy()
    base = structure.supported.all(axis=1)
    points[base] = points[base] * [1.5, 1, 1] + [1, 0, 0]
    parts = {"film": structure.parts["film"], "ring": Cable(structure.parts["hoop"].cells, 1e8, 3e3)}
    form = natural_force_density(replace(structure, points=points, parts=parts), constraints=[Ring(ring)])
    place = form.points[ring]
    centre = place.mean(axis=0)
    radius = np.linalg.norm(place - centre, axis=1)
    assert radius == pytest.approx(np.full(len(ring), radius[0]), rel=1e-12)
    assert abs(radius[0] - 1) > 0.05
    assert np.linalg.svd(place - centre)[1][2] < 1e-12
    pull = form.reactions[ring]
    assert np.abs(pull).max() > 1
    assert np.abs(pull.sum(axis=0)).max() < 1e-9 * np.abs(form.reactions).max()
    assert np.abs(np.sum(pull * (place - centre))) < 1e-9 * np.abs(form.reactions).max()  # no work on the radius
    assert np.abs(np.cross(place - centre, pull).sum(axis=0)).max() < 1e-9 * np.abs(form.reactions).max()
    assert moved(form) < 1e-12


def test_supports_guide_a_ring():
    structure, ring = cone()
    guided = replace(structure, supports=[*structure.supports, Support(ring, "z")])
    form = projected_stress(guided, [PlanLoad((50.0, 0, -300.0), "film")], constraints=[Ring(ring)])
    place = form.points[ring]
    assert np.array_equal(place[:, 2], structure.points[ring, 2])
    radius = np.linalg.norm(place - place.mean(axis=0), axis=1)
    assert radius == pytest.approx(np.full(len(ring), radius[0]), rel=1e-12)
    assert abs(radius[0] - 1) > 1e-3
    assert moved(form, [PlanLoad((50.0, 0, -300.0), "film")]) < 1e-12


def test_ring_turns_about_two_held_nodes():
    structure, ring = cone()
    hinged = replace(structure, supports=[*structure.supports, Support(ring[[0, 8]])])
    loads = [PointLoad(ring[4], (0, 0, 3e3))]
    form = natural_force_density(hinged, loads, constraints=[Ring(ring, 1.0)])
    place = form.points[ring]
    assert np.array_equal(place[[0, 8]], structure.points[ring[[0, 8]]])
    assert np.linalg.norm(place - place.mean(axis=0), axis=1) == pytest.approx(np.ones(len(ring)), rel=1e-10)
    assert place[4, 2] - place[12, 2] > 0.1
    assert moved(form, loads) < 1e-12


def strut():
    points = np.array([[-3.0, 0, 0], [3, 0, 0], [0, 0.1, 1], [0.2, 0, -1], [0, -3, 0], [0, 3, 0]])
    cables = Cable([[0, 2], [1, 2], [0, 3], [1, 3], [4, 2], [5, 2], [4, 3], [5, 3]], 1e6, 1e3)
    parts = {"net": cables, "strut": Mast([[2, 3]], 1e7)}
    return Structure(points, parts, [Support([0, 1, 4, 5])])


def test_rigid_pair_is_a_strut_of_its_length_whose_force_is_found():
    structure = strut()
    form = projected_stress(structure, cables="force density", constraints=[RigidBody([2, 3])])
    length = np.linalg.norm(structure.points[2] - structure.points[3])
    assert np.linalg.norm(form.points[2] - form.points[3]) == pytest.approx(length, rel=1e-13)
    assert form.forces["strut"] == pytest.approx([-2 * 1e3 * length])  # four force densities against half the length
    assert len(form.structure.supports) == 1
    assert moved(form) < 1e-12


def test_square_frame_is_rigid():
    points, triangles = rectangle(4.0, 4.0, 8, 8)
    frame = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 0.5)
    rim = np.unique(boundary_edges(triangles))
    points[rim, 2] = 0.5 * (points[rim, 0] > 0)
    structure = Structure(points, {"film": Membrane(triangles, FABRIC, 2e3)}, [Support(rim)])
    form = natural_force_density(structure, iterations=3, constraints=[RigidBody(frame)])
    first, now = points[frame] - points[frame].mean(axis=0), form.points[frame] - form.points[frame].mean(axis=0)
    assert now @ now.T == pytest.approx(first @ first.T, abs=1e-12)
    assert np.ptp(now[:, 2]) > 0.05  # it has turned with the membrane
    assert moved(form) < 1e-12


def test_cables_and_nodes_are_constrained_together():
    structure, ring = cone()
    stays = Cable([[int(ring[0]), len(structure.points)], [int(ring[8]), len(structure.points)]], 1e7)
    points = np.vstack([structure.points, [0, 0, 5.0]])
    parts = {**structure.parts, "stays": stays}
    hung = Structure(points, parts, [*structure.supports, Support(len(points) - 1)])
    given = [Ring(ring, 1.0), CableLength("stays", 2.5)]
    form = projected_stress(hung, cables="force", constraints=given)
    ends = form.points[stays.cells]
    assert np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) == pytest.approx([2.5, 2.5], rel=1e-7)
    assert form.points[ring, 2] == pytest.approx(np.full(len(ring), 5 - np.sqrt(2.5**2 - 1)), abs=1e-6)
    assert form.forces["stays"].min() > 100
    assert moved(form) < 1e-12


def test_every_process_has_the_same_form():
    structure, ring = cone()
    form = natural_force_density(structure, iterations=2, constraints=[Ring(ring, 1.2)])
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)


def body_of(structure, ring, radius=1.0):
    return motions_of(structure, [Ring(ring, radius)]).bodies


@pytest.mark.parametrize("seed", range(5))
def test_body_goes_to_the_least_energy_from_afar(seed):
    # Nearest circle to a turned and scaled one, in a metric without directions: the turn alone, whatever it is.
    bodies = body_of(*cone())
    random = np.random.default_rng(seed)
    goal = bodies[0].first @ rotation(seed).T
    goal[0] += [0.3, -2, 1]
    stretched = goal.copy()
    stretched[1:] *= 1.7
    loose = bodies[0].ways.T @ (stretched - bodies[0].first).ravel()
    start = random.normal(size=len(loose)) * 1e-3
    found, force = settled(bodies, 50.0 * np.eye(len(loose)), loose, start)
    frame = bodies[0].first + (bodies[0].ways @ found).reshape(3, 3)
    assert frame == pytest.approx(goal, abs=1e-10)
    assert 50.0 * (found - loose) == pytest.approx(force, abs=1e-10)


def test_balance_that_is_no_minimum_is_left():
    # Frame turned by half a turn from where the springs want it: in balance, of most energy.
    bodies = body_of(*cone())
    first = bodies[0].first
    wanted = first * np.array([[1], [-1], [-1]])
    loose = bodies[0].ways.T @ (wanted - first).ravel()
    found, _ = settled(bodies, np.eye(len(loose)), loose, np.zeros(len(loose)))
    assert first + (bodies[0].ways @ found).reshape(3, 3) == pytest.approx(wanted, abs=1e-9)


def off_the_circle():
    structure, ring = cone()
    points = structure.points.copy()
    points[3] *= 1.001
    return replace(structure, points=points), [Ring(ring)]


def with_supports(components, nodes=None):
    structure, ring = cone()
    nodes = ring if nodes is None else ring[nodes]
    return replace(structure, supports=[*structure.supports, Support(nodes, components)])


REFUSED = [
    (off_the_circle, r"node 3 at \(.*\) is 0\.00.* from the circle of radius 1.* move the nodes onto a circle"),
    (lambda: (cone()[0], [Ring([0, 16, 32])]), "nodes on a line, which is no circle"),
    (lambda: (cone()[0], [Ring(range(16)), Slide([3, 40], normal=(0, 0, 1))]), r"Node 3 at .* has two constraints"),
    (lambda: (cone()[0], [Slide([3], normal=(0, 0, 1)), Slide([3], normal=(0, 1, 0))]), "the second a Slide"),
    (lambda: (with_supports("xyz"), [Ring(range(16))]), "held by supports in all its motions"),
    (lambda: (with_supports("xyz", [0, 4, 8]), [Ring(range(16))]), "held by supports in all its motions"),
    (lambda: (with_supports("xyz"), [Slide([3], normal=(0, 0, 1))]), r"Node 3 at .* its support in 'xyz' leaves it no"),
    (lambda: (with_supports("z"), [Slide([3], direction=(1, 0, 1))]), r"Node 3 at .* its support in 'z' leaves it no"),
    (lambda: (cone()[0], [Slide([999], normal=(0, 0, 1))]), "Slide names node 999"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
def test_refusals(method, number):
    make, words = REFUSED[number]
    structure, constraints = make()
    with pytest.raises(ValueError, match=words):
        method(structure, constraints=constraints)


def test_radius_that_supports_forbid_is_named():
    structure = with_supports("xyz", [0, 8])  # two ends of a diameter
    with pytest.raises(RuntimeError, match=r"The Ring with node 0 at .* finds no balance .* give another radius"):
        natural_force_density(structure, constraints=[Ring(range(16), 0.5)])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Slide([0]), "give one of direction"),
        (lambda: Slide([0], (0, 0, 1), (0, 0, 1)), "give one of direction"),
        (lambda: Slide([0], direction=(0, 0, 0)), "Slide direction is zero"),
        (lambda: Slide([0, 7], normal=[(0, 0, 1), (0, 0, 0)]), "Slide normal of node 7 is zero"),
        (lambda: Slide([0, 7], normal=[(0, 0, 1)]), r"shape \(1, 3\); give \(3,\), or \(2, 3\)"),
        (lambda: Ring([0, 1]), "at least three"),
        (lambda: Ring([0, 1, 2], 0.0), "positive"),
        (lambda: RigidBody([0]), "at least two"),
        (lambda: RigidBody([0, 0]), "node 0 twice"),
    ],
)
def test_unfit_data_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()
