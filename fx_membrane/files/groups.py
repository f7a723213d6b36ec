"""Structures from named groups of cells and nodes, as meshes of other programs have them."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..checks.calls import unfit
from ..model.parts import Part
from ..model.structure import Structure
from ..model.supports import Support

Makers = Mapping[str, Callable[..., Part]]  # of cells, or of cells and points


class Groups(NamedTuple):
    """Nodes of a mesh, and its groups.

    Attributes:
        points: Positions of all nodes, shape (n, 3) [m].
        cells: For each part, rows of the nodes of its cells, shape (cells, 2 or 3).
        nodes: For each support, rows of its nodes.
        kind: Name of a group in messages, as "physical group".
        label: Name of a node in messages, from its row.
    """

    points: NDArray[np.float64]
    cells: dict[str, NDArray[np.int64]]
    nodes: dict[str, NDArray[np.int64]]
    kind: str
    label: Callable[[int], str]


def check_arguments(parts: Any, supports: Any) -> None:
    """Refuse parts that are no functions of cells, and supports that are no components.

    Raises:
        ValueError: An argument is of another kind; the message names it.
    """
    validation.instance("parts", parts, Mapping)
    validation.instance("supports", supports, Mapping | None)
    if not parts:
        raise ValueError('parts is empty; give at least one, {"name": lambda cells: Membrane(cells, ...)}.')
    for name, make in parts.items():
        if shown := unfit(make, 1, 2):
            raise ValueError(
                f"The part {validation.name('part', name)!r} is {shown}; give a function of its "
                "cells, lambda cells: Membrane(cells, ...), or of its cells and the points."
            )
    for name, components in (supports or {}).items():
        validation.letters(f"The support {validation.name('support', name)!r}", components)


def structure(
    groups: Groups, parts: Makers, supports: Mapping[str, str], separate: Sequence[tuple[str, str]]
) -> Structure:
    """Make a structure of the nodes that parts use, in the order of their rows.

    Raises:
        ValueError: Cells do not fit their part; a support has no nodes, or nodes that no part uses.
    """
    used = np.unique(np.concatenate([groups.cells[name].ravel() for name in parts]))
    row = np.full(len(groups.points), -1, dtype=np.int64)
    row[used] = np.arange(len(used))
    held = []
    for name, components in supports.items():
        nodes = groups.nodes[name]
        if not len(nodes):
            raise ValueError(f"The support {name!r} has no nodes; mesh the {groups.kind}, with the parts it holds.")
        loose = nodes[row[nodes] < 0]
        if len(loose):
            raise ValueError(
                f"The support {name!r} has nodes that no part uses, {len(loose)} of {len(nodes)}, as "
                f"{groups.label(loose[0])} at {validation.format_point(groups.points[loose[0]])}; put it on a part."
            )
        held.append(Support(np.unique(row[nodes]), components))
    points = groups.points[used]
    made = {name: _part(groups.kind, name, make, row[groups.cells[name]], points) for name, make in parts.items()}
    return Structure(points, made, held, separate)


def _part(
    kind: str, name: str, make: Callable[..., Part], cells: NDArray[np.int64], points: NDArray[np.float64]
) -> Part:
    """Make a part of cells, or of cells and points, by the user's function; errors name the group."""
    try:
        return make(cells, points) if _takes_points(make) else make(cells)
    except ValueError as error:
        what = "triangles, for a Membrane" if cells.shape[1] == 3 else "segments, for a Cable or a Mast"
        raise ValueError(f"The {kind} {name!r} has {what}; they make no part: {error}") from error


def _takes_points(make: Callable[..., Part]) -> bool:
    """Return True if a function needs two arguments; one with a default is not meant."""
    try:
        parameters = inspect.signature(make).parameters.values()
    except (TypeError, ValueError):  # a callable of C
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(entry.kind in positional and entry.default is entry.empty for entry in parameters) == 2
