"""Strips of a surface that is cut along seams: a structure whose membranes are the strips."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..checks.values import counted
from ..model.parts import Membrane
from ..model.structure import Structure


@dataclass(frozen=True, eq=False)
class Edge:
    """Edge of strips: a seam between two strips, or a border of one.

    Args:
        name: Name, as "seam 3" or "border 2".
        nodes: Nodes of the structure from one end to the other, shape (n,); a closed edge ends with its first node.
        strips: Names of the strips on its left and right, seen along it on the positive side of the surface; of a
            border the one strip.
        line: Name of the part that runs along it, as an edge or valley cable, or None.
        held: Nodes are supported in all directions, as on a ring or a rail.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> strips = cut_strips(roof, ["valley"])
        >>> [(edge.name, edge.strips) for edge in strips.edges if edge.is_seam]
        [('seam 1', ('strip 1', 'strip 2'))]
    """

    name: str
    nodes: NDArray[np.int64]
    strips: tuple[str, ...]
    line: str | None = None
    held: bool = False

    @property
    def is_seam(self) -> bool:
        """True of a weld or sewn line between two strips."""
        return len(self.strips) == 2


@dataclass(frozen=True, eq=False)
class Strips:
    """Surface cut into strips.

    Args:
        structure: The strips as membrane parts with their warp, nodes on seams shared, beside all other parts.
        edges: Seams and borders of all strips.
        copies: Name of the strip that is cut for each copy, by the name of the copy.
        mirrored: Names of the copies for which the pattern is turned over.
        nodes: Number here of each node of the structure before the cut, -1 if it is gone, shape (old nodes,).
        force_unit: Name of the unit of force, that of the form, for tables and files; nothing is converted.
        length_unit: Name of the unit of length.
        membranes: Name of the membrane that each strip is cut from, by the name of the strip.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> strips = cut_strips(roof, ["valley"])
        >>> strips
        Strips(2 strips, 0 of them cut as others, 1 seam, 6 borders)
        >>> strips.names
        ('strip 1', 'strip 2')
    """

    structure: Structure
    edges: tuple[Edge, ...]
    copies: Mapping[str, str] = field(default_factory=dict)
    mirrored: frozenset[str] = frozenset()
    nodes: NDArray[np.int64] = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    force_unit: str = "N"
    length_unit: str = "m"
    membranes: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        seams = sum(edge.is_seam for edge in self.edges)
        return (
            f"Strips({counted(len(self.names), 'strip')}, {len(self.copies)} of them cut as others, "
            f"{counted(seams, 'seam')}, {counted(len(self.edges) - seams, 'border')})"
        )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the strips, in the order of the parts of the structure."""
        known = {name for edge in self.edges for name in edge.strips}
        return tuple(name for name in self.structure.parts if name in known)

    def membrane(self, name: str) -> Membrane:
        """Strip as a part of the structure."""
        return self.structure.part(name, Membrane)

    def cut_from(self, name: str) -> tuple[str, ...]:
        """Find the strips that are cut from a membrane; none if there is no membrane of that name."""
        return tuple(strip for strip in self.names if (self.membranes or {}).get(strip) == name)

    def edges_of(self, name: str) -> tuple[Edge, ...]:
        """Edges of a strip."""
        return tuple(edge for edge in self.edges if name in edge.strips)


def check_strips(caller: str, given: Any) -> None:
    """Refuse what is no strips.

    Raises:
        ValueError: It is of another class.
    """
    if not isinstance(given, Strips):
        raise ValueError(
            f"{caller} needs Strips, but strips is {validation.short_repr(given)}; give those of cut_strips(structure, "
            "seams)."
        )
    validation.plain(f"{caller} strips", given, Strips)
