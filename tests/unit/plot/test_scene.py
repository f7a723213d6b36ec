"""Views: up, right, and true lengths across the view; objects of VTK are freed with their picture."""

import subprocess
import sys
import types

import numpy as np
import pytest

from fx_membrane import Analysis, Stage, Support, plot, rectangle
from fx_membrane.plot import scene, screen
from models import sheet

SLOPE, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
SLOPE[:, 2] = 2 * SLOPE[:, 0]


@pytest.fixture(scope="module")
def drawn():
    """Pictures of an inclined square, in shades of a nodal field."""
    pytest.importorskip("pyvista")
    structure = sheet(Support(range(25)), points=SLOPE, triangles=TRIANGLES)
    (rest,) = Analysis(structure).run([Stage("rest")]).values()

    def draw(field, view):
        colours = scene.Colours("gray", -1.0, 1.0, 16)
        return scene.picture(rest, field, colours, scale=1.0, view=view, mirror=None, antisymmetric=False)

    return draw


@pytest.mark.parametrize(("axis", "along"), [(0, 1), (1, 0)], ids=["x to the right", "y up"])
@pytest.mark.parametrize("view", [(0, 0, 1), (0, 0, 5.0), (1e-6, -2e-6, 1)])
def test_plan_has_x_to_the_right_and_y_up(drawn, axis, along, view):
    brightness = drawn(SLOPE[:, axis], view).mean(axis=(1 - along, 2))
    size = len(brightness) // 4
    first, last = brightness[size : 2 * size].mean(), brightness[2 * size : 3 * size].mean()
    assert last > first + 20 if axis == 0 else first > last + 20  # rows of a picture run down


FREED = """
import gc
import numpy as np
from fx_membrane import *

points, triangles = rectangle(1.0, 1.0, 2, 2)
edge = np.unique(boundary_edges(triangles))
structure = Structure(points, {"sheet": Membrane(triangles, Fabric(1e3, 0.3), 1.0)}, [Support(edge)])
rest = Analysis(structure).run([Stage("rest")])["rest"]
gc.disable()
plot.contours(rest, {"height": rest.displacement[:, 2]}, "height.png")
print([type(one).__name__ for one in gc.get_objects() if type(one).__name__ in ("Plotter", "Renderer", "PolyData")])
"""


def test_objects_of_vtk_are_freed_without_the_garbage_collector(tmp_path):
    """It acts at any time, on any thread, where VTK can crash: the first picture of a process stayed."""
    pytest.importorskip("pyvista")
    run = subprocess.run([sys.executable, "-c", FREED], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert run.stdout.splitlines()[-1:] == ["[]"], run.stderr
    assert (tmp_path / "height.png").exists()


def test_plan_of_a_slope_is_not_in_perspective(drawn):
    ink = (drawn(0.5 * SLOPE[:, 0], (0, 0, 1)) < 250).any(axis=2)
    low, high = (np.count_nonzero(ink[:, column]) for column in (ink.shape[1] // 10, 9 * ink.shape[1] // 10))
    assert high == pytest.approx(low, abs=3)


@pytest.mark.parametrize("lack", ["pyvista", "screen", "library"])
def test_picture_that_cannot_be_drawn_is_a_warning_with_the_remedy(lack, monkeypatch, tmp_path):
    """The script continues: computed results must survive a failed picture."""
    (rest,) = Analysis(sheet()).run([Stage("rest")]).values()
    pyvista = types.ModuleType("pyvista")
    version = (9, 5, 2) if lack == "library" else (9, 3, 0)  # Debian 13's aborts without a screen
    monkeypatch.setattr(pyvista, "vtk_version_info", version, raising=False)
    monkeypatch.setattr(screen, "IN_MEMORY", {"vtkOSOpenGLRenderWindow": "libNoSuch.so.8"})
    monkeypatch.setitem(sys.modules, "pyvista", None if lack == "pyvista" else pyvista)
    monkeypatch.setitem(sys.modules, "pyvista.plotting", pyvista)
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.warns(UserWarning, match=f"{lack}.*(pip|apt) install"):
        plot.contours(rest, {"height": rest.displacement[:, 2]}, tmp_path / "height.png")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("view", "axes"),
    [
        ((0, 0, 2), [[1, 0, 0], [0, 1, 0]]),
        ((0, 0, -2), [[-1, 0, 0], [0, 1, 0]]),
        ((0, -1, 0), [[1, 0, 0], [0, 0, 1]]),
        ((3, 0, 0), [[0, 1, 0], [0, 0, 1]]),
    ],
)
def test_right_and_up_of_a_picture(view, axes):
    assert scene.screen_axes(view).tolist() == axes
