"""Contours: visible content, a sensible size, and refusal of wrong fields."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    plot,
    rectangle,
)
from fx_membrane.plot import scene
from pictures import POINTS, assert_drawn, has_colour, picture


@pytest.fixture
def drawing():
    return pytest.importorskip("pyvista")


def states(result):
    return {name: result.membrane(name).state for name in ("south", "north")}


def cell_values(result):
    return {name: result.membrane(name).principal[:, 0] for name in ("south", "north")}


def half(result):
    """Part of the roof with y < 0 alone, as a model cut at its plane of symmetry."""
    parts = {"south": result.structure.parts["south"]}
    nodes = np.unique(parts["south"].cells)
    structure = Structure(POINTS, parts, [Support(nodes)])
    return Analysis(structure).run([Stage("half")])["half"]


def test_contours_of_nodal_and_cell_values_and_states(result, tmp_path, drawing):
    fields = {"deflection": result.displacement[:, 2], "tension": cell_values(result), "state": states(result)}
    path, one = tmp_path / "folder" / "three.png", tmp_path / "one.png"
    plot.contours(result, fields, path)
    wide = assert_drawn(path, colours=30)
    plot.contours(result, {"deflection": result.displacement[:, 2].tolist()}, str(one))
    narrow = assert_drawn(one, colours=20)
    assert wide == pytest.approx(3 * narrow, rel=0.15)


def test_wrinkled_and_slack_cells_are_coloured(tmp_path, drawing):
    """One strip of the square wrinkles, the other is slack: the map shows it, not only the legend."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    fabric = {"fabric": Membrane(triangles, Fabric(Et=1e5, nu=0.3))}
    east = np.where(points[:, 0] > 0, -0.02, 0.02)
    moves = PrescribedDisplacement(
        range(25), np.column_stack([east * points[:, 0], -0.02 * points[:, 1], 0 * east]), "xy"
    )
    structure = Structure(points, fabric, [Support(range(25), "z")])
    folded = Analysis(structure).run([Stage("fold", displacements=[moves])])["fold"]
    state = folded.membrane("fabric").state
    assert set(state) == {"wrinkled", "slack"}
    shares = {}
    for name, states in [("as it is", state), ("all taut", np.full(len(state), "taut"))]:
        path = tmp_path / f"{name}.png"
        plot.contours(folded, {"state": {"fabric": states}}, path, view=(0, -0.2, 1))
        hue = picture(path)
        shares[name] = (hue[:, :, 0] - hue[:, :, 2] > 0.2).mean()  # orange and red, not the green of taut cells
    assert shares["as it is"] > 5 * shares["all taut"]


def test_states_have_their_colours(result, tmp_path, drawing):
    path = tmp_path / "states.png"
    plot.contours(result, {"state": states(result)}, path, view=(0, -0.2, 1))
    for state in ("taut", "wrinkled", "slack"):  # all three are in the legend
        assert has_colour(path, plot.STATES[state]), state


@pytest.mark.parametrize(
    "values",
    [np.zeros(26), np.full(26, -5.0), np.arange(26) > 9],
    ids=["zeros", "constant", "yes and no"],
)
def test_contours_of_any_numbers(result, tmp_path, values, drawing):
    plot.contours(result, {"values": values}, tmp_path / "values.png")
    assert_drawn(tmp_path / "values.png")


def test_scale_enlarges_the_displacements(result, tmp_path, drawing):
    for scale in (0.0, 3.0):
        plot.contours(result, {"height": POINTS[:, 2]}, tmp_path / f"{scale}.png", scale=scale, view=(0, -1, 0.2))
    assert not np.array_equal(picture(tmp_path / "0.0.png"), picture(tmp_path / "3.0.png"))


def test_values_beyond_limits_have_the_colour_of_the_end(result, tmp_path, drawing):
    cells = result.structure.parts["south"].cells
    smooth = POINTS[cells].mean(axis=1)[:, 0]
    first = np.arange(len(cells)) == 0
    fields = {"peak": np.where(first, 1e3, smooth), "end": np.where(first, 2.1, smooth)}
    for name, values in fields.items():
        for limits in ({}, {"x": (-1.0, 2.0)}):
            path = tmp_path / f"{name} {len(limits)}.png"
            plot.contours(result, {"x": {"south": values}}, path, ranges=limits, view=(0, -0.2, 1))
    assert np.array_equal(picture(tmp_path / "peak 1.png"), picture(tmp_path / "end 1.png"))
    assert not np.array_equal(picture(tmp_path / "peak 0.png"), picture(tmp_path / "peak 1.png"))
    assert not np.array_equal(picture(tmp_path / "end 0.png"), picture(tmp_path / "end 1.png"))  # <= and >= are written


