"""Scenes in a browser: numbers of every stage and field, no request, no error, pictures that are not blank."""

import io
import itertools
import json
import urllib.parse

import numpy as np
import pytest

import chromium
from chromium import FRAMES
from fx_membrane import Fabric, Membrane, Structure, Support, rectangle, write_scene
from scene_models import EVIL, results

pytest.importorskip("plotly")
pytestmark = [
    pytest.mark.skipif(not chromium.program(), reason="no Chromium: apt install chromium, or run .ci/browser"),
]


@pytest.fixture(scope="module")
def found():
    return results()


@pytest.fixture(scope="module")
def address(found, tmp_path_factory):
    file = tmp_path_factory.mktemp("scene") / "roof.html"
    write_scene(found, file, title=f"Roof {EVIL}", force_unit="kN")
    return file.as_uri()


@pytest.fixture(scope="module")
def browser(tmp_path_factory, address):
    with chromium.page(tmp_path_factory.mktemp("profile")) as page:
        page.size(400, 500)
        page.open(address)
        yield page


@pytest.fixture
def page(browser, address):
    """Open a small page, since each point costs without a graphics card; in the end it has neither asked nor failed."""
    browser.size(400, 500)
    if browser.run("location.href.split('#')[0]") != address:
        browser.requests.clear()
        browser.open(address)
    browser.run("document.getElementById('more').open = false; figure.scrollIntoView()")
    yield browser
    assert browser.messages == []
    asked = {request.split("#")[0] for request in browser.requests if not request.startswith("data:")}
    assert asked == {address}


KINDS = ("displacement z", "state", "stress along warp", "force")  # of nodes, texts, membranes, bars


def expected(state):
    """Least and largest value by field, from NumPy."""
    moved = {"displacement": np.linalg.norm(state.displacement, axis=1)}
    moved |= {f"displacement {axis}": state.displacement[:, row] for row, axis in enumerate("xyz")}
    fabric = state.membrane(EVIL)
    bars = [part for part in state.parts.values() if part.dimension == 1]
    states = [(part.state[:, None] == ["taut", "wrinkled", "slack"]).argmax(axis=1) for part in [fabric]]
    states += [np.where(part.slack, 2, 0) for part in bars]
    values = moved | {
        "state": np.concatenate(states),
        "strain warp": fabric.strain[:, 0, 0],
        "strain weft": fabric.strain[:, 1, 1],
        "strain shear": fabric.strain[:, 0, 1],
        "principal stress I": fabric.principal[:, 0],
        "principal stress II": fabric.principal[:, 1],
        "stress along warp": fabric.warp_weft_stress[:, 0],
        "stress along weft": fabric.warp_weft_stress[:, 1],
        "strain": np.concatenate([part.strain for part in bars]),
        "force": np.concatenate([part.force for part in bars]),
    }
    return {name: (found.min(), found.max()) for name, found in values.items()}


def test_every_stage_and_field_shows_the_least_and_largest_value(page, found):
    fields = json.loads(page.run("JSON.stringify(scene.fields.map((field) => field.name))"))
    last = list(found)[-1]
    for stage, state in found.items():
        values = expected(state)
        assert set(fields) == set(values)
        for field in fields if stage == last else KINDS:  # each takes the browser a third of a second
            wanted = urllib.parse.urlencode({"stage": stage, "field": field})
            shown = page.change(f"location.hash = {json.dumps(wanted)}")
            assert (shown["stage"], shown["field"]) == (stage, field)
            assert (shown["least"], shown["largest"]) == values[field]
            np.testing.assert_allclose(shown["drawn"], values[field], rtol=1e-6)  # as float32, from the traces
            if field == "state":
                continue
            words = page.run("['least', 'largest'].map((end) => document.querySelector(`b.${end}`).textContent)")
            assert [float(word) for word in words] == [float(f"{value:.5g}") for value in values[field]]
            unit = page.run("document.querySelector('#legend h2').textContent")
            assert unit.startswith(f"{field} [")


def colours(page, box):
    """Pixels of a part of the window that are not grey, shape (high, wide)."""
    image = pytest.importorskip("matplotlib.image")
    x, y, wide, high = box
    return np.ptp(image.imread(io.BytesIO(page.picture()))[y : y + high, x : x + wide, :3], axis=2) > 0.2


def wait_for_the_new_size(page):
    """Wait until the observer of the size has drawn anew."""
    same = (
        "(({clientWidth, clientHeight}) => clientWidth === figure.clientWidth && clientHeight === figure.clientHeight)"
    )
    for _ in range(200):  # the observer of the size draws anew
        if page.run(f"{FRAMES}.then(() => {same}(figure.querySelector('canvas')))"):
            break


