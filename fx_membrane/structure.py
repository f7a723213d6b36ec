"""A tension structure as plain data: points, parts (membranes, cables and masts) and supports, checked when created."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import validation
from .geometry import branching_edge, measures, normals, orientation
from .parts import Membrane, Part


@dataclass(frozen=True, eq=False)
class Support:
    """Nodes held at their reference position.

    Args:
        nodes: A node number or several, shape (k,).
        components: The components held, some of "xyz".

    Raises:
        ValueError: Nodes are not whole numbers; components are not letters of "xyz".
    """

    nodes: ArrayLike
    components: str = "xyz"

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", validation.rows("Support nodes", self.nodes))
        validation.components("Support components", self.components)


@dataclass(frozen=True, eq=False, repr=False)
class Structure:
    """Everything that does not change from stage to stage.

    Args:
        points: Reference (prestressed) position of the nodes, shape (n, 3) [m]. A node is known by its row.
        parts: Membranes, cables and masts by name. Parts that share a node are hinged together there.
        supports: Nodes that do not move.

    Raises:
        ValueError: A cell names a node that does not exist, has no area or no length, or is normal to its warp
            vector; a support is on a node that does not exist or that no part uses; a value is not finite.
    """

    points: NDArray[np.float64]
    parts: Mapping[str, Part]
    supports: Sequence[Support] = ()

    def __post_init__(self) -> None:
        points = validation.finite("points", self.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points has shape {points.shape}; give (n, 3), one row x, y, z for each node.")
        object.__setattr__(self, "points", points)
        if not isinstance(self.parts, Mapping):
            raise ValueError(f'parts is a {type(self.parts).__name__}; give a dictionary, {{"name": Membrane(...)}}.')
        object.__setattr__(self, "parts", dict(self.parts))
        object.__setattr__(self, "supports", validation.instances("supports", self.supports, Support))
        if not self.parts:
            raise ValueError("The structure has no parts; give at least one Membrane, Cable or Mast.")
        for name, part in self.parts.items():
            validation.name("part", name)
            validation.instance(f"Part {name!r}", part, Part)
            outside = np.flatnonzero(((part.cells < 0) | (part.cells >= len(points))).any(axis=1))
            for cell in outside[:1]:
                validation.in_range(f"Part {name!r}, cell {cell},", part.cells[cell], len(points), "node")
            self._check_measures(name, part)
            if part.dimension == 2:
                self.warp(name)
        for number, support in enumerate(self.supports):
            self.check_nodes(f"Support {number}", np.asarray(support.nodes))

    def __repr__(self) -> str:
        kinds = ", ".join(f"{name!r}: {len(part.cells)} x {type(part).__name__}" for name, part in self.parts.items())
        return f"Structure({len(self.points)} points, {{{kinds}}}, {len(self.supports)} supports)"

    @property
    def used(self) -> NDArray[np.bool_]:
        """Which nodes belong to a part, shape (n,)."""
        used = np.zeros(len(self.points), dtype=bool)
        for part in self.parts.values():
            used[part.cells] = True
        return used

    @property
    def supported(self) -> NDArray[np.bool_]:
        """Which components of which nodes are held by supports, shape (n, 3)."""
        held = np.zeros(self.points.shape, dtype=bool)
        for support in self.supports:
            for component in validation.components("Support components", support.components):
                held[support.nodes, component] = True
        return held

    def warp(self, name: str) -> NDArray[np.float64]:
        """Unit warp direction of every cell of a membrane in its own plane, shape (cells, 3) [-]."""
        membrane = self.parts[name]
        assert isinstance(membrane, Membrane)
        normal = normals(self.points, membrane.cells)
        if membrane.warp is None:
            along_x = np.abs(normal[:, :1]) < 0.99
            given = np.where(along_x, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
        else:
            given = np.broadcast_to(np.asarray(membrane.warp, dtype=np.float64), normal.shape)
        tangent = given - np.sum(given * normal, axis=1, keepdims=True) * normal
        length = np.linalg.norm(tangent, axis=1)
        bad = np.flatnonzero(length <= 1e-8 * np.linalg.norm(given, axis=1))
        if len(bad):
            raise ValueError(
                f"Part {name!r}, cell {bad[0]}: its warp {given[bad[0]].tolist()} is zero or normal to the cell; "
                "give a vector that lies roughly in the cell."
            )
        return np.asarray(tangent / length[:, None])

    def normals(self, name: str) -> NDArray[np.float64]:
        """Unit normals of a membrane, all on one side of it, shape (cells, 3) [-]; a positive pressure acts along them.

        In each connected piece they follow the right-hand rule of its first cell.

        Raises:
            ValueError: The membrane is one-sided, like a Moebius strip, or branches.
        """
        cells = self.parts[name].cells
        branch = branching_edge(cells)
        if branch is not None:
            raise ValueError(
                f"Part {name!r} branches at the edge between nodes {branch[0]} and {branch[1]}, so that it has no two "
                "sides; make each sheet a part of its own."
            )
        sides = orientation(cells)
        if sides is None:
            raise ValueError(
                f"Part {name!r} has only one side, like a Moebius strip, so that a normal and a pressure have no "
                "direction on it; cut it into parts along a line of edges."
            )
        return sides[:, None] * normals(self.points, cells)

    def check_nodes(self, what: str, nodes: NDArray[np.int64]) -> None:
        """Refuses nodes that do not exist or that no part uses.

        Raises:
            ValueError: Names what, and the node.
        """
        validation.in_range(what, nodes, len(self.points), "node")
        loose = nodes[~self.used[nodes]]
        if len(loose):
            raise ValueError(f"{what} is on node {loose[0]}, which no part uses; mend the number or add the part.")

    def _check_measures(self, name: str, part: Part) -> None:
        size = measures(self.points, part.cells)
        span = np.ptp(self.points[part.cells], axis=1).max(axis=1) ** part.dimension
        bad = np.flatnonzero(size <= 1e-10 * np.maximum(span, np.finfo(float).tiny))
        if len(bad):
            what = "length" if part.dimension == 1 else "area"
            raise ValueError(
                f"Part {name!r}, cell {bad[0]} (nodes {part.cells[bad[0]].tolist()}) has no {what}; "
                "remove the cell or move its nodes apart."
            )
