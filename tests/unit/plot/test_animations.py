"""Moving pictures: number and size of frames, one camera, one scale; refusals."""

import sys

import numpy as np
import PIL.Image
import PIL.ImageSequence
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    Stage,
    StageResults,
    Structure,
    Support,
    boundary_edges,
    equilibrium_path,
    natural_frequencies,
    plot,
    polyline,
    rectangle,
)
from fx_membrane.plot import animations, panels, windows


@pytest.fixture
def small(monkeypatch):
    """Small windows, which are drawn fast."""
    pytest.importorskip("pyvista")
    monkeypatch.setattr(windows, "LONGER", 300)


@pytest.fixture(scope="module")
def steps():
    """Three load increments of a sail with a cable, and its stages."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points[:, 2] = 0.2 * points[:, 0] * points[:, 1]
    sail = Membrane(triangles, Fabric(1e5, 0.3), (2e3, 1e3), warp=(1, 0, 0), mass=1.0)
    parts = {"sail": sail, "ridge": Cable(polyline(range(10, 15)), 1e6, 2e3, mass=0.5)}
    structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
    found = []
    snow = [Stage("snow", [DistributedLoad((0, 0, -500.0), "sail")], increments=3)]
    results = Analysis(structure).run([*snow, Stage("none")], observe=found.append)
    return found[:3], results


@pytest.fixture
def settings(monkeypatch):
    """Figure, subject, panels and setting of each frame that is drawn."""
    seen = []
    draw = panels.draw_panels

    def watched(figure, subject, shows, look, same, groups):
        seen.append((figure, subject, shows, same))
        draw(figure, subject, shows, look, same, groups)

    monkeypatch.setattr(animations, "draw_panels", watched)
    return seen


def frames(path):
    with PIL.Image.open(path) as image:
        found = [np.asarray(frame.convert("RGB")) for frame in PIL.ImageSequence.Iterator(image)]
        return found, image.info["duration"]


def test_load_increments_in_one_scale(steps, tmp_path, small, settings):
    path = tmp_path / "folder" / "snow.gif"
    states = steps[0]
    plot.animation(states, path, lines=["stress I"], forces=True, axes=True, seconds=0.5)
    found, duration = frames(path)
    assert len(found) == len(states) == 3
    assert len({frame.shape for frame in found}) == 1
    assert duration == 500
    titles = [figure.get_suptitle() if hasattr(figure, "get_suptitle") else figure._suptitle.get_text()
              for figure, *_ in settings]  # fmt: skip
    assert titles == ["snow, load factor 0.333", "snow, load factor 0.667", "snow, load factor 1.000"]
    largest = max(state.largest_displacement for state in states)
    for _, _, (panel,), same in settings:
        assert (panel.colours.low, panel.colours.high) == pytest.approx((0, largest))
        assert same is settings[0][3]
    forces = np.concatenate([state.cable("ridge").force for state in states])
    assert (same.bars.low, same.bars.high) == pytest.approx((forces.min(), forces.max()))
    changed = (found[0] != found[2]).any(axis=2)
    assert 0.01 < changed.mean() < 0.6
    assert (found[0][0, 0] == 255).all()  # paper is white
    # Everything but the structure, its title and its values stays: the last rows hold the scales.
    assert not changed[-40:].any()


def test_stages_by_their_names(steps, tmp_path, small, settings):
    results = steps[1]
    plot.animation(
        results,
        tmp_path / "stages.gif",
        fields=lambda state: {
            "stress": {"sail": state.membrane("sail").principal[:, 0]},
            "state": {"sail": state.membrane("sail").state},
        },
        smoothed=["stress"],
        ranges={"stress": (0, 5e3)},
    )
    assert len(frames(tmp_path / "stages.gif")[0]) == 2
    for _, _, (stress, state), _ in settings:
        assert stress.title == "stress (smoothed)"
        assert (stress.colours.low, stress.colours.high) == (0, 5e3)
        assert state.colours.bands == 3


def test_a_mode_swings_through_its_state(steps, tmp_path, small, settings):
    state = steps[0][-1]
    shape = natural_frequencies(state, 1).shapes[0]
    plot.animation(state, tmp_path / "mode.gif", motion=shape, frames=4)
    assert len(frames(tmp_path / "mode.gif")[0]) == 4
    moved = [subject.displacement - state.displacement for _, subject, *_ in settings]
    assert np.linalg.norm(moved[0], axis=1).max() == pytest.approx(0.1 * state.structure.size)
    assert moved[0] == pytest.approx(-moved[2])
    assert np.abs(moved[1]).max() < 1e-12
    assert settings[0][2][0].colours.high == pytest.approx(1)


def test_a_path_by_its_points(tmp_path, small, settings):
    points = [(-1, 0, 0), (0, 0, 0.3), (1, 0, 0)]
    truss = Structure(points, {"truss": Mast([[0, 1], [1, 2]], 1e6)}, [Support([0, 2]), Support(1, "y")])
    path = equilibrium_path(truss, Stage("push", [PointLoad(1, (0, 0, -5e3))], increments=2))
    plot.animation(path, tmp_path / "push.gif", view=(0, -1, 0))
    assert len(settings) == len(path.points)
    with pytest.raises(ValueError, match=r"^An EquilibriumPath has displacements only.*path\.state"):
        plot.animation(path, tmp_path / "never.gif", forces=True)


def test_mp4_without_its_library_names_the_remedy(steps, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(ImportError, match=r"imageio-ffmpeg: pip install 'fx-membrane\[video\]'; or .* \.gif"):
        plot.animation(steps[0], tmp_path / "folder" / "snow.mp4")
    assert not list(tmp_path.iterdir())


def test_mp4_has_all_frames(steps, tmp_path, small):
    library = pytest.importorskip("imageio_ffmpeg")
    plot.animation(steps[0], tmp_path / "snow.mp4", seconds=0.5)
    count, seconds = library.count_frames_and_secs(str(tmp_path / "snow.mp4"))
    assert seconds == pytest.approx(1.5, abs=0.11)
    assert count == 15


@pytest.mark.parametrize(
    ("states", "options", "message"),
    [
        ([], {}, r"^The first argument of animation has 0 states; give 1 to"),
        (StageResults(), {}, r"^The first argument of animation has 0 states"),
        ("one", {}, r"^The first argument of animation is one state.*list of states.*motion"),
        (5, {}, r"^The first argument of animation is 5; give StageResults, a list of states"),
        (["snow"], {}, r"^The first argument of animation is 'snow'; give a StageResult"),
        ("all", {"motion": np.zeros((25, 3))}, r"^The first argument of animation with a motion"),
        ("one", {"motion": np.zeros((25, 3))}, r"^motion is zero"),
        ("one", {"motion": np.ones((24, 3))}, r"^motion has shape \(24, 3\); give \(25, 3\)"),
        ("one", {"motion": np.ones((25, 3)), "frames": 0}, "^frames"),
        ("all", {"seconds": 0}, "^seconds"),
        ("all", {"fields": {}}, r"^fields is \{\}; give a function of a state"),
        ("all", {"fields": lambda state: {}}, "^fields is empty"),
        ("all", {"fields": lambda state: {f"{id(state)}": np.zeros(25)}}, "^fields returns other titles"),
        ("all", {"ranges": {"width": (0, 1)}}, "^ranges names 'width'"),
        ("all", {"path": "snow.png"}, r"^path is .*snow\.png'; give a name that ends in \.gif or \.mp4"),
    ],
)
def test_refusals(steps, tmp_path, states, options, message):
    given = {"one": steps[0][0], "all": steps[0]}.get(states, states) if isinstance(states, str) else states
    path = tmp_path / options.pop("path", "never.gif")
    with pytest.raises(ValueError, match=message):
        plot.animation(given, path, **options)
    assert not list(tmp_path.iterdir())