@pytest.mark.parametrize(("width", "height"), [(1400, 900), (390, 800)])
def test_picture_fills_the_window(page, width, height):
    page.size(width, height)
    page.change("control.field.value = 8; control.field.dispatchEvent(new Event('change'))")
    wait_for_the_new_size(page)
    assert page.run("document.documentElement.scrollWidth - document.documentElement.clientWidth") <= 0
    box = page.run("(({x, y, width, height}) => [x, y, width, height])(figure.getBoundingClientRect())")
    x, y, wide, high = map(int, box)
    assert wide == page.run("document.documentElement.clientWidth")  # without a scroll bar
    assert high > 0.4 * height
    coloured = colours(page, (x, y, wide, high))
    assert 0.03 < coloured.mean() < 0.6
    rows, columns = np.flatnonzero(coloured.any(axis=1)), np.flatnonzero(coloured.any(axis=0))
    assert max(np.ptp(rows) / high, np.ptp(columns) / wide) > 0.4


BOXES = """[...document.querySelectorAll('select, button, input, summary, #shown')].filter((e) => e.checkVisibility())
  .map((e) => { const { left, top, right, bottom } = e.getBoundingClientRect(); return [e.id || e.outerHTML,
  left, top, right, bottom]; })"""


@pytest.mark.parametrize("width", [320, 400, 700, 1280])
def test_all_controls_are_inside_the_window_and_apart(page, width):
    page.size(width, 800)
    page.run("scrollTo(0, 0)")
    wait_for_the_new_size(page)
    closed = page.run(BOXES)
    page.run("document.getElementById('more').open = true; 0")
    opened = page.run(BOXES)
    for name, left, _, right, _ in [*closed, *opened]:
        assert left >= 0, name
        assert right <= width, name
    assert page.run("document.documentElement.scrollWidth <= innerWidth")
    for (one, *a), (other, *b) in itertools.combinations(closed, 2):
        assert a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3], (one, other)
    if width <= 400:  # long names of stages and fields have a line of their own
        stage = next(box for box in closed if box[0] == "stage")
        assert stage[3] - stage[1] > 0.7 * width


def test_membranes_without_the_field_have_no_colours_of_the_field_before(page):
    whole = (0, 0, 400, 500)
    page.run("document.querySelector('[data-view=plan]').click()")
    shares = []
    for field in ("principal stress I", "force", "displacement"):
        page.change(f"location.hash = {json.dumps(urllib.parse.urlencode({'stage': 'snow', 'field': field}))}")
        page.run(FRAMES)
        shares.append(colours(page, whole).mean())
    assert shares[1] < 0.5 * min(shares[0], shares[2])


def test_parts_and_marks_are_shown_and_hidden(page):
    page.change("location.hash = 'stage=snow&field=principal+stress+I&scale=2'")  # one that changes
    names = "drawn.map(({trace}) => trace.uid)"
    every = page.run(names)
    assert every == ["part-0", "edges-0", "part-1", "part-2", "part-3", "supports"]
    for switch in ("#parts input", "#supports", "#loads", "#reactions", "#axes", "#common"):
        page.change(f"document.querySelector('{switch}').click()")
    assert page.run(names) == ["part-1", "part-2", "part-3", "loads", "reactions"]
    ends = page.run("[...document.querySelector('.ends').children].map((end) => Number(end.textContent))")
    assert ends[0] < page.shown()["least"] or ends[-1] > page.shown()["largest"]  # those of all stages
    for switch in ("#parts input", "#supports", "#loads", "#reactions", "#axes", "#common"):
        page.change(f"document.querySelector('{switch}').click()")
    assert page.run(names) == every


def test_pointer_tells_the_values_of_cell_and_node(page, found):
    state = found["snow"]
    page.change("location.hash = 'stage=snow&field=principal+stress+I'")
    page.run("document.querySelector('[data-view=plan]').click()")
    middle = page.run("(({x, y, width, height}) => [x + width / 2, y + height / 2])(figure.getBoundingClientRect())")
    for shift in range(60):
        page.mouse("mouseMoved", middle[0] + 31 + shift % 10, middle[1] - 61)
        page.run(FRAMES)
        lines = page.run("hover.hidden ? '' : hover.textContent").split("\n")
        if lines[0].startswith(f"{EVIL}, cell "):
            break
    cell, word = lines[0].removeprefix(f"{EVIL}, cell ").split(", ")
    fabric = state.membrane(EVIL)
    assert word == fabric.state[int(cell)]
    assert lines[1] == f"principal stress I {float(f'{fabric.principal[int(cell), 0]:.5g}'):g} kN/m"
    node = int(lines[2].split()[1])
    assert node in state.structure.parts[EVIL].cells[int(cell)]
    assert float(lines[3].split()[1]) == pytest.approx(np.linalg.norm(state.displacement[node]), rel=1e-4)


