"""Picture of the deformed structure by pyvista, without text: `plot` adds titles and scales."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..results.states import StageResult

INK = "#30343b"
MAST = "#8a5a2b"
FABRIC = "#e8e4da"


@dataclass(frozen=True)
class Colours:
    """Map from values to colours: a matplotlib map, its range and the number of bands."""

    map: str | Sequence[str]
    low: float
    high: float
    bands: int


def picture(
    result: StageResult,
    field: Mapping[str, NDArray[np.float64]] | NDArray[np.float64],
    colours: Colours,
    *,
    scale: float,
    view: ArrayLike,
    mirror: str | None,
    antisymmetric: bool,
) -> NDArray[np.uint8]:
    """Draw the deformed structure, cables and masts as tubes; shape (height, width, 3).

    Cell values colour their parts. Nodal values colour the membranes, or the lines if there are none.

    A coordinate in `mirror` adds the mirror image, with values of the other sign if the field is antisymmetric.
    """
    import pyvista  # noqa: PLC0415  (numbers alone must not wait for it)

    plotter = pyvista.Plotter(off_screen=True, window_size=(1200, 900))
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    points = result.structure.points + scale * result.displacement
    radius = 0.0025 * np.linalg.norm(np.ptp(points[result.structure.used], axis=0))
    membranes = any(part.dimension == 2 for part in result.structure.parts.values())
    shapes = [(points, 1)]
    if mirror is not None:
        shapes.append((points * np.where(np.arange(3) == "xyz".index(mirror), -1.0, 1.0), -1 if antisymmetric else 1))
    for shape, sign in shapes:
        for name, part in result.structure.parts.items():
            if part.dimension == 1:
                body = pyvista.PolyData(shape, lines=_vtk_cells(part.cells))
            else:
                body = pyvista.PolyData(shape, faces=_vtk_cells(part.cells))
            if isinstance(field, Mapping) and name in field:
                body.cell_data["values"] = sign * field[name]
            elif not isinstance(field, Mapping) and (part.dimension == 2 or not membranes):
                body.point_data["values"] = sign * field
            look: dict[str, Any] = {"color": MAST if part.is_strut else INK if part.dimension == 1 else FABRIC}
            if "values" in body.array_names:
                look = {
                    "scalars": "values", "clim": (colours.low, colours.high), "cmap": colours.map,
                    "n_colors": colours.bands, "show_scalar_bar": False,
                }  # fmt: skip
            if part.dimension == 1:
                body = body.tube(radius=(2 if part.is_strut else 1) * radius)
            else:
                look |= {
                    "show_edges": len(part.cells) <= 5000,
                    "line_width": 1.5,
                    "edge_color": INK,
                    "edge_opacity": 0.25,
                }
            plotter.add_mesh(body, ambient=0.5, diffuse=0.6, **look)
    plotter.view_vector(np.asarray(view), viewup=screen_axes(view)[1])
    plotter.enable_parallel_projection()  # plans stay plans, and lines lie as in wire frames
    plotter.camera.zoom(1.2)
    image = np.asarray(plotter.screenshot(return_img=True), dtype=np.uint8)
    plotter.close()
    drawn = np.argwhere((image < 255).any(axis=2))
    (top, left), (bottom, right) = drawn.min(axis=0), drawn.max(axis=0)
    return image[max(top - 10, 0) : bottom + 10, max(left - 10, 0) : right + 10]


def screen_axes(view: ArrayLike) -> NDArray[np.float64]:
    """Right and up of a picture seen from a direction, shape (2, 3): z points up; from straight above or below, y."""
    eye = np.asarray(view, dtype=np.float64)
    eye = eye / np.linalg.norm(eye)
    right = np.cross([0.0, 0.0, 1.0] if np.hypot(eye[0], eye[1]) > 1e-9 else [0.0, 1.0, 0.0], eye)
    right = right / np.linalg.norm(right)
    return np.stack([right, np.cross(eye, right)])


def _vtk_cells(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()
