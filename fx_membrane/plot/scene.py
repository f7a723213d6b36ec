"""Picture of the deformed structure by pyvista, without text: `plot` adds titles and scales."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..model.parts import Part
from ..model.structure import Structure
from ..results.states import StageResult
from .marks import COLOURED, DASHED, PLAIN, WIDTHS, Strokes, border, dashes, hatching
from .subjects import Shown
from .windows import Window, mirrored, screen_axes, window_of

__all__ = ["FABRIC", "INK", "MAST", "Bars", "Colours", "picture", "screen_axes"]

Array = NDArray[np.float64]
Numbers = Mapping[str, Array] | Array

INK = "#30343b"
MAST = "#8a5a2b"
FABRIC = "#e8e4da"
HATCH = 0.014  # distance of hatching lines over the longer side of the window
BORDER = 5.0  # both borders of a line together [pixels]
DASH = 0.014  # length of a dash and of a gap over the same
LIFT = 2e-3  # distance by which lines are drawn nearer to the eye, over the same

BODIES = {1: "lines", 2: "faces"}  # cells of PyVista by the dimension of a part
SHADED = {"ambient": 0.5, "diffuse": 0.6}
EVEN = {"ambient": 0.8, "diffuse": 0.25}  # a colour of a value looks as in its scale, however it is turned to the light


@dataclass(frozen=True)
class Colours:
    """Map from values to colours.

    Attributes:
        map: A matplotlib map, or colours.
        low: Value of the first colour.
        high: Value of the last colour.
        bands: Number of bands.
        halves: True if zero is in the middle, with a scale of its own on either side.
    """

    map: str | Sequence[str]
    low: float
    high: float
    bands: int
    halves: bool = False

    @property
    def ends(self) -> tuple[float, float]:
        """Places of the first and the last colour on the scale."""
        return (-1.0, 1.0) if self.halves else (self.low, self.high)

    def placed(self, values: Array) -> Array:
        """Places of values on the scale."""
        return np.where(values < 0, -values / self.low, values / self.high) if self.halves else values

    def ticks(self, count: int) -> tuple[Array, Array]:
        """Places that divide the scale evenly, an odd number, and their values."""
        places = np.linspace(*self.ends, count)
        return places, np.where(places < 0, -self.low * places, self.high * places) if self.halves else places


@dataclass(frozen=True)
class Bars:
    """Forces of cables and masts by name, each (cells,), and their colours."""

    forces: Mapping[str, Array]
    colours: Colours


def picture(
    result: StageResult | Shown,
    field: Numbers | None,
    colours: Colours | None,
    *,
    scale: float,
    view: ArrayLike,
    mirror: str | None,
    antisymmetric: bool,
    strokes: Sequence[Strokes] = (),
    slack: NDArray[np.int64] | None = None,
    bars: Bars | None = None,
    window: Window | None = None,
) -> NDArray[np.uint8]:
    """Draw the deformed structure, cables and masts as tubes; shape (height, width, 3).

    Cell values colour their parts; those at the corners of cells, shape (cells, nodes), run smoothly. Nodal values
    colour the membranes, or the lines if there are none.

    A coordinate in `mirror` adds the mirror image, with values of the other sign if the field is antisymmetric. Cells
    in `slack` are hatched. The window is that of the deformed structure unless one is given.
    """
    import pyvista  # noqa: PLC0415  (numbers alone must not wait for it)

    points = result.structure.points + scale * result.displacement
    shapes = mirrored(points, mirror)
    window = window or window_of([shape[result.structure.used] for shape in shapes], view)
    plotter = pyvista.Plotter(off_screen=True, window_size=window.pixels)
    try:
        plotter.set_background("white")
        plotter.enable_anti_aliasing("ssaa")
        for shape, sign in zip(shapes, (1, -1 if antisymmetric else 1), strict=False):
            radius = 0.0025 * float(np.linalg.norm(np.ptp(shape[result.structure.used], axis=0)))
            for name, part in result.structure.parts.items():
                values = _values(result.structure, name, field, len(shape))
                shades, turn = colours, sign
                if bars is not None and name in bars.forces:
                    values, shades, turn = ("cell", bars.forces[name]), bars.colours, 1
                look = _look(result.structure, name, lined=bool(strokes) or slack is not None)
                if values is not None and shades is not None:
                    look |= _scale(shades)
                    values = values[0], shades.placed(turn * values[1])
                body = _body(shape, part, values)
                if name in result.structure.bars:
                    body = body.tube(radius=(2.0 if part.is_strut else 1.0 if bars is None else 1.4) * radius)
                plotter.add_mesh(body, **(SHADED if shades is None or values is None else EVEN), **look)
            _add_lines(plotter, shape, window, strokes, slack, plain=colours is None)
        _aim(plotter, window)
        return np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8)
    finally:
        plotter.close()


def _values(structure: Structure, name: str, field: Numbers | None, count: int) -> tuple[str, Array] | None:
    """Values that colour a part, of its cells or of all nodes; None without."""
    if field is None:
        return None
    if not isinstance(field, Mapping):
        membranes = structure.membranes
        return ("point", field) if name in membranes or not membranes else None
    if name not in field:
        return None
    values = field[name]
    if values.ndim == 1:
        return "cell", values
    at_nodes = np.zeros(count)
    at_nodes[structure.parts[name].cells] = values
    return "point", at_nodes


def _body(shape: Array, part: Part, values: tuple[str, Array] | None) -> Any:
    import pyvista  # noqa: PLC0415

    cells = np.column_stack([np.full(len(part.cells), part.cells.shape[1]), part.cells]).ravel()
    body = pyvista.PolyData(shape, **{BODIES[part.dimension]: cells})
    if values is not None:
        data = body.cell_data if values[0] == "cell" else body.point_data
        data["values"] = values[1]
    return body


def _look(structure: Structure, name: str, lined: bool) -> dict[str, Any]:
    part = structure.parts[name]
    if name in structure.bars:
        return {"color": MAST if part.is_strut else INK}
    edges = {"line_width": 1.5, "edge_color": INK, "edge_opacity": 0.25}
    return {"color": FABRIC, "show_edges": len(part.cells) <= 5000 and not lined} | edges


def _scale(colours: Colours) -> dict[str, Any]:
    return {
        "color": None, "scalars": "values", "clim": colours.ends, "cmap": colours.map,
        "n_colors": colours.bands, "show_scalar_bar": False,
    }  # fmt: skip


def _add_lines(
    plotter: Any,
    shape: Array,
    window: Window,
    strokes: Sequence[Strokes],
    slack: NDArray[np.int64] | None,
    plain: bool,
) -> None:
    """Draw lines a little nearer to the eye than their surface, which hides those behind it."""
    lift = LIFT * window.size * window.view
    inks = PLAIN if plain else COLOURED
    groups = [(group.kind, group.at(shape), group.counts) for group in strokes if len(group.counts)]
    if slack is not None and len(slack):
        ends, _ = hatching(shape, slack, (window.axes[0] - window.axes[1]) / np.sqrt(2), HATCH * window.size)
        groups.append(("slack", ends.reshape(-1, 3), np.full(len(ends), 2)))
    for kind, points, sizes in groups:
        dashed = kind in DASHED
        places, counts = dashes(points, sizes, DASH * window.size) if dashed else (points, sizes)
        if beside := border(kind, plain):
            under = _polylines(places + 0.5 * lift, counts)
            plotter.add_mesh(under, color=beside, line_width=WIDTHS[kind] + BORDER, lighting=False)
        body = _polylines(places + lift, counts)
        plotter.add_mesh(body, color=inks[kind], line_width=WIDTHS[kind], lighting=False)


def _polylines(places: Array, counts: NDArray[np.int64]) -> Any:
    import pyvista  # noqa: PLC0415

    return pyvista.PolyData(places, lines=np.insert(np.arange(len(places)), np.cumsum(counts) - counts, counts))


def _aim(plotter: Any, window: Window) -> None:
    """Point the camera at the window; plans stay plans, and lines lie as in wire frames."""
    middle = (window.low + window.high) / 2 @ window.axes + window.depth.mean() * window.view
    distance = 2 * (window.size + float(np.ptp(window.depth)))
    plotter.camera.position = middle + distance * window.view
    plotter.camera.focal_point = middle
    plotter.camera.up = window.axes[1]
    plotter.enable_parallel_projection()
    plotter.camera.parallel_scale = float(window.high[1] - window.low[1]) / 2
    plotter.renderer.reset_camera_clipping_range()