def test_deformation_factor_moves_the_nodes(page, found):
    state = found["snow"]
    page.change("location.hash = 'stage=snow&scale=10'")
    drawn = np.array(page.run("Array.from(drawn[0].trace.z)"))
    cells = state.structure.parts[EVIL].cells.ravel()
    height = state.structure.points[cells, 2] + 10 * state.displacement[cells, 2]
    np.testing.assert_allclose(drawn + page.run("scene.origin[2]"), height, atol=1e-5)
    shown = page.change("control.factor.value = 1e30; control.factor.dispatchEvent(new Event('change'))")
    assert 1e3 < shown["scale"] < 1e10  # still a picture
    assert page.run("location.hash").startswith("#stage=snow&field=")


def test_keys_reach_all_controls_and_turn_the_structure(page):
    reached = []
    page.run("document.activeElement.blur(); document.getElementById('more').open = true")
    for _ in range(40):
        page.key("Tab", code="Tab", windowsVirtualKeyCode=9)
        reached.append(page.run("(({id, textContent}) => id || textContent)(document.activeElement)"))
    wanted = {"stage", "field", "slider", "factor", "Plan", "mesh", "supports", "loads", "common", "figure"}
    assert wanted <= {name[:20] for name in reached}
    eye = "JSON.stringify([camera.eye, zoom])"
    before = page.run(f"figure.focus(); {eye}")
    page.key("ArrowLeft", code="ArrowLeft", windowsVirtualKeyCode=37)
    turned = page.run(eye)
    page.key("+", text="+")
    assert before != turned != page.run(eye)


def test_mouse_turns_and_zooms_the_structure_for_the_next_picture_too(page):
    """plotly warned in the console, and forgot the zoom, where it got a new layout with each picture."""
    page.change("location.hash = 'stage=snow&field=displacement&scale=1'")
    page.run("document.querySelector('[data-view=oblique]').click()")
    x, y = page.run("(({x, y, width, height}) => [x + width / 2, y + height / 2])(figure.getBoundingClientRect())")
    seen = "JSON.stringify([figure.layout.scene.camera.eye, zoom])"
    start = page.run(seen)
    page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-100)
    assert page.run(f"{FRAMES}.then(() => {seen})") != start
    for scale in (2, 3):
        page.change(f"location.hash = 'stage=snow&scale={scale}'")
        start = page.run(seen)
        for _ in range(20):  # plotly's camera follows the pointer in its own time
            drag(page, x, y)
            if page.run(seen) != start:
                break
        assert page.run(seen) != start
    before = page.run(seen)
    page.change("location.hash = 'stage=snow&field=state'")
    np.testing.assert_allclose(_numbers(page.run(seen)), _numbers(before), rtol=1e-6)


def drag(page, x, y):
    page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    for step in range(1, 6):
        page.mouse("mouseMoved", x + 12 * step, y, button="left", buttons=1)
        page.run(FRAMES)
    page.mouse("mouseReleased", x + 60, y, button="left", clickCount=1)
    page.run(FRAMES)


def _numbers(state):
    eye, zoom = json.loads(state)
    return [*eye.values(), zoom]


def test_middle_of_a_symmetric_range_is_zero(page):
    """It was written as the rounding of its mean, 2.6021e-18."""
    shown = """((least, largest) => {
      const entries = scene.stages[0].fields.map((entry) => entry && { ...entry, least, largest });
      const stage = { ...scene.stages[0], fields: entries };
      return [...legendOf(1, stage, false).querySelectorAll(".ends span")].map((end) => end.textContent);
    })"""
    assert page.run(f"{shown}(-0.01205, 0.01205 + 5.2e-18)") == ["-0.01205", "0", "0.01205"]
    assert page.run(f"{shown}(2e-6, 4e-6)") == ["2e-6", "3e-6", "4e-6"]


def test_directions_in_which_all_nodes_are_held_have_no_marks(browser, tmp_path):
    """A strip that is plane across, as a roof in the rain, was covered by the marks of all its nodes."""
    points, triangles = rectangle(4.0, 0.1, 20, 1)
    ends = np.flatnonzero(np.abs(points[:, 0]) == 2)
    strip = Structure(
        points, {"roof": Membrane(triangles, Fabric(5e5, 0.3), 1e3)}, [Support(ends, "xz"), Support(range(42), "y")]
    )
    write_scene(strip, tmp_path / "strip.html")
    browser.open((tmp_path / "strip.html").as_uri())
    marked = browser.run("Array.from(drawn.find(({trace}) => trace.uid === 'supports').owner.held)")
    assert marked == ends.tolist()
