"""Depressions of surfaces and their least slope: exact volumes, walls, drains, merging ponds, refusals."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Fabric,
    Form,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    drainage,
    rectangle,
)


def surface(height, n=16, size=2.0):
    points, triangles = rectangle(size, size, n, n)
    points[:, 2] = height(points[:, 0], points[:, 1])
    return points, triangles


def rim(triangles):
    return np.unique(boundary_edges(triangles))


def by_search(points, triangles):
    """Spill levels by raising the water at all nodes until nothing changes."""
    z = points[:, 2]
    level = np.where(np.isin(np.arange(len(z)), rim(triangles)), z, np.inf)
    edges = np.concatenate([triangles[:, [i, j]] for i, j in itertools.permutations(range(3), 2)])
    while True:
        lower = level.copy()
        np.minimum.at(lower, edges[:, 0], np.maximum(z[edges[:, 0]], level[edges[:, 1]]))
        if (lower == level).all():
            return level
        level = lower


@pytest.mark.parametrize("seed", range(5))
def test_random_heights_equal_a_search(seed):
    random = np.random.default_rng(seed)
    points, triangles = surface(lambda x, y: random.normal(size=len(x)), n=20)
    found = drainage((points, triangles))
    np.testing.assert_allclose(points[:, 2] + found.depth, by_search(points, triangles), rtol=0, atol=1e-14)
    assert len(found.depressions) > 5
    for pond in found.depressions:
        assert pond.level - points[pond.node, 2] == pond.depth == found.depth[pond.node]
        assert points[pond.spill, 2] == pond.level
        assert pond.pits[0] == pond.node
    depths = [pond.depth for pond in found.depressions]
    assert depths == sorted(depths, reverse=True)


@pytest.mark.parametrize("seed", range(3))
def test_area_and_volume_of_random_ponds(seed):
    """Against midpoint sums over a fine grid of each cell."""
    random = np.random.default_rng(seed)
    points, triangles = surface(lambda x, y: random.normal(size=len(x)), n=6)
    found = drainage((points, triangles))
    n = 60
    i, j = np.mgrid[:n, :n].reshape(2, -1)
    low = np.stack([i, j])[:, i + j < n] + 1 / 3
    high = np.stack([i, j])[:, i + j < n - 1] + 2 / 3
    bary = np.concatenate([low, high], axis=1) / n
    shares = np.stack([1 - bary.sum(axis=0), *bary], axis=1)
    z = points[triangles][..., 2] @ shares.T
    filled = (points[:, 2] + found.depth)[triangles]
    wet = found.depth[triangles] > 0
    level = np.where(wet.any(axis=1), np.where(wet, filled, -np.inf).max(axis=1), -np.inf)
    deep = (level[:, None] - z).clip(0)
    cell = (2 / 6) ** 2 / 2
    assert sum(pond.area for pond in found.depressions) == pytest.approx(cell * (deep > 0).mean(axis=1).sum(), rel=2e-2)
    assert sum(pond.volume for pond in found.depressions) == pytest.approx(cell * deep.mean(axis=1).sum(), rel=1e-3)


def test_single_cell_depressed():
    """A pyramid of depth 1 below a square of side 2: area 4, volume 4 / 3, spill anywhere on the rim."""
    points = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0], [0, 0, -1.0]])
    triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    (pond,) = drainage((points, triangles)).depressions
    assert (pond.node, pond.depth, pond.pits.tolist()) == (4, 1.0, [4])
    assert pond.area == pytest.approx(4, rel=1e-14)
    assert pond.volume == pytest.approx(4 / 3, rel=1e-14)
    points[1, 2] = -0.5  # spills at half the depth: half the size, cut where the surface rises
    (pond,) = drainage((points, triangles)).depressions
    assert (pond.depth, pond.spill, pond.level) == (0.5, 1, -0.5)
    other = [[np.roll(cell, 1).tolist() for cell in triangles], [cell[::-1] for cell in triangles]]
    for cells in other:
        (same,) = drainage((points, cells)).depressions
        assert (same.area, same.volume) == pytest.approx((pond.area, pond.volume), rel=1e-13)


def test_drain_in_a_bowl():
    bowl = surface(lambda x, y: x**2 + y**2)
    (pond,) = drainage(bowl).depressions
    assert drainage(bowl, drains=[pond.node]).drains


def test_walls_hold_water_back():
    """A tilted plane between walls: the wedge of water up to the lowest open node."""
    points, triangles = surface(lambda x, y: 0.1 * x)
    walls = np.flatnonzero(points[:, 0] < 0.99)
    walls = walls[np.isin(walls, rim(triangles))]
    assert drainage((points, triangles)).drains
    (pond,) = drainage((points, triangles), walls=walls).depressions
    assert pond.depth == pytest.approx(0.2, rel=1e-12)
    assert pond.area == pytest.approx(4.0, rel=1e-12)
    assert pond.volume == pytest.approx(0.4, rel=1e-12)
    with pytest.raises(
        ValueError, match=r"^Water has no way out .* around node 0, \(-1, -1, -0.1\): it has no rim with"
    ):
        drainage((points, triangles), walls=rim(triangles))


def test_high_points_drain():
    """Saddles and cones have no pit; between high points there is a saddle, which drains too."""
    assert drainage(surface(lambda x, y: x * y)).drains
    assert drainage(surface(lambda x, y: -np.hypot(x - 0.5, y))).drains
    assert drainage(surface(lambda x, y: np.maximum(-np.hypot(x - 0.5, y), -np.hypot(x + 0.5, y)))).drains


def test_least_depth():
    points, triangles = surface(lambda x, y: 0.1 * x)
    points[8 * 17 + 8, 2] -= 0.1 * 2 / 16 + 1e-3  # 1 mm below its neighbour
    (pond,) = drainage((points, triangles)).depressions
    assert pond.depth == pytest.approx(1e-3, rel=1e-9)
    assert drainage((points, triangles), least_depth=2e-3).drains


def test_slope_of_other_directions():
    points, triangles = surface(lambda x, y: 0.3 * x - 0.4 * y)
    found = drainage((points, triangles))
    np.testing.assert_allclose(found.slope, 0.5, rtol=1e-13)
    turned = drainage((points[:, [2, 0, 1]], triangles), up=(5, 0, 0))
    np.testing.assert_allclose(turned.slope, 0.5, rtol=1e-13)
    upright = drainage((points[:, [2, 0, 1]] * [0, 1, 1], triangles))
    assert np.isinf(upright.slope).all()


def test_words_have_units():
    points, triangles = surface(lambda x, y: 0.1 * (x**2 + y**2))
    found = drainage((points, triangles))
    (pond,) = found.depressions
    assert f", {pond.depth:.3g} m deep, with an area of {pond.area:.4g} m2" in str(found)
    assert "<th>depth [m]</th><th>area [m2]</th><th>volume [m3]</th>" in found._repr_html_()
    form = Form(
        points, {}, np.zeros_like(points), made=Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3))})
    )
    assert f" {pond.depth:.3g} ft deep" in str(drainage(replace(form, length_unit="ft")))
    assert f" {pond.depth:.3g} mm deep" in str(drainage(form, length_unit="mm"))
    bare = drainage(form, length_unit="")
    assert f" {pond.depth:.3g} deep, with an area of {pond.area:.4g}" in str(bare)
    assert "<th>depth</th>" in bare._repr_html_()


def test_level_surface_says_so():
    found = drainage(surface(lambda x, y: 0 * x))
    assert found.drains
    assert found.least_slope == 0
    assert str(found).startswith("no depression, but level cells; least slope 0 %")


def test_form_and_deformed_state():
    """A flat sheet holds water under its own sag; a structure of two membranes is one surface."""
    points, triangles = rectangle(2.0, 2.0, 8, 8)
    left = points[triangles].mean(axis=1)[:, 0] < 0
    fabric = Fabric(4e5, 0.3)
    parts = {"left": Membrane(triangles[left], fabric, 2e3), "right": Membrane(triangles[~left], fabric, 2e3)}
    structure = Structure(points, parts, [Support(rim(triangles))])
    state = Analysis(structure, progress=False).run(
        [Stage("rain", [DistributedLoad((0, 0, -500.0), "left"), DistributedLoad((0, 0, -500.0), "right")])]
    )["rain"]
    assert drainage(structure).drains
    (pond,) = drainage(state).depressions
    assert pond.node == 40
    assert pond.depth == pytest.approx(-state.displacement[40, 2], rel=1e-12)
    assert drainage(state, "left").drains  # over the seam
    deformed = Form(structure.points + state.displacement, {}, state.reactions, made=structure)
    assert drainage(deformed).drains  # of the structure in the form
    for shape in (structure, state):
        with pytest.raises(ValueError, match=r"^No Membrane is named 'roof'; those"):
            drainage(shape, "roof")


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shape": 5}, "^drainage shape is 5; give a Structure, a Form, a StageResult, or a pair"),
        ({"part": "roof"}, "^part is 'roof', but points and triangles have none"),
        ({"up": (0, 0, 0)}, r"^up is \(0, 0, 0\); give a direction"),
        ({"walls": [144]}, "^walls names node 144, which is not on the rim"),
        ({"drains": [1000]}, "^drains names node 1000, which is not on the surface"),
        ({"least_depth": -1}, "^least_depth is -1; it must not be negative"),
    ],
)
def test_refused(changes, message):
    with pytest.raises(ValueError, match=message):
        drainage(**{"shape": surface(lambda x, y: x), **changes})


def test_cells_without_area_or_nodes():
    points, _ = surface(lambda x, y: x)
    with pytest.raises(ValueError, match=r"^drainage triangles names node 999, which does not exist"):
        drainage((points, [[0, 1, 999]]))
    with pytest.raises(ValueError, match=r"^drainage triangles: cell 0 has no area, at \("):
        drainage((points, [[0, 1, 2]]))
