"""Pictures in notebooks: drawn once, on demand only, and never in the way of a result."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    PointLoad,
    Stage,
    StageResults,
    Structure,
    Support,
    equilibrium_path,
    force_density,
    plot,
    polyline,
    updated_reference,
)
from fx_membrane.plot import inline, windows
from pictures import TRIANGLES

PNG = b"\x89PNG"
POINTS = [(0.0, 0, 0), (3, 0, 0), (6, 0, 0)]


def rope():
    return Structure(POINTS, {"<rope>": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])


def truss_path():
    points = [(-1, 0, 0), (0, 0, 0.3), (1, 0, 0)]
    truss = Structure(points, {"truss": Mast([[0, 1], [1, 2]], 1e6)}, [Support([0, 2]), Support(1, "y")])
    return equilibrium_path(truss, Stage("push $", [PointLoad(1, (0, 0, -2e4))], increments=4))


@pytest.fixture
def drawings(monkeypatch):
    """Objects that are drawn."""
    pytest.importorskip("pyvista")
    monkeypatch.setattr(windows, "LONGER", 300)
    seen, draw = [], inline._draw
    monkeypatch.setattr(inline, "_draw", lambda thing: seen.append(thing) or draw(thing))
    return seen


def test_each_object_is_drawn_once(result, drawings):
    structure = rope()
    things = [result, structure, updated_reference(structure), truss_path()]
    assert not drawings
    for thing in things:
        png, html = thing._repr_png_(), thing._repr_html_()
        assert png.startswith(PNG)
        assert html.count("<img") == 1
        assert "data:image/png;base64," in html
        assert "<rope>" not in html
    assert drawings == things


def test_stages_show_the_last(result, drawings):
    results = StageResults({"first": Analysis(rope()).run([Stage("rest")])["rest"], "last": result})
    assert results._repr_png_() == result._repr_png_()
    assert results._repr_html_().count("<img") == 1
    assert StageResults()._repr_png_() is None
    assert "<img" not in StageResults()._repr_html_()


def test_nets_tell_their_remedy():
    net = force_density(POINTS, polyline([0, 1, 2]), 1e3, [Support([0, 2])])
    assert net._repr_png_() is None
    assert "plot.wireframe" in net._repr_html_()


@pytest.mark.parametrize("lack", ["screen", "fault"])
def test_result_is_shown_where_nothing_can_draw(lack, monkeypatch):
    state = Analysis(rope()).run([Stage("rest")])["rest"]
    if lack == "screen":
        monkeypatch.setattr(inline, "obstacle", lambda: "there is no <screen>.")
    else:
        monkeypatch.setattr(inline, "draw_panels", lambda *_: 1 / 0)
    html = state._repr_html_()
    assert state._repr_png_() is None
    assert "<img" not in html
    assert "PASS" in html
    assert ("there is no &lt;screen&gt;" if lack == "screen" else "ZeroDivisionError") in html


def test_result_is_shown_without_pyvista_or_matplotlib():
    """In a process of its own: the modules are loaded already in this one."""
    script = (
        "import sys; sys.modules['pyvista'] = sys.modules['matplotlib'] = None\n"
        "from fx_membrane import *\n"
        f"rope = Structure({POINTS}, {{'rope': Cable(polyline([0, 1, 2]), 1e6, 1e3)}}, [Support([0, 2])])\n"
        "print('No picture' in rope._repr_html_(), rope._repr_png_())"
    )
    found = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    assert found.stdout.split() == ["True", "None"]


def test_nothing_is_drawn_outside_notebooks():
    script = (
        "import sys\nfrom fx_membrane import *\n"
        f"rope = Structure({POINTS}, {{'rope': Cable(polyline([0, 1, 2]), 1e6, 1e3)}}, [Support([0, 2])])\n"
        "state = Analysis(rope).run([Stage('rest')])['rest']\n"
        "print(repr(state) != '', str(rope) != '', 'matplotlib' in sys.modules, 'pyvista' in sys.modules)"
    )
    found = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True)
    assert found.stdout.split() == ["True", "True", "False", "False"]


def test_pictures_do_not_keep_their_objects():
    structure = replace(rope(), points=np.multiply(POINTS, 1.25))  # of no other test: equal ones share a picture
    inline._pictures[structure] = (b"", "")
    before = len(inline._pictures)
    del structure
    assert len(inline._pictures) == before - 1


def test_wireframes_take_nets(tmp_path):
    """The remedy for nets works."""
    plot.wireframe(np.vstack([POINTS, np.zeros((22, 3))]), {"net": TRIANGLES}, tmp_path / "net.png")
    assert (tmp_path / "net.png").read_bytes().startswith(PNG)


def test_path_with_a_limit_point_is_drawn():
    path = truss_path()
    assert len(path.limit_points) > 0
    assert inline.drawn(path)[0].startswith(PNG)


def test_names_with_dollars_are_no_formulas(drawings):
    state = replace(Analysis(rope()).run([Stage("rest")])["rest"], name=r"5 $ of $\x")
    assert state._repr_png_().startswith(PNG)
