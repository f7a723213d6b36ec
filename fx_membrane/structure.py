"""A tension structure as plain data: points, parts (membranes, cables and masts) and supports, checked when created."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from . import validation
from .geometry import degenerate, normals, projected, senses
from .parts import Kind, Membrane, Part

COINCIDENT = 1e-9


class CoincidentNodesWarning(UserWarning):
    """Nodes at one place that are not one node: parts are joined by the nodes they share, not by where these are."""


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

    The nodes of a triangle may be in either order: when the structure is made, all cells of a connected membrane, open
    or closed, are given one sense, that of the first, which `normals` and `senses` show. A membrane that has none (a
    Moebius strip, or sheets that branch) is a structure all the same; it is refused where a normal is asked for, or a
    pressure acts.

    Args:
        points: Reference (prestressed) position of the nodes, shape (n, 3) [m]. A node is known by its row.
        parts: Membranes, cables and masts by name. Parts that share a node are hinged together there. Give each a
            name of its own: of two entries with one name a Python dictionary keeps the last without a word.
        supports: Nodes that do not move.

    Raises:
        ValueError: A cell names a node that does not exist, has no area or no length, or is normal to its warp
            vector; a support is on a node that does not exist or that no part uses; a value is not finite.

    Warns:
        CoincidentNodesWarning: Nodes of the parts are at one place, nearer than 1e-9 of the size of the structure, and
            not all of them are held there by supports. If they are meant to be apart (a slit, two cables that cross),
            switch it off: `warnings.simplefilter("ignore", CoincidentNodesWarning)`.
    """

    points: NDArray[np.float64]
    parts: Mapping[str, Part]
    supports: Sequence[Support] = ()
    _senses: dict[str, NDArray[np.float64] | ValueError] = field(init=False, repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", validation.positions("points", self.points))
        if not isinstance(self.parts, Mapping):
            raise ValueError(f'parts is a {type(self.parts).__name__}; give a dictionary, {{"name": Membrane(...)}}.')
        object.__setattr__(self, "parts", dict(self.parts))
        object.__setattr__(self, "supports", validation.instances("supports", self.supports, Support))
        if not self.parts:
            raise ValueError("The structure has no parts; give at least one Membrane, Cable or Mast.")
        count = len(self.points)
        for name, part in self.parts.items():
            validation.name("part", name)
            validation.instance(f"Part {name!r}", part, Part)
            for cell in np.flatnonzero(((part.cells < 0) | (part.cells >= count)).any(axis=1))[:1]:
                validation.in_range(f"Part {name!r}, cell {cell},", part.cells[cell], count, "node")
            self._check_measures(name, part)
            if part.dimension == 2:
                self.warp(name)
                self._orient(name)
        for number, support in enumerate(self.supports):
            self.check_nodes(f"Support {number}", np.asarray(support.nodes))
        self._warn_of_coincident_nodes()

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
    def size(self) -> float:
        """Largest extent of the nodes that parts use, along x, y or z [m]."""
        return float(np.ptp(self.points[self.used], axis=0).max())

    @property
    def supported(self) -> NDArray[np.bool_]:
        """Which components of which nodes are held by supports, shape (n, 3)."""
        held = np.zeros(self.points.shape, dtype=bool)
        for support in self.supports:
            for component in validation.components("Support components", support.components):
                held[support.nodes, component] = True
        return held

    def warp(self, name: str) -> NDArray[np.float64]:
        """Unit warp direction of every cell of a membrane in its own plane, shape (cells, 3) [-].

        Raises:
            ValueError: There is no membrane of that name; the warp is normal to a cell.
        """
        membrane = self.part(name, Membrane)
        normal = normals(self.points, membrane.cells)
        if membrane.warp is None:
            given = np.where(np.abs(normal[:, :1]) < 0.99, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
        else:
            given = np.broadcast_to(np.asarray(membrane.warp, dtype=np.float64), normal.shape)
        tangent = projected(given, normal)
        bad = np.flatnonzero(~tangent.any(axis=1))
        if len(bad):
            raise ValueError(
                f"Part {name!r}, cell {bad[0]}: its warp {given[bad[0]].tolist()} is zero or normal to the cell; "
                "give a vector that lies roughly in the cell."
            )
        return tangent

    def senses(self, name: str) -> NDArray[np.float64]:
        """1 where the nodes of a cell of a membrane run counter-clockwise about its normal, else -1, shape (cells,).

        The normals are those of `normals`; in each connected piece the first cell has 1.

        Raises:
            ValueError: There is no membrane of that name; it has only one side, like a Moebius strip, or branches.
        """
        self.part(name, Membrane)
        found = self._senses[name]
        if isinstance(found, ValueError):
            raise ValueError(*found.args)
        return found

    def normals(self, name: str) -> NDArray[np.float64]:
        """Unit normals of a membrane, all on one side of it, shape (cells, 3) [-]; a positive pressure acts along them.

        To turn those of a connected piece round, give the nodes of its first cell in the other order.

        Raises:
            ValueError: As for `senses`.
        """
        return self.senses(name)[:, None] * normals(self.points, self.parts[name].cells)

    def part(self, name: str, kind: type[Kind]) -> Kind:
        """The part of a name and a kind, Membrane, Cable or Mast.

        Raises:
            ValueError: There is none of that name and kind.
        """
        part = self.parts.get(name)
        if not isinstance(part, kind):
            other = f", which is a {type(part).__name__}" if part is not None else ""
            names = [key for key, part in self.parts.items() if isinstance(part, kind)]
            raise ValueError(f"No {kind.__name__} is named {name!r}{other}; those of the structure are {names}.")
        return part

    def check_nodes(self, what: str, nodes: NDArray[np.int64]) -> None:
        """Refuses nodes that do not exist or that no part uses.

        Raises:
            ValueError: Names what, and the node.
        """
        validation.in_range(what, nodes, len(self.points), "node")
        loose = nodes[~self.used[nodes]]
        if len(loose):
            where = validation.place(self.points[loose[0]])
            raise ValueError(
                f"{what} is on node {loose[0]}, which no part uses, at {where}; mend the number or add the part."
            )

    def _warn_of_coincident_nodes(self) -> None:
        used = np.flatnonzero(self.used)
        pairs = used[cKDTree(self.points[used]).query_pairs(COINCIDENT * self.size, output_type="ndarray")]
        fixed = self.supported.all(axis=1)
        pairs = pairs[~fixed[pairs].all(axis=1)]
        if len(pairs):
            pairs = np.sort(pairs, axis=1)
            a, b = pairs[np.lexsort(pairs.T[::-1])[0]]
            count = f" ({len(pairs)} such pairs in all)" if len(pairs) > 1 else ""
            warnings.warn(
                f"Nodes {a} and {b} are at the same place, {validation.place(self.points[a])}, but nothing joins them"
                f"{count}: {self._using(a)} and {self._using(b)} can part there. To join them, give all cells that "
                "meet there the same node number.",
                CoincidentNodesWarning,
                stacklevel=4,
            )

    def _using(self, node: int) -> str:
        """The first cell at a node, in words."""
        for name, part in self.parts.items():
            cells = np.flatnonzero((part.cells == node).any(axis=1))
            if len(cells):
                return f"cell {cells[0]} of {name!r}"
        raise AssertionError("no part uses the node")

    def _orient(self, name: str) -> None:
        """Finds one sense of all cells of a membrane; why it has none is kept until someone asks for it."""
        try:
            self._senses[name] = senses(f"Part {name!r}", self.parts[name].cells)
        except ValueError as refusal:
            self._senses[name] = refusal

    def _check_measures(self, name: str, part: Part) -> None:
        bad = degenerate(self.points, part.cells)
        if len(bad):
            what = "length" if part.dimension == 1 else "area"
            raise ValueError(
                f"Part {name!r}, cell {bad[0]} (nodes {part.cells[bad[0]].tolist()}) has no {what}; "
                "remove the cell or move its nodes apart."
            )
