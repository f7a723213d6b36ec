"""Strips as pictures show them: on the roof, the films of a cushion one below the other."""

from __future__ import annotations

import warnings
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.topology import boundary_edges
from ..model.fabrics import Fabric
from ..model.parts import Cable, Membrane
from ..model.structure import Structure
from ..patterns.strips import Strips

Array = NDArray[np.float64]

DRAWN = Fabric(1.0, 0.0)  # no picture shows the material, and some need more data than cells
DROP = 0.5  # of each film below the one before, over the extent of the strips in plan


class InView(NamedTuple):
    """Strips in view.

    Attributes:
        structure: Strips and other parts where they are seen, its nodes once for each film.
        films: Number of films one below the other.
    """

    structure: Structure
    films: int

    def at_nodes(self, values: Array) -> Array:
        """Values at the nodes of the strips, at those in view, shape (films n,)."""
        return np.tile(values, self.films)


def in_view(strips: Strips, points: Array, seams: bool = False) -> InView:
    """Place strips with their nodes at some points; with lines along seams, as `line_along`, in place of other lines.

    Films with one rim, as those of a cushion, hide each other: they are drawn one below the other.
    """
    film = _film_of_strip(strips)
    count = max(film.values()) + 1
    drop = DROP * float(np.linalg.norm(np.ptp(points[:, :2], axis=0))) * np.array([0.0, 0.0, 1.0])
    parts: dict[str, Any] = {}
    for name, part in strips.structure.parts.items():
        if name in film:
            parts[name] = Membrane(part.cells + film[name] * len(points), DRAWN)
        elif name in strips.structure.membranes or not seams:
            parts[name] = part
    for edge in strips.edges:
        if seams and edge.is_seam:
            nodes = edge.nodes + film[edge.strips[0]] * len(points)
            parts[line_along(edge.name)] = Cable(list(pairwise(nodes.tolist())), 1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of lines along others, and cells that are slivers
        placed = np.concatenate([points - number * drop for number in range(count)])
        return InView(Structure(placed, parts), count)


def line_along(seam: str) -> str:
    """Name of the line along a seam, which no strip has."""
    return f"line along {seam}"


def _film_of_strip(strips: Strips) -> dict[str, int]:
    """Find the number of the film of each strip, 0 for all unless they hide each other."""
    names = list(dict.fromkeys((strips.membranes or {}).get(strip, "") for strip in strips.names))
    of_film = [list(strips.cut_from(name)) for name in names]
    alone = dict.fromkeys(strips.names, 0)
    if len(names) < 2 or "" in names:
        return alone
    cells = [np.concatenate([strips.membrane(strip).cells for strip in film]) for film in of_film]
    rims = [set(map(tuple, np.sort(boundary_edges(some), axis=1).tolist())) for some in cells]
    if any(rim != rims[0] for rim in rims):
        return alone
    height = [float(strips.structure.points[some.ravel(), 2].mean()) for some in cells]
    order = np.argsort(-np.array(height), kind="stable").tolist()
    return {strip: place for place, film in enumerate(order) for strip in of_film[film]}
