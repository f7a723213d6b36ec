"""Pictures: convergence curves (matplotlib) and contours on the deformed structure (pyvista).

Each function writes one PNG. Under MPI call it on all processes; the first one draws.
"""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from .results import StageResult

# Without a screen VTK draws in memory; to be set before pyvista loads it.
if not os.environ.get("DISPLAY"):
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkOSOpenGLRenderWindow")

INK = "#30343b"
LINES = "#1f6f8b"
BANDS = 16


def convergence(result: StageResult, path: str | Path, force_unit: str = "N", energy_unit: str = "J") -> None:
    """Total potential energy and largest unbalanced force against the iteration, as in Gil's Fig. 7.

    Args:
        result: A stage; all its increments are drawn one after the other.
        path: The PNG to write; its folder is made.
        force_unit: What the axis of the forces says.
        energy_unit: What the axis of the energy says.
    """
    if MPI.COMM_WORLD.rank:
        return
    import matplotlib.figure  # noqa: PLC0415  (numbers alone should not wait for it)

    iterations = [entry for _, entry in result.history]
    count = np.arange(len(iterations))
    figure = matplotlib.figure.Figure(figsize=(9, 3.6), layout="constrained")
    energy, residual = figure.subplots(1, 2)
    energy.plot(count, [entry.energy for entry in iterations], "o-", color=LINES)
    energy.set_ylabel(f"Total potential energy [{energy_unit}]")
    residual.semilogy(count, [max(entry.residual, 1e-300) for entry in iterations], "o-", color=LINES)
    residual.set_ylabel(f"Largest unbalanced force [{force_unit}]")
    for axes in (energy, residual):
        axes.set_xlabel("Iteration")
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.grid(color="#e3e5e8", linewidth=0.8)
        axes.spines[["top", "right"]].set_visible(False)
    figure.suptitle(f"Convergence of stage “{result.name}”", color=INK, fontsize=12)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=160, bbox_inches="tight")


def contours(
    result: StageResult,
    fields: Mapping[str, Mapping[str, ArrayLike] | ArrayLike],
    path: str | Path,
    *,
    scale: float = 1.0,
    view: Sequence[float] = (1.0, -1.6, 1.1),
) -> None:
    """Fields on the deformed structure, one picture beside the other; cables and masts are drawn as tubes.

    Args:
        result: A stage.
        fields: For each title, either nodal values, shape (n,), or for each membrane by name cell values (cells,).
        path: The PNG to write; its folder is made.
        scale: Displacements are drawn that many times larger.
        view: Direction from the structure to the eye.

    Raises:
        ValueError: A field has a wrong number of values, or names no membrane.
    """
    checked = {title: _checked(result, title, field) for title, field in fields.items()}
    if MPI.COMM_WORLD.rank:
        return
    import matplotlib.cm  # noqa: PLC0415
    import matplotlib.colors  # noqa: PLC0415
    import matplotlib.figure  # noqa: PLC0415

    figure = matplotlib.figure.Figure(figsize=(6.4 * len(checked), 5.2), layout="constrained")
    panels = figure.subplots(1, len(checked), squeeze=False)[0]
    for axes, (title, field) in zip(panels, checked.items(), strict=True):
        colours, limits = _colours(field)
        axes.imshow(_picture(result, field, colours, limits, scale, view))
        axes.axis("off")
        axes.set_title(title, color=INK, fontsize=15)
        norm = matplotlib.colors.BoundaryNorm(np.linspace(*limits, BANDS + 1), 256)
        mappable = matplotlib.cm.ScalarMappable(norm, colours)
        ticks = np.linspace(*limits, 5)
        bar = figure.colorbar(mappable, ax=axes, location="bottom", fraction=0.05, pad=0.02, shrink=0.8, ticks=ticks)
        bar.ax.set_xticklabels([f"{tick:.4g}" for tick in ticks], color=INK)
        bar.outline.set_visible(False)
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=160, bbox_inches="tight")


def _picture(
    result: StageResult,
    field: dict[str, NDArray[np.float64]] | NDArray[np.float64],
    colours: str,
    limits: tuple[float, float],
    scale: float,
    view: Sequence[float],
) -> NDArray[np.uint8]:
    """The deformed structure, coloured; shape (height, width, 3)."""
    import pyvista  # noqa: PLC0415

    if not os.environ.get("DISPLAY") and pyvista.vtk_version_info < (9, 4):  # it would abort the whole process
        raise RuntimeError("Without a screen this version of VTK cannot draw; run the script with xvfb-run.")
    points = result.structure.points + scale * result.displacement
    size = np.linalg.norm(np.ptp(points, axis=0))
    plotter = pyvista.Plotter(off_screen=True, window_size=(1200, 840))
    plotter.set_background("white")
    plotter.enable_anti_aliasing("ssaa")
    for name, part in result.structure.parts.items():
        if part.dimension == 1:
            lines = pyvista.PolyData(points, lines=_vtk_cells(part.cells))
            plotter.add_mesh(lines.tube(radius=0.004 * size), color=INK)
            continue
        plotter.add_mesh(
            pyvista.PolyData(points, faces=_vtk_cells(part.cells)),
            scalars=field[name] if isinstance(field, dict) else field, clim=limits, cmap=colours, n_colors=BANDS,
            show_edges=len(part.cells) <= 5000, line_width=1.5, edge_color=INK, edge_opacity=0.25,
            ambient=0.5, diffuse=0.6, show_scalar_bar=False,
        )  # fmt: skip
    plotter.view_vector(tuple(view), viewup=(0, 0, 1))
    plotter.camera.zoom(1.3)
    image = plotter.screenshot(return_img=True)
    plotter.close()
    inked = np.argwhere((np.asarray(image) < 255).any(axis=2))  # crop to what was drawn
    (top, left), (bottom, right) = inked.min(axis=0), inked.max(axis=0)
    return np.asarray(image[max(top - 10, 0) : bottom + 10, max(left - 10, 0) : right + 10], dtype=np.uint8)


def _checked(
    result: StageResult, title: str, field: Mapping[str, ArrayLike] | ArrayLike
) -> dict[str, NDArray[np.float64]] | NDArray[np.float64]:
    membranes = {name: len(part.cells) for name, part in result.structure.parts.items() if part.dimension == 2}
    if not isinstance(field, Mapping):
        values = np.asarray(field, dtype=np.float64)
        if values.shape != (len(result.structure.points),):
            raise ValueError(f"Field {title!r} has shape {values.shape}; give one value for each node.")
        return values
    if set(field) != set(membranes):
        raise ValueError(f"Field {title!r} is for {list(field)}; give cell values for each of {list(membranes)}.")
    cells = {name: np.asarray(values, dtype=np.float64) for name, values in field.items()}
    for name, values in cells.items():
        if values.shape != (membranes[name],):
            raise ValueError(f"Field {title!r} on {name!r} has shape {values.shape}; give one value for each cell.")
    return cells


def _colours(field: dict[str, NDArray[np.float64]] | NDArray[np.float64]) -> tuple[str, tuple[float, float]]:
    """Colour map and range: two-sided and symmetric where values of both signs matter."""
    values = np.concatenate(list(field.values())) if isinstance(field, dict) else field
    low, high = float(values.min()), float(values.max())
    largest = max(-low, high)
    if min(-low, high) > 0.02 * largest:
        return "coolwarm", (-largest, largest)
    if high - low <= 1e-9 * abs(largest):  # uniform: the last digits are no pattern to look at
        return "viridis", (low - 0.5 * abs(low), high + 0.5 * abs(high))
    return "viridis", (low, high)


def _vtk_cells(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()
