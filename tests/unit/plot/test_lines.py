"""Lines on membranes in pictures: fixed to nodes, in their colours; hatching of slack cells; refusals."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    load_results,
    natural_force_density,
    plot,
    polyline,
    rectangle,
    save_results,
    stress_trajectories,
)
from fx_membrane.plot import marks, scene, windows
from fx_membrane.plot.subjects import shown
from pictures import assert_drawn, has_colour, picture

CUT, TRIANGLES = rectangle(2.0, 2.0, 6, 6)
WOVEN = Membrane(TRIANGLES, Fabric(1e5, 0.3), (2e3, 1e3), warp=(1, 0, 0))


@pytest.fixture
def small(monkeypatch):
    """Small windows, which are drawn fast."""
    pytest.importorskip("pyvista")
    monkeypatch.setattr(windows, "LONGER", 500)


@pytest.fixture(scope="module")
def folded():
    """Square with a wrinkled and a slack half."""
    east = np.where(CUT[:, 0] > 0, -0.02, 0.02)
    moves = np.column_stack([east * CUT[:, 0], -0.02 * CUT[:, 1], 0 * east])
    structure = Structure(CUT, {"fabric": Membrane(TRIANGLES, Fabric(1e5, 0.3))}, [Support(range(49), "z")])
    fold = Stage("fold", displacements=[PrescribedDisplacement(range(49), moves, "xy")])
    return Analysis(structure).run([fold])


def test_lines_follow_their_nodes():
    subject = shown("a test", Structure(CUT, {"sail": WOVEN}))
    (group,) = marks.strokes(subject, ["stress I"], 0.4)
    lines = stress_trajectories(subject.shape, spacing=0.4)
    assert group.counts.tolist() == [len(line.points) for line in lines]
    assert np.abs(group.at(CUT) - np.concatenate([line.points for line in lines])).max() < 1e-8
    turned = CUT[:, [1, 2, 0]] * 3 + 1
    assert np.abs(group.at(turned) - (group.at(CUT)[:, [1, 2, 0]] * 3 + 1)).max() < 1e-12


def test_all_slack_cells_are_hatched_and_no_others(folded):
    subject = shown("a test", folded["fold"])
    state = folded["fold"].membrane("fabric").state
    assert 0 < len(subject.slack) == np.count_nonzero(state == "slack") < len(state)
    across = np.array([1.0, -1.0, 0.0]) / np.sqrt(2)
    ends, owner = marks.hatching(CUT, subject.slack, across, 0.05)
    assert set(owner) == set(range(len(subject.slack)))
    level = ends @ across / 0.05
    assert np.abs(level - level.round()).max() < 1e-9  # one family of parallel lines
    assert np.abs(level[:, 0] - level[:, 1]).max() < 1e-9
    corners = CUT[subject.slack[owner]]
    assert (ends.min(axis=1) >= corners.min(axis=1) - 1e-12).all()
    assert (ends.max(axis=1) <= corners.max(axis=1) + 1e-12).all()


@pytest.mark.parametrize("length", [0.3, 0.07, 5.0])
def test_dashes_cover_every_other_length_of_their_lines(length):
    """Two lines, of which one bends: dashes lie on them, and are as long as the others of the same length."""
    places = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (5, 5, 5), (5, 5, 7.0)])
    found, counts = marks.dashes(places, np.array([3, 2]), length)
    ends = found.reshape(-1, 2, 3)
    assert counts.tolist() == [2] * len(ends)
    sizes = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    assert (sizes > 0).all()
    every = np.arange(0, 2.0, 2 * length)
    assert sizes.sum() == pytest.approx(2 * np.minimum(length, 2.0 - every).sum())
    on = [(ends[:, :, 1:] == 0).all(axis=(1, 2)), (ends[:, :, 0] == 1).all(axis=1) & (ends[:, :, 2] == 0).all(axis=1)]
    on.append((ends[:, :, :2] == 5).all(axis=(1, 2)))
    assert np.logical_or.reduce(on).all()


@pytest.mark.parametrize("cells", [[5], [0, 71], [3, 4, 60]])
def test_small_slack_regions_are_hatched(cells):
    """Wide hatching would miss a cell: each connected region has a line."""
    ends, owner = marks.hatching(CUT, TRIANGLES[cells], np.array([0.6, 0.8, 0.0]), 50.0)
    regions = 1 if cells == [5] else 2
    assert len(owner) >= regions
    assert (np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1) > 0.05).all()


def test_no_slack_cells_have_no_hatching():
    ends, owner = marks.hatching(CUT, TRIANGLES[:0], np.array([0.6, 0.8, 0.0]), 0.1)
    assert ends.shape == (0, 2, 3)
    assert owner.shape == (0,)


def test_trajectories_leave_wrinkled_cells_to_wrinkles(folded):
    subject = shown("a test", folded["fold"])
    first, wrinkles = marks.strokes(subject, ["stress I", "wrinkles"], 0.3)
    assert len(first.counts) == 0
    assert len(wrinkles.counts) > 5
    (alone,) = marks.strokes(subject, ["stress I"], 0.3)
    assert len(alone.counts) > 2


def test_trajectories_are_drawn_with_a_legend(folded, tmp_path, small):
    path = tmp_path / "folder" / "fold.png"
    plot.trajectories(folded["fold"], path, view=(0, 0, 1), axes=True)
    assert_drawn(path, colours=5)
    for kind in ("wrinkles", "slack"):
        assert has_colour(path, marks.PLAIN[kind]), kind
    for kind in ("stress I", "stress II"):  # are not there
        assert not has_colour(path, marks.PLAIN[kind]), kind


def test_results_of_an_archive_are_drawn_the_same(folded, tmp_path, small):
    save_results(folded, tmp_path / "fold.fxm")
    for name, results in (("one", folded), ("other", load_results(tmp_path / "fold.fxm"))):
        plot.trajectories(results["fold"], tmp_path / f"{name}.png", spacing=0.3)
    assert np.array_equal(picture(tmp_path / "one.png"), picture(tmp_path / "other.png"))


def test_forms_and_structures_are_drawn(tmp_path, small):
    rim = np.unique(boundary_edges(TRIANGLES))
    points = CUT + np.column_stack([0 * CUT[:, :2], 0.3 * CUT[:, 0] * CUT[:, 1]])
    edge = Cable(polyline(np.arange(21, 28)), 1e6, 1e3)
    form = natural_force_density(Structure(points, {"sail": WOVEN, "edge": edge}, [Support(rim)]))
    plot.contours(form, {"error": form.differences | {"edge": np.zeros(6)}}, tmp_path / "form.png", forces=True)
    assert_drawn(tmp_path / "form.png")
    heights = {"height [m]": points[:, 2]}
    plot.contours(form.structure, heights, tmp_path / "structure.png", lines=["warp", "stress II"], spacing=0.4)
    assert has_colour(tmp_path / "structure.png", marks.COLOURED["warp"])
    assert shown("a test", form).forces["edge"] == pytest.approx(form.forces["edge"])


def test_lines_are_drawn_where_they_are(small):
    """In plan, a line along x at a known y has its colour in the pixels of its row, and no others."""
    subject = shown("a test", Structure(CUT, {"sail": WOVEN}))
    look = {"scale": 1.0, "view": (0, 0, 1), "mirror": None, "antisymmetric": False}
    group = marks.strokes(subject, ["stress I"], 0.8)
    image = scene.picture(subject, None, None, strokes=group, **look).astype(int)
    red = (image[:, :, 0] - image[:, :, 2] > 60).mean(axis=1)
    window = windows.window_of([CUT], (0, 0, 1))
    height = window.high[1] - (np.flatnonzero(red > 0.5) + 0.5) / len(red) * (window.high[1] - window.low[1])
    wanted = np.unique(group[0].at(CUT)[:, 1].round(6))
    assert np.abs(height[:, None] - wanted).min(axis=1).max() < 0.02
    assert np.abs(height[:, None] - wanted).min(axis=0).max() < 0.02


def test_forces_have_their_own_colours(result, tmp_path, small):
    heights = {"height": result.structure.points[:, 2]}
    for name, options in (("plain", {}), ("coloured", {"forces": True, "force_unit": "kN"})):
        plot.contours(result, heights, tmp_path / f"{name}.png", **options)
    assert has_colour(tmp_path / "plain.png", scene.INK)
    assert picture(tmp_path / "coloured.png").shape[0] > picture(tmp_path / "plain.png").shape[0]  # another bar


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"lines": ["stress"]}, r"^lines, an entry, is 'stress'; give some of \['stress I', 'stress II', 'warp'"),
        ({"lines": "stress I"}, "^lines"),
        ({"lines": ["warp"]}, "^lines has 'warp', but no membrane has one; give it"),
        ({"lines": ["slack"], "spacing": 0}, "^spacing"),
        ({"lines": ["stress I"], "spacing": 1e-6}, "^spacing is 1e-06, .* segments; give at least"),
        ({"forces": True}, "^forces is True, but the structure has no cables or masts"),
        ({"axes": "yes"}, "^axes"),
        ({"length_unit": 3}, "^length_unit"),
    ],
)
def test_wrong_options_are_refused(tmp_path, options, message):
    film = Structure(CUT, {"film": Membrane(TRIANGLES, Fabric(1e5, 0.3), (2e3, 1e3), warp=(1, 0, 0))})
    if options.get("lines") == ["warp"]:
        film = Structure(CUT, {"film": Membrane(TRIANGLES, Fabric(1e5, 0.3), 2e3)})
    with pytest.raises(ValueError, match=message):
        plot.contours(film, {"height": CUT[:, 2]}, tmp_path / "never.png", **options)
    assert not list(tmp_path.iterdir())


def test_lines_without_membranes_are_refused(tmp_path):
    rope = Structure([(0, 0, 0), (1, 0, 0)], {"rope": Cable([[0, 1]], 1e6, 1e3)})
    with pytest.raises(ValueError, match=r"^lines is \['slack'\], but the structure has no membrane"):
        plot.trajectories(rope, tmp_path / "never.png", lines=["slack"])
    with pytest.raises(ValueError, match=r"^lines is empty"):
        plot.trajectories(rope, tmp_path / "never.png", lines=[])
    with pytest.raises(ValueError, match=r"^The first argument of trajectories is 5; give a StageResult, a Form"):
        plot.trajectories(5, tmp_path / "never.png")
