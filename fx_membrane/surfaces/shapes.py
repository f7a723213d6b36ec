"""Surfaces of structures, forms and states, as points and triangles."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..form_finding.form import Form
from ..geometry.sizes import degenerate
from ..model.parts import Membrane
from ..model.structure import Structure
from ..results.states import StageResult

Shape = Structure | Form | StageResult | tuple[Any, Any]


class Surface(NamedTuple):
    """Triangles in space.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        triangles: Nodes of the cells, shape (cells, 3).
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int64]


def surface_of(what: str, shape: Any, part: str | None) -> Surface:
    """Surface of a membrane, or of all together.

    Args:
        what: Name of the function that asks, for messages.
        shape: A structure, a form, a state, deformed; or points, shape (n, 3), and triangles, shape (cells, 3).
        part: Name of a membrane; None for all, whose cells follow each other in the order of the parts.

    Raises:
        ValueError: The shape is of another kind, or has no membrane of that name.
    """
    if isinstance(shape, tuple) and len(shape) == 2:
        points, triangles = validation.positions(f"{what} points", shape[0]), shape[1]
        cells = validation.cells(f"{what} triangles", triangles, 3)
        validation.in_range(f"{what} triangles", cells.ravel(), len(points), "node")
        flat = degenerate(points, cells)
        if len(flat):
            raise ValueError(
                f"{what} triangles: cell {flat[0]} has no area, at "
                f"{validation.format_point(points[cells[flat[0]]].mean(axis=0))}; remove it or move its nodes apart."
            )
        if part is not None:
            raise ValueError(
                f"part is {validation.short_repr(part)}, but points and triangles have none; leave it out."
            )
        return Surface(points, cells)
    if not isinstance(shape, Structure | Form | StageResult):
        raise ValueError(
            f"{what} shape is {validation.short_repr(shape)}; give a Structure, a Form, a StageResult, or a pair "
            "(points, triangles)."
        )
    structure = shape if isinstance(shape, Structure) else shape.structure
    points = structure.points + shape.displacement if isinstance(shape, StageResult) else structure.points
    if part is not None:
        return Surface(points, structure.part(part, Membrane).cells)
    found = [member.cells for member in structure.parts_of(Membrane).values()]
    if not found:
        raise ValueError(
            f"The structure has no membrane, of which {what} could ask; its parts are {list(structure.parts)}."
        )
    return Surface(points, np.concatenate(found))
