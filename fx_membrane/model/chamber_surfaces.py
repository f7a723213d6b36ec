"""Closed surface of a chamber: its membranes turned outwards, and the rigid walls that close its holes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.closed_surfaces import boundary, holes, open_edges, volume
from ..geometry.sizes import measures

Array = NDArray[np.float64]
Nodes = NDArray[np.int64]

ZERO_VOLUME = 1e-9  # volume, as a fraction of the area to the power 3/2, below which a surface encloses none
NAMED = 6  # nodes of a hole that are named


class Surface(NamedTuple):
    """Closed surface of a chamber.

    Attributes:
        triangles: Cells, their normals outwards, shape (cells, 3).
        rims: Edges of rigid walls, in the sense of the walls, shape (edges, 2).
        centers: Fixed point in the plane of the wall of each edge, shape (edges, 3) [m].
    """

    triangles: Nodes
    rims: Nodes
    centers: Array


def surface(structure: Any, name: str) -> Surface:
    """Surface of a chamber of a structure.

    Raises:
        ValueError: A part does not exist or is no membrane; the surface is not closed, inside out, or flat without
            given senses.
    """
    chamber, what = structure.chambers[name], f"Chamber {name!r}"
    cells = {}
    for part in chamber.parts:
        if part not in structure.membranes:
            membranes = list(structure.membranes)
            raise ValueError(f"{what} has the part {part!r}, which is no membrane; those are {membranes}.")
        structure.check_sides(part)
        cells[part] = structure.parts[part].cells
    given = isinstance(chamber.parts, Mapping)
    senses = dict(chamber.parts) if given else _senses(what, cells)
    triangles = np.vstack([part if senses[key] > 0 else part[:, ::-1] for key, part in cells.items()])
    rims = open_edges(triangles)[:, ::-1]
    _check_meeting(what, rims, cells)
    centers = _centers(what, structure, chamber, rims)
    fans = np.column_stack([rims, len(structure.points) + np.arange(len(rims))])
    within = volume(np.vstack([structure.points, centers]), np.vstack([triangles, fans]))
    flat = abs(within) <= ZERO_VOLUME * measures(structure.points, triangles).sum() ** 1.5
    if flat and not given and len(cells) > 1:
        senses_shown = ", ".join(f'"{key}": {sense}' for key, sense in senses.items())
        raise ValueError(
            f"{what} encloses no volume in the reference shape, so that its outside is unknown; say where the normals "
            f"point, as parts={{{senses_shown}}}, 1 out of the chamber and -1 into it."
        )
    if within < 0 and not flat:
        if given:
            raise ValueError(
                f"{what} is inside out: with the senses given its volume is {within:.4g}; give the opposite ones."
            )
        return Surface(triangles[:, ::-1], rims[:, ::-1], centers)
    return Surface(triangles, rims, centers)


def _senses(what: str, cells: Mapping[str, Nodes]) -> dict[str, int]:
    """Senses of parts that run against each other along their common edges, that of the first being 1."""
    names, rims = list(cells), {name: boundary(part) for name, part in cells.items()}
    base = max(int(part.max()) for part in cells.values()) + 1
    ways = {
        name: dict(zip((edges @ (base, 1)).tolist(), sums.tolist(), strict=True))
        for name, (edges, sums) in rims.items()
    }
    senses, ahead = {names[0]: 1}, [names[0]]
    while ahead:
        here = ahead.pop()
        for other in names:
            common = ways[here].keys() & ways[other].keys()
            if other in senses or not common:
                continue
            edge = min(common)
            senses[other] = -senses[here] if ways[here][edge] * ways[other][edge] > 0 else senses[here]
            ahead.append(other)
    apart = [name for name in names if name not in senses]
    if apart:
        raise ValueError(
            f"{what} has the parts {names[0]!r} and {apart[0]!r}, which share no edge along their rims; say where the "
            f'normals point, as parts={{"{names[0]}": 1, "{apart[0]}": -1}}, 1 out of the chamber and -1 into it.'
        )
    return senses


def _check_meeting(what: str, rims: Nodes, cells: Mapping[str, Nodes]) -> None:
    """Refuse two parts that meet with opposite senses."""
    found, count = np.unique(rims, axis=0, return_counts=True)
    if len(found) and count.max() > 1:
        edge = found[np.argmax(count)]
        here = [name for name, part in cells.items() if (np.isin(part, edge).sum(axis=1) > 1).any()]
        raise ValueError(
            f"{what} has parts {here} whose normals point to different sides where they meet, at the edge between "
            f"nodes {edge.min()} and {edge.max()}; give one of them the other sense (1 out of the chamber, -1 into it)."
        )


def _centers(what: str, structure: Any, chamber: Any, rims: Nodes) -> Array:
    """Return fixed points of the rigid walls that close holes, one for each edge, shape (edges, 3).

    Raises:
        ValueError: There are holes, and no walls are wanted; a rim is not held.
    """
    centers = np.empty((len(rims), 3))
    if not len(rims):
        return centers
    if not chamber.rigid_walls:
        found = holes(rims)
        where = validation.format_point(structure.points[np.unique(found[0])].mean(axis=0))
        nodes = np.unique(found[0])
        shown = ", ".join(map(str, nodes[:NAMED])) + ", ..." * (len(nodes) > NAMED)
        also = f", and {len(found) - 1} more" if len(found) > 1 else ""
        raise ValueError(
            f"{what} is not closed: it has a hole of {len(found[0])} edges about {where}, between the nodes {shown}"
            f"{also}; add the part that closes it, or rigid_walls=True where supports hold its rim."
        )
    points, held = structure.points, structure.supported
    loose = []
    for rim in holes(rims):
        chosen = (rims[:, None] == rim[None]).all(axis=2).any(axis=1)
        if held[rim].all():
            centers[chosen] = points[np.unique(rim)].mean(axis=0)
        else:
            loose.append(chosen)
    if loose:
        chosen = np.any(loose, axis=0)
        centers[chosen] = _in_planes(what, points, held, rims[chosen])
    return centers


def _in_planes(what: str, points: Array, held: NDArray[np.bool_], rims: Nodes) -> Array:
    """Return fixed points in the planes x, y or z constant in which rims are held, shape (edges, 3)."""
    near = 1e-9 * float(np.ptp(points, axis=0).max())
    across = held[rims].all(axis=1) & (np.abs(points[rims[:, 0]] - points[rims[:, 1]]) <= near)
    bad = np.flatnonzero(~across.any(axis=1))
    if len(bad):
        a, b = rims[bad[0]]
        raise ValueError(
            f"{what} has a hole whose rim is not held between nodes {a} and {b}, at "
            f"{validation.format_point(points[[a, b]].mean(axis=0))}; hold it in all components, or across a plane x, "
            "y or z constant, or close it by a part."
        )
    axis = np.argmax(across, axis=1)
    for index in range(3):  # an edge in two planes belongs to one that other edges are in, too
        alone = across.sum(axis=1) == 1
        axis = np.where(across[:, index] & (axis[alone] == index).any() & ~alone, index, axis)
    places = points[rims[:, 0], axis]
    centers = np.tile(points[np.unique(rims)].mean(axis=0), (len(rims), 1))
    axes = np.unique(axis)
    single = all(np.ptp(places[axis == one]) <= near for one in axes)
    if not single and len(axes) > 1:
        raise ValueError(
            f"{what} has rims in planes that meet and in parallel ones, more than rigid walls can close; close some by "
            "membranes that supports hold."
        )
    if single:
        for one in axes:
            centers[:, one] = places[axis == one][0]
    else:
        centers[:, axes[0]] = places
    return centers
