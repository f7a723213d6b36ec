"""Decompensation: borders and corners of the cloth that keep their length on the surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from .flat_shapes import Flattened

Array = NDArray[np.float64]


def checked(flat: Flattened, given: Sequence[str | int] | str | int, transition: float | None) -> tuple[str | int, ...]:
    """Names of edges and numbers of nodes that are decompensated.

    Raises:
        ValueError: An edge or a node is unknown; the width of the transition is missing, not positive, or given
            without any of them.
    """
    if not isinstance(given, str | int | np.integer | Sequence | np.ndarray):
        raise ValueError(
            f"decompensate is {validation.short_repr(given)}; give names of edges and numbers of nodes, as "
            "['border 1']."
        )
    entries = (given,) if isinstance(given, str | int | np.integer) else tuple(given)
    chosen: list[str | int] = []
    for one in entries:
        if isinstance(one, str):
            chosen += _edges(flat, one)
            continue
        chosen.append(validation.integer("decompensate node", one))
        if one not in flat.pieces.nodes:
            raise ValueError(f"decompensate: node {one} is on no strip; give names of edges, or nodes of strips.")
    if chosen and transition is None:
        raise ValueError(
            "decompensate needs the width over which compensation begins; give transition=..., as 0.5 [m]."
        )
    if transition is not None:
        width = validation.positive("transition", transition)
        if not chosen:
            raise ValueError(
                f"transition is {width:g}, but nothing is decompensated; give decompensate=..., as ['border 1'], or "
                "leave transition out."
            )
    return tuple(dict.fromkeys(chosen))


def _edges(flat: Flattened, name: str) -> list[str]:
    """Name the edge of a name, or else all edges along the cable or rope of that name."""
    edges = flat.strips.edges
    known = [edge.name for edge in edges]
    found = [name] if name in known else [edge.name for edge in edges if edge.line == name]
    if not found:
        lines = sorted({edge.line for edge in edges if edge.line})
        along = f", and lines along them {lines}" if lines else ""
        raise ValueError(f"decompensate: no edge is named {name!r}; the edges are {known}{along}.")
    return found


def without_compensation(flat: Flattened, chosen: Sequence[str | int], width: float) -> Array:
    """Share of each direction without compensation, zero far from chosen edges and nodes, shape (k, 2, 2) [-].

    The share falls from one on an edge, in its direction, to zero at a distance of `width`, smoothly.
    """
    pieces = flat.pieces
    centres = flat.places[pieces.triangles].mean(axis=1)
    share = np.zeros((len(centres), 2, 2))
    names = [edge.name for edge in flat.strips.edges]
    for number in range(len(pieces.names)):
        rows, cells = pieces.points_of(number), pieces.cells_of(number)
        mine = (pieces.border[:, 0] >= rows.start) & (pieces.border[:, 0] < rows.stop)
        for one in chosen:
            if isinstance(one, str):
                ends = flat.places[pieces.border[mine & (pieces.edge == names.index(one))]]
                share[cells] += _along(centres[cells], ends, width)
            else:
                corners = flat.places[rows][pieces.nodes[rows] == one]
                for corner in corners:
                    away = np.linalg.norm(centres[cells] - corner, axis=1)
                    share[cells] += _fall(away / width)[:, None, None] * np.eye(2)
    values, axes = np.linalg.eigh(share)
    return np.asarray((axes * np.minimum(values, 1.0)[:, None, :]) @ axes.transpose(0, 2, 1))


def _along(centres: Array, ends: Array, width: float) -> Array:
    """Shares by the nearest of some segments, shape (k, 2, 2)."""
    if not len(ends):
        return np.zeros((len(centres), 2, 2))
    a, d = ends[:, 0], ends[:, 1] - ends[:, 0]
    best, nearest = np.full(len(centres), np.inf), np.zeros(len(centres), dtype=np.int64)
    for segment in range(len(ends)):  # one by one: cells are many, segments of an edge few
        along = np.clip((centres - a[segment]) @ d[segment] / (d[segment] @ d[segment]), 0.0, 1.0)
        away = np.linalg.norm(centres - a[segment] - along[:, None] * d[segment], axis=1)
        nearer = away < best
        best[nearer], nearest[nearer] = away[nearer], segment
    t = (d / np.linalg.norm(d, axis=1)[:, None])[nearest]
    return np.asarray(_fall(best / width)[:, None, None] * t[:, :, None] * t[:, None, :])


def _fall(distance: Array) -> Array:
    """Fall smoothly from one to zero over a distance of one."""
    s = np.clip(distance, 0.0, 1.0)
    return np.asarray(1 - s**2 * (3 - 2 * s))
