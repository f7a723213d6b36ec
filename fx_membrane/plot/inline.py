"""Small pictures of objects for notebooks, each drawn once."""

from __future__ import annotations

import io
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from ..analysis.path import EquilibriumPath
from ..form_finding.form import Form
from ..results.states import StageResult, StageResults
from .colour_scale import colours
from .contour_maps import VIEW
from .figures import empty, plain
from .panels import Look, Panel, draw_panels, setting, size
from .scene import INK
from .screen import obstacle
from .subjects import Shown, shown

DOTS = 90  # [1/inch]
LINES = "#1f6f8b"

_pictures: WeakKeyDictionary[Any, tuple[bytes | None, str]] = WeakKeyDictionary()


def drawn(thing: Any) -> tuple[bytes | None, str]:
    """PNG of a state, a form, a structure or a path, of several stages the last; or None and the reason."""
    if isinstance(thing, StageResults):
        return drawn(list(thing.values())[-1]) if thing else (None, "There is no stage yet.")
    if thing not in _pictures:
        try:
            _pictures[thing] = _draw(thing)
        except Exception as error:  # a cell that shows a result must not fail for its picture
            _pictures[thing] = None, f"No picture: {type(error).__name__}: {error}"
    return _pictures[thing]


def _draw(thing: Any) -> tuple[bytes | None, str]:
    if isinstance(thing, Form) and thing.made is None:
        return None, "A net has no structure to draw; draw its branches with plot.wireframe."
    if isinstance(thing, EquilibriumPath):
        return (_png(_path(thing)), "") if thing.points else (None, "The path has no points.")
    if reason := obstacle():
        return None, f"No picture: {reason}"
    subject = shown("a notebook", thing)
    coloured = any(force.any() for force in subject.forces.values()) and not _by_forces(subject)
    look = Look(1.0, VIEW, forces=coloured, axes=True, force_unit="", length_unit="")
    panel = _panel(subject)
    same = setting([subject], [[]], look)
    figure = empty(*size([panel], look, same))
    draw_panels(figure, subject, [panel], look, same, [])
    return _png(figure), ""


def _by_forces(subject: Shown) -> bool:
    """Tell if forces are the field of the picture: those of a state without membranes."""
    return isinstance(subject.shape, StageResult) and len(subject.forces) == len(subject.structure.parts)


def _panel(subject: Shown) -> Panel:
    """Stress of a state, or forces where it has no membranes; the shape alone of a form or a structure."""
    if not isinstance(subject.shape, StageResult):
        return Panel(type(subject.shape).__name__)
    if _by_forces(subject):
        title, field = "axial force", subject.forces
    else:
        title = "principal stress I"
        field = {name: found.principal[:, 0] for name, found in subject.shape.membranes.items()}
    shades, numbers = colours(field, symmetric=False, limits=None)
    return Panel(f"{plain(subject.shape.name)}: {title}", numbers, shades)


def _path(path: EquilibriumPath) -> Any:
    """Load factor against the largest displacement, with limit points."""
    sizes, factors = np.linalg.norm(path.displacements, axis=2).max(axis=1), path.load_factors
    figure = empty(6.0, 3.6)
    axes = figure.subplots()
    axes.plot(sizes, factors, "o-", color=LINES, markersize=3)
    turns = path.limit_points
    if len(turns):
        axes.plot(sizes[turns], factors[turns], "o", color="#a3161b", label="limit point")
        axes.legend(frameon=False, labelcolor=INK)
    axes.set_xlabel("Largest displacement")
    axes.set_ylabel("Load factor")
    axes.set_title(f"Path of “{plain(path.name)}”", color=INK, fontsize=12)
    axes.grid(color="#e3e5e8", linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


def _png(figure: Any) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=DOTS, bbox_inches="tight")
    return stream.getvalue()
