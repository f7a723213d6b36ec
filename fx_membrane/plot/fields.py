"""Fields to draw: numbers at nodes or of cells, or states of cells, and the limits of their colours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.array_entries import all_are, entries
from ..geometry.sizes import measures
from ..model.parts import Part
from ..results.states import StageResult
from .subjects import Shown

MAX_DRAWN_DISPLACEMENT = 1e4  # displacements drawn larger than this multiple of the structure have no visible shape
STATES = ("taut", "wrinkled", "slack")

Field = Mapping[str, ArrayLike] | ArrayLike
Checked = dict[str, NDArray[Any]] | NDArray[Any]


def checked(result: StageResult | Shown, title: str, field: Field) -> Checked:
    """Convert a field to arrays: numbers at nodes, shape (n,), or numbers or states of cells by part, each (cells,).

    Raises:
        ValueError: It has a wrong number of values, values that are neither numbers nor states, or names no part.
    """
    name = f"Field {validation.name('field', title)!r}"
    if not isinstance(field, Mapping):
        values = _values(name, field)
        if values.shape != (len(result.structure.points),):
            raise ValueError(f"{name} has shape {values.shape}; give one value for each node.")
        if values.dtype.kind == "U":
            raise ValueError(f"{name} has states at nodes; states belong to cells, {{part: states}}.")
        return values
    cells = {part: len(data.cells) for part, data in result.structure.parts.items()}
    if not field or not set(field) <= set(cells):
        raise ValueError(f"{name} is for the parts {list(field)}; give cell values for some of {list(cells)}.")
    found = {part: _values(name, values) for part, values in field.items()}
    for part, values in found.items():
        if values.shape != (cells[part],):
            raise ValueError(f"{name} on {part!r} has shape {values.shape}; give one value for each cell.")
    if len({values.dtype.kind for values in found.values()}) > 1:
        raise ValueError(f"{name} has states on some parts and numbers on others; draw two fields.")
    return found


def checked_range(title: str, field: Checked, given: Sequence[float]) -> tuple[float, float]:
    """Minimum and maximum of the colours.

    Raises:
        ValueError: They are not two numbers, the lower first; or the field shows states.
    """
    if joined(field).dtype.kind == "U":
        raise ValueError(f"ranges are given for {title!r}, which shows states; leave them out there.")
    pair = validation.finite(f"range of {title!r}", given)
    if pair.shape != (2,) or not pair[0] < pair[1]:
        raise ValueError(
            f"The range of {title!r} is {validation.short_repr(given)}; give (low, high), the lower one first."
        )
    return float(pair[0]), float(pair[1])


def checked_scale(result: StageResult | Shown, scale: float) -> float:
    """Factor of the displacements at which the structure is still visible.

    Raises:
        ValueError: It is not a number, or too large.
    """
    scale = validation.number("scale", scale)
    times = abs(scale) * np.abs(result.displacement).max() / result.structure.size
    if times > MAX_DRAWN_DISPLACEMENT:
        raise ValueError(
            f"scale is {scale:g}, with which displacements are {times:.0e} times as large as the structure; give at "
            f"most {abs(scale) * MAX_DRAWN_DISPLACEMENT / times:.1e} in size."
        )
    return scale


def joined(field: Checked) -> NDArray[Any]:
    """Concatenate all values of a field, shape (values,)."""
    return np.concatenate([values.ravel() for values in field.values()]) if isinstance(field, dict) else field


def smooth(parts: Mapping[str, Part], points: NDArray[np.float64], title: str, field: Checked) -> Checked:
    """Replace values of cells by means at the nodes of their part, by area or length; at corners, (cells, nodes) each.

    Raises:
        ValueError: The field has nodal values already, or states.
    """
    if not isinstance(field, dict) or joined(field).dtype.kind == "U":
        kind = "states, which have no mean" if isinstance(field, dict) else "values at nodes already"
        raise ValueError(f"smoothed names {title!r}, which has {kind}; leave it out.")
    found: dict[str, NDArray[Any]] = {}
    for name, values in field.items():
        cells = parts[name].cells
        size = np.repeat(measures(points, cells), cells.shape[1])
        nodes = np.unique(cells, return_inverse=True)[1].ravel()
        sums = np.bincount(nodes, size * np.repeat(values, cells.shape[1]))
        found[name] = (sums / np.bincount(nodes, size))[nodes].reshape(cells.shape)
    return found


def _values(name: str, given: ArrayLike) -> NDArray[Any]:
    """Numbers, with 0 and 1 for truth values, or states."""
    array = entries(name, given, "numbers or states")
    if array.size and all_are(lambda kind: issubclass(kind, str), array):
        texts = np.array(array, dtype=np.str_)
        unknown = sorted(set(texts.flat) - set(STATES))
        if unknown:
            raise ValueError(f"{name} has the state {str(unknown[0])!r}; the states are {list(STATES)}.")
        return texts
    if array.size and all_are(lambda kind: issubclass(kind, bool | np.bool_), array):
        return np.array(array, dtype=np.float64)
    return validation.finite(name, given)