@pytest.mark.parametrize(("mirror", "ratio"), [(None, 2.0), ("y", 1.0)])
def test_mirror_draws_the_other_half(result, mirror, ratio, drawing):
    # Seen nearly from above the half is twice as wide as deep, the whole as wide as deep.
    colours = scene.Colours("viridis", -1.0, 1.0, 16)
    drawn = scene.picture(
        half(result), POINTS[:, 0], colours, scale=1.0, view=(0, -0.2, 1), mirror=mirror, antisymmetric=False
    )  # without the scale of a whole figure, which would be measured, too
    ink = np.argwhere((drawn < 250).any(axis=2))
    height, width = np.ptp(ink, axis=0)
    assert width / height == pytest.approx(ratio, rel=0.1)


@pytest.mark.parametrize(
    ("field", "message"),
    [
        (np.zeros(25), r"^Field 'title'.*shape \(25,\).*one value.*node"),
        (np.zeros((26, 3)), r"^Field 'title'.*shape \(26, 3\).*one value.*node"),
        (5.0, r"^Field 'title'.*shape \(\).*one value.*node"),
        ({"south": np.zeros(16), "roof": np.zeros(16)}, r"^Field 'title'.*parts \['south', 'roof'\]"),
        ({}, r"^Field 'title'.*parts \[\]"),
        ({"south": np.zeros(16), "north": np.zeros(17)}, r"^Field 'title' on 'north' has shape \(17,\)"),
        ({"south": np.zeros((16, 2)), "north": np.zeros(16)}, r"^Field 'title' on 'south' has shape \(16, 2\)"),
        (np.full(26, np.nan), r"^Field 'title' .*not finite"),
        ({"south": np.full(16, "taut"), "north": np.full(16, "torn")}, r"^Field 'title' .*torn"),
        (np.full(26, "taut"), r"^Field 'title' "),
    ],
    ids=[
        "too few", "vectors", "number", "unknown part", "no part", "too many cells", "pairs", "nan",
        "unknown state", "states of nodes",
    ],
)  # fmt: skip
def test_wrong_fields_are_refused(result, tmp_path, field, message):
    path = tmp_path / "never.png"
    with pytest.raises(ValueError, match=message):
        plot.contours(result, {"right": np.zeros(26), "title": field}, path)
    assert not path.exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"view": (0, 0, 0)}, r"^view is \(0, 0, 0\); give a direction"),
        ({"view": "above"}, "^view.*array.*numbers .*'above'"),
        ({"scale": "large"}, "^scale.*text 'large'"),
        ({"antisymmetric": ["width"]}, r"^antisymmetric names 'width'; the fields are \['height'\]"),
        ({"ranges": {"width": (0, 1)}}, r"^ranges names 'width'; the fields are \['height'\]"),
        (
            {"ranges": {"height": (1, 1)}},
            r"^The range.*'height' is \(1, 1\).*\(low, high\).*lower one first",
        ),
        ({"ranges": {"height": (2, -1)}}, r"^The range of 'height' is \(2, -1\); give \(low, high\)"),
        ({"ranges": {"height": 5}}, r"^The range of 'height' is 5; give \(low, high\)"),
        ({"ranges": {"height": (0, np.inf)}}, r"^range.*'height'.*value.*not finite \(inf\)"),
    ],
)
def test_wrong_options_are_refused(result, tmp_path, options, message):
    with pytest.raises(ValueError, match=message):
        plot.contours(result, {"height": POINTS[:, 2]}, tmp_path / "never.png", **options)


def test_limits_of_states_are_refused(result, tmp_path):
    with pytest.raises(ValueError, match=r"^ranges.*'state'.*shows states; leave"):
        plot.contours(result, {"state": states(result)}, tmp_path / "never.png", ranges={"state": (0, 1)})


@pytest.mark.parametrize("mirror", ["xy", "", "w", 0])
def test_wrong_mirror_is_refused(result, tmp_path, mirror):
    with pytest.raises(ValueError, match=rf"^mirror is {mirror!r}; give"):
        plot.contours(result, {"height": POINTS[:, 2]}, tmp_path / "never.png", mirror=mirror)
