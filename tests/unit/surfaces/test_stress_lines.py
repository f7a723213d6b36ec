"""Principal stress trajectories and lines of wrinkles: exact fields, even spacing, ends; refusals."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    load_results,
    natural_force_density,
    rectangle,
    save_results,
    stress_trajectories,
    warp_lines,
    wrinkle_lines,
)

FABRIC = Fabric(4e5, 0.3)


def uneven(width=4.0, depth=3.0, columns=12, rows=9, seed=3):
    """Rectangle with inner nodes moved at random."""
    points, triangles = rectangle(width, depth, columns, rows)
    inner = np.setdiff1d(np.arange(len(points)), boundary_edges(triangles))
    points[inner, :2] += np.random.default_rng(seed).uniform(-0.08, 0.08, (len(inner), 2))
    return points, triangles


def tube(radius, height, around, up):
    """Cylinder about z, and the unit vectors along its hoops in the cells."""
    angle = 2 * np.pi * np.arange(around) / around
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    points = np.concatenate([ring + np.array([0, 0, z]) for z in np.linspace(0, height, up + 1)])
    cell = np.arange(around * up)
    right = cell - cell % around + (cell + 1) % around
    triangles = np.concatenate(
        [np.column_stack([cell, right, right + around]), np.column_stack([cell, right + around, cell + around])]
    )
    centres = points[triangles].mean(axis=1)
    return points, triangles, np.column_stack([-centres[:, 1], centres[:, 0], 0 * cell.repeat(2)])


def folded():
    """Square of which one half wrinkles and the other is slack."""
    points, triangles = rectangle(2.0, 2.0, 8, 8)
    east = np.where(points[:, 0] > 0, -0.02, 0.02)
    moves = np.column_stack([east * points[:, 0], -0.02 * points[:, 1], 0 * east])
    structure = Structure(points, {"fabric": Membrane(triangles, FABRIC)}, [Support(range(len(points)), "z")])
    fold = Stage("fold", displacements=[PrescribedDisplacement(range(len(points)), moves, "xy")])
    return Analysis(structure).run([fold])


@pytest.mark.parametrize("second", [False, True])
def test_uniform_stress_has_straight_lines(second):
    points, triangles = uneven()
    strip = Membrane(triangles, FABRIC, prestress=(3e3, 1e3), warp=(2, 1, 0))
    lines = stress_trajectories(Structure(points, {"strip": strip}), spacing=0.3, second=second)
    wanted = np.array([-1, 2, 0] if second else [2, 1, 0]) / np.sqrt(5)
    assert len(lines) > 5
    for line in lines:
        assert np.abs(np.cross(line.points - line.points[0], wanted)).max() < 1e-8
        assert np.abs(np.abs(line.points[[0, -1]]) - [2, 1.5, 0]).min(axis=1).max() < 1e-8  # from rim to rim


def test_state_under_tension_has_lines_along_it():
    """Uniaxial stress: the second principal value is that of the prestress across, zero."""
    points, triangles = uneven()
    structure = Structure(points, {"strip": Membrane(triangles, Fabric(4e5, 0.0), (1e3, 0.0), warp=(1, 0, 0))})
    pull = PrescribedDisplacement(range(len(points)), points * [0.01, 0, 0])
    state = Analysis(structure).run([Stage("pull", displacements=[pull])])["pull"]
    for line in stress_trajectories(state, spacing=0.5):
        assert np.ptp(line.points[:, 1]) < 1e-8
        assert line.length == pytest.approx(4.04, abs=1e-9)


@pytest.mark.parametrize("unit", [1.0, 1e3])
def test_hoop_stress_has_circles_and_generators(unit):
    points, triangles, hoop = tube(1.0 * unit, 2.0 * unit, 24, 8)
    structure = Structure(points, {"tube": Membrane(triangles, FABRIC, prestress=(2e3, 1e3), warp=hoop)})
    hoops = stress_trajectories(structure, spacing=0.2 * unit)
    assert len(hoops) in (9, 10, 11)
    for line in hoops:
        assert np.ptp(line.points[:, 2]) < 1e-8 * unit
        assert np.allclose(line.points[0], line.points[-1], rtol=0, atol=1e-8 * unit)
        assert line.length == pytest.approx(48 * np.sin(np.pi / 24) * unit, rel=1e-6)  # once round
    generators = stress_trajectories(structure, spacing=0.2 * unit, second=True)
    assert 26 <= len(generators) <= 34
    for line in generators:
        assert np.ptp(line.points[:, :2], axis=0).max() < 1e-8 * unit
        assert line.length == pytest.approx(2 * unit, rel=1e-8)


def test_circles_in_a_plane_are_of_second_order():
    errors = []
    for n in (16, 32):
        points, triangles = rectangle(2.0, 2.0, n, n)
        x, y, _ = points[triangles].mean(axis=1).T
        round_about = np.column_stack([-y, x, 0 * x])
        sheet = Membrane(triangles, FABRIC, prestress=(2e3, 1e3), warp=round_about)
        lines = stress_trajectories(Structure(points, {"sheet": sheet}), spacing=0.25)
        radii = [np.linalg.norm(line.points[:, :2], axis=1) for line in lines]
        errors.append(max(np.ptp(radius) for radius in radii if radius.min() > 0.3 and radius.max() < 0.9))
    assert errors[1] < errors[0] / 3
    assert errors[1] < 0.01


@pytest.mark.parametrize("spacing", [0.15, 0.5])
def test_lines_keep_their_distance_and_leave_no_gaps(spacing):
    points, triangles = uneven(columns=16, rows=12)
    points[:, 2] = 0.1 * points[:, 0] * points[:, 1]
    x, y, _ = points[triangles].mean(axis=1).T
    sheet = Membrane(triangles, FABRIC, prestress=(2e3, 1e3), warp=np.column_stack([1 + 0 * x, 0.5 * np.sin(x + y), y]))
    lines = stress_trajectories(Structure(points, {"sheet": sheet}), spacing=spacing)
    for number, line in enumerate(lines):
        others = np.concatenate([other.points for other in lines[:number] + lines[number + 1 :]])
        assert cKDTree(others).query(line.points)[0].min() > 0.5 * spacing
    every = cKDTree(np.concatenate([line.points for line in lines]))
    gaps = every.query(points[triangles].mean(axis=1))[0]
    assert np.quantile(gaps, 0.98) < spacing
    assert gaps.mean() < 0.35 * spacing  # a quarter for the most even ones


def test_equal_stress_in_all_directions_has_no_lines():
    points, triangles = uneven()
    assert stress_trajectories(Structure(points, {"film": Membrane(triangles, FABRIC, prestress=2e3)})) == []


def test_skins_near_each_other_each_have_their_lines():
    points, triangles = rectangle(4.0, 3.0, 8, 6)
    skins = {
        name: Membrane(triangles + shift, FABRIC, prestress=(2e3, 1e3), warp=(1, 0, 0))
        for name, shift in (("low", 0), ("high", len(points)))
    }
    both = np.concatenate([points, points + np.array([0, 0, 0.01])])
    structure = Structure(both, skins)
    lines = stress_trajectories(structure, spacing=0.3)
    alone = stress_trajectories(structure, "high", spacing=0.3)
    assert len(lines) == 2 * len(alone)
    assert [int((line.cells >= len(triangles)).all()) for line in lines].count(1) == len(alone)


def test_lines_end_where_surfaces_branch():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    upright = points[:, [0, 2, 1]] + np.array([0, 0, 1.0])  # stands on the row y = 0 of the first
    fin = np.where(np.isclose(upright[:, 2], 0), np.arange(25) % 5 + 10, np.arange(25) + 25)
    parts = {
        name: Membrane(cells, FABRIC, prestress=(2e3, 1e3), warp=warp)
        for name, cells, warp in (("flat", triangles, (0, 1, 0)), ("fin", fin[triangles], (0, 0, 1)))
    }
    lines = stress_trajectories(Structure(np.concatenate([points, upright]), parts), spacing=0.3)
    flat = [line for line in lines if line.cells.max() < len(triangles)]
    upper = [line for line in lines if line.cells.min() >= len(triangles)]
    assert len(flat) + len(upper) == len(lines)
    for lines_there, across in ((flat, 1), (upper, 2)):
        assert len(lines_there) > 5
        for line in lines_there:
            assert np.ptp(np.sign(line.points[:, across].round(6))) < 2  # on one side of the common row
    assert {round(line.length, 6) for line in upper} == {2.0}


def test_wrinkled_and_slack_cells():
    """Wrinkled cells have lines along the tension only, and of wrinkles; slack cells have none."""
    state = folded()["fold"]
    found = state.membrane("fabric").state
    assert set(found) == {"wrinkled", "slack"}
    for lines in (stress_trajectories(state, spacing=0.2), wrinkle_lines(state, spacing=0.2)):
        assert lines
        for line in lines:
            assert set(found[line.cells]) == {"wrinkled"}
            assert np.ptp(line.points[:, 1]) < 1e-8
    assert stress_trajectories(state, spacing=0.2, second=True) == []


def test_each_wrinkled_cell_alone_has_a_line():
    state = folded()["fold"]
    fabric = state.membrane("fabric")
    where = np.flatnonzero(fabric.state == "wrinkled")[::7]
    fabric.state[:] = "taut"
    fabric.state[where] = "wrinkled"
    lines = wrinkle_lines(state, spacing=0.05)
    assert set(np.concatenate([line.cells for line in lines])) == set(where)


@pytest.mark.filterwarnings("error")
def test_collapsed_slack_cells_are_passed_over():
    """A slack cell may have no area: its neighbours have the lines that they had."""
    state = folded()["fold"]
    fabric = state.structure.parts["fabric"]
    slack = np.flatnonzero(state.membrane("fabric").state == "slack")
    first, second, _ = fabric.cells[slack[0]]
    displacement = state.displacement.copy()
    displacement[second] = state.position[first] - state.structure.points[second]
    state = replace(state, displacement=displacement)
    lines = stress_trajectories(state, spacing=0.2)
    assert lines
    assert not set(np.concatenate([line.cells for line in lines])) & set(slack)
    assert len(wrinkle_lines(state)) > 5


def test_archive_has_the_same_lines(tmp_path):
    results = folded()
    save_results(results, tmp_path / "fold.fxm")
    opened = load_results(tmp_path / "fold.fxm")
    for one, other in zip(stress_trajectories(results["fold"]), stress_trajectories(opened["fold"]), strict=True):
        assert np.array_equal(one.points, other.points)


def test_form_has_the_lines_of_its_stress():
    points, triangles = rectangle(4.0, 4.0, 8, 8)
    rim = np.unique(boundary_edges(triangles))
    points[rim, 2] = 0.1 * points[rim, 0] * points[rim, 1]
    woven = Membrane(triangles, FABRIC, prestress=(2e3, 1e3), warp=(1, 0, 0))
    form = natural_force_density(Structure(points, {"sail": woven}, [Support(rim)]))
    lines = stress_trajectories(form, spacing=0.5)
    assert 5 < len(lines) < 11
    assert all(np.abs(line.directions[:, 0]).min() > 0.8 for line in lines)
    assert wrinkle_lines(form) == []


def test_even_lines_along_the_warp():
    points, triangles = uneven()
    strip = Membrane(triangles, FABRIC, prestress=2e3, warp=(1, 0, 0))
    lines = warp_lines(Structure(points, {"strip": strip}), spacing=0.3)
    assert 8 <= len(lines) <= 11
    assert all(np.ptp(line.points[:, 1]) < 1e-8 for line in lines)


@pytest.mark.parametrize(
    ("lines", "options", "message"),
    [
        (stress_trajectories, {"spacing": 0}, "^spacing.*positive"),
        (stress_trajectories, {"spacing": 1e-5}, r"^spacing is 1e-05, .* 5e\+11 segments; give at least 0\.015"),
        (stress_trajectories, {"part": "roof"}, "roof"),
        (stress_trajectories, {"second": 2}, "^second"),
        (wrinkle_lines, {"spacing": np.nan}, "^spacing"),
        (warp_lines, {"starts": [0], "spacing": 0.1}, "^spacing is given with starts"),
    ],
)
def test_refusals(lines, options, message):
    points, triangles = rectangle(4.0, 3.0, 4, 3)
    structure = Structure(points, {"strip": Membrane(triangles, FABRIC, prestress=2e3)})
    with pytest.raises(ValueError, match=message):
        lines(structure, **options)


@pytest.mark.parametrize("lines", [stress_trajectories, wrinkle_lines])
def test_wrong_shapes_are_refused(lines):
    with pytest.raises(ValueError, match=r"shape is 5; give a StageResult, a Form or a Structure"):
        lines(5)
