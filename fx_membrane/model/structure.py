"""A tension structure as plain data: points, parts (membranes, cables and masts) and supports, checked when created."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.read_only_data import ReadOnlyDict
from ..checks.values import counted
from ..geometry.sizes import normals, projected
from ..runtime.notebook_pictures import picture_html, picture_png, table
from . import energy_terms, laws, slivers
from .base_classes import AnyPart
from .by_value import ByValue
from .chambers import Chamber, checked_chambers
from .coincidence import CoincidentNodesWarning, checked_pairs, coincident_nodes
from .energy_terms import Term
from .parts import Bar, Kind, Line, Membrane, Part
from .supports import Support


@dataclass(frozen=True, eq=False, repr=False)
class Structure(ByValue):
    """Points, parts and supports: everything that stays the same from stage to stage.

    The nodes of a triangle may be in either order. The structure turns all cells of a connected membrane, open or
    closed, to the sense of the first. In `parts` a turned cell has its last two nodes exchanged; the rows of cells keep
    their order. Data per cell stay valid, as none depend on the order of its nodes: prestress is in the warp/weft frame
    of the one sense, warp is a vector in space, pressure is along `normals`.

    A membrane may be in pieces that share no edge: apart, or joined at nodes only. Its first piece that is not closed
    decides for the others. A piece is turned where its mean normal, weighted by area, points against that of the first.
    A closed piece, or one at a right angle to the first, keeps the sense of its own first cell; make it a part of its
    own.

    A membrane without two sides (a Moebius strip, or sheets that branch) is allowed. Its cells keep their sense, in a
    branching membrane that of their sheet. It is refused where `normals` are asked for or a pressure acts. So is one
    shear of prestress or natural stretch for all cells. So is a law that tells a shear from its opposite. A shear in
    warp/weft axes then has the sign of each cell: results tell that (`ShearSignWarning`), and tables have no number for
    it. Prestress tensors per cell are taken in the axes of the cells in `parts`.

    Args:
        points: Reference (prestressed) position of the nodes, shape (n, 3) [m]. The row is the number of the node.
        parts: Membranes, cables, masts and ropes by name. Parts that share a node are hinged together there. A
            rope slides over its nodes. Names must be unique: of two equal keys, a Python dictionary keeps the last in
            silence.
        supports: Constrained nodes.
        separate: Pairs of names of parts that lie on each other without being joined, as the two skins of a cushion:
            `[("top", "bottom")]`. Their nodes may coincide. Pair a part with itself for a slit.
        terms: Terms of your own that act in every stage, and in full: an elastic bed, the ground that a cable touches;
            see `EnergyTerm`.
        chambers: Enclosed gas by name, see `Chamber`: cushions, air halls, balloons.

    Raises:
        ValueError: A cell names a node that does not exist; it has no area or no length, or is normal to its warp; a
            triangle is more than 1e7 times as long as it is high; the structure or a part is of a class derived from
            `Structure`, `Membrane`, `Cable` or `Mast`; a support is on a node that does not exist or that no part uses;
            a value is not finite; a membrane without two sides has one shear for all cells, or a law unsymmetric about
            the warp; separate names a part that is not there; a term does not fit, see `EnergyTerm`; a chamber is not
            closed, or is inside out.

    Warns:
        CoincidentNodesWarning: Nodes of the parts are closer than 1e-9 of the size of the structure, not all of them
            supported. If they are meant to be apart (two skins, a slit, two cables that cross), name their parts in
            `separate`.
        SliverWarning: A triangle is more than 5e5 times as long as it is high.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> rim = boundary_edges(triangles)
        >>> parts = {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3), "edge": Cable(rim, 1e7, 2e4)}
        >>> roof = Structure(points, parts, [Support(np.unique(rim))])
        >>> len(roof.points), int(roof.supported.sum()), roof.normals("roof")[0].tolist()
        (25, 48, [0.0, 0.0, 1.0])
    """

    points: NDArray[np.float64]
    parts: Mapping[str, Part]
    supports: Sequence[Support] = ()
    separate: Sequence[tuple[str, str]] = ()
    terms: Sequence[Term] = ()
    chambers: Mapping[str, Chamber] = field(default_factory=dict)
    _no_sides: dict[str, str] = field(init=False, repr=False, default_factory=dict)  # membrane: reason

    if TYPE_CHECKING:  # the field holds an array, but lists may be given

        def __init__(
            self,
            points: ArrayLike,
            parts: Mapping[str, AnyPart],
            supports: Sequence[Support] = ...,
            separate: Sequence[tuple[str, str]] = ...,
            terms: Sequence[Term] = ...,
            chambers: Mapping[str, Chamber] = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        validation.plain("The structure", self, Structure)
        object.__setattr__(self, "points", validation.positions("points", self.points))
        if not isinstance(self.parts, Mapping):
            raise ValueError(f'parts is a {type(self.parts).__name__}; give a dictionary, {{"name": Membrane(...)}}.')
        parts = {validation.name("part", name): part for name, part in self.parts.items()}
        object.__setattr__(self, "parts", parts)
        object.__setattr__(self, "supports", validation.instances("supports", self.supports, Support))
        if not self.parts:
            raise ValueError("The structure has no parts; give at least one Membrane, Cable, Mast or Rope.")
        for name, part in self.parts.items():
            validation.plain(f"Part {name!r}", part, Part)
            for cell in np.flatnonzero(((part.cells < 0) | (part.cells >= len(self.points))).any(axis=1))[:1]:
                validation.in_range(f"Part {name!r}, cell {cell},", part.cells[cell], len(self.points), "node")
            slivers.check(self.points, name, part)
        for name, membrane in self.parts_of(Membrane).items():
            if membrane.warp is not None:
                self.warp(name)
        validation.keep(self, parts=ReadOnlyDict((name, self._fitted(name, part)) for name, part in parts.items()))
        for number, support in enumerate(self.supports):
            self.check_nodes(f"Support {number}", np.asarray(support.nodes))
        object.__setattr__(self, "separate", checked_pairs(self.separate, self.parts))
        object.__setattr__(self, "terms", energy_terms.checked("terms", self.terms))
        for term in self.terms:
            energy_terms.check_on(self, "terms", term)
        object.__setattr__(self, "chambers", ReadOnlyDict(checked_chambers(self)))
        self._warn_of_coincident_nodes()

    def __repr__(self) -> str:
        kinds = ", ".join(f"{name!r}: {len(part.cells)} x {type(part).__name__}" for name, part in self.parts.items())
        return f"Structure({counted(len(self.points), 'point')}, {{{kinds}}}, {counted(len(self.supports), 'support')})"

    def _repr_html_(self) -> str:
        """Show the parts and a picture in notebooks."""
        rows = [[escape(name), type(part).__name__, str(len(part.cells))] for name, part in self.parts.items()]
        return f"<b>{escape(repr(self))}</b>" + table(["part", "kind", "cells"], rows) + picture_html(self)

    def _repr_png_(self) -> bytes | None:
        """Show a picture where a notebook takes no HTML."""
        return picture_png(self)

    @cached_property
    def used(self) -> NDArray[np.bool_]:
        """Nodes that belong to a part, shape (n,)."""
        used = np.zeros(len(self.points), dtype=bool)
        for part in self.parts.values():
            used[part.cells] = True
        used.setflags(write=False)
        return used

    @cached_property
    def size(self) -> float:
        """Largest extent along an axis, of the nodes that belong to a part [m]."""
        return float(np.ptp(self.points[self.used], axis=0).max())

    @property
    def supported(self) -> NDArray[np.bool_]:
        """Components constrained by supports, shape (n, 3)."""
        held = np.zeros(self.points.shape, dtype=bool)
        for support in self.supports:
            for component in validation.components("Support components", support.components):
                held[np.asarray(support.nodes), component] = True
        return held

    def warp(self, name: str) -> NDArray[np.float64]:
        """Project the warp of a membrane on its cells: unit vectors, shape (cells, 3) [-].

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
            where = validation.format_point(self.points[membrane.cells[bad[0]]].mean(axis=0))
            raise ValueError(
                f"Part {name!r}, cell {bad[0]}: its warp {given[bad[0]].tolist()} is zero or normal to the cell, at "
                f"{where}; give a vector that lies roughly in the cell."
            )
        return tangent

    def normals(self, name: str) -> NDArray[np.float64]:
        """Return unit normals of a membrane, on one side of it, shape (cells, 3) [-]; pressure acts along them.

        The nodes of its cells in `parts` run counter-clockwise about them. To reverse the normals, give the nodes of
        the first cell in the other order. Of several pieces, see `Structure`.

        Raises:
            ValueError: There is no membrane of that name; it has only one side, like a Moebius strip, or branches.
        """
        membrane = self.part(name, Membrane)
        self.check_sides(name)
        return normals(self.points, membrane.cells)

    def check_sides(self, name: str) -> None:
        """Refuse a membrane without two sides.

        Raises:
            ValueError: It has only one side, like a Moebius strip, or branches.
        """
        if name in self._no_sides:
            raise ValueError(f"Part {name!r} {self._no_sides[name]}")

    def has_sides(self, name: str) -> bool:
        """Return False for a membrane without two sides: it has only one, like a Moebius strip, or branches."""
        return name not in self._no_sides

    def check_shear(self, name: str, tensor: ArrayLike, what: str) -> None:
        """Refuse one shear for all cells of a membrane without two sides: its sign depends on the cell.

        Args:
            name: Name of the part.
            tensor: A prestress or natural stretch in one of the forms that the part takes.
            what: Name of the tensor.

        Raises:
            ValueError: It has a shear, and the part has only one side, like a Moebius strip, or branches.
        """
        if name not in self._no_sides or np.shape(tensor)[-2:] != (2, 2):
            return
        values = np.reshape(tensor, (-1, 2, 2))
        shear = values[:, [0, 1], [1, 0]]
        if shear[0].any() and (shear == shear[0]).all():
            raise ValueError(f"Part {name!r}, with shear in its {what} {values[0].tolist()}, {self._no_sides[name]}")

    @property
    def membranes(self) -> dict[str, Membrane]:
        """Membranes by name."""
        return self.parts_of(Membrane)

    @property
    def bars(self) -> dict[str, Line]:
        """Cables, masts and ropes by name."""
        return {name: part for name, part in self.parts.items() if not isinstance(part, Membrane)}

    def part(self, name: str, kind: type[Kind]) -> Kind:
        """Part of a name and a kind, Membrane, Cable, Mast or Rope.

        Raises:
            ValueError: There is no part of that name and kind.
        """
        found = self.parts_of(kind)
        if not isinstance(name, str) or name not in found:
            other = self.parts.get(name) if isinstance(name, str) else None
            named = f"{validation.short_repr(name)}{f', which is a {type(other).__name__}' * (other is not None)}"
            raise ValueError(f"No {kind.__name__} is named {named}; those of the structure are {list(found)}.")
        return found[name]

    def parts_of(self, kind: type[Kind]) -> dict[str, Kind]:
        """Parts of one kind by name: `Membrane`, `Cable`, `Mast` or `Rope`.

        Raises:
            ValueError: The kind is none of these.
        """
        if not isinstance(kind, type) or kind not in (Bar, *get_args(Part)):
            raise ValueError(
                f"The kind of a part is {validation.short_repr(kind)}; give Membrane, Cable, Mast or Rope."
            )
        return {name: part for name, part in self.parts.items() if isinstance(part, kind)}

    def check_nodes(self, what: str, nodes: NDArray[np.int64]) -> None:
        """Refuse nodes that do not exist or that no part uses.

        Raises:
            ValueError: A node is unknown or unused; the message begins with `what` and names the node.
        """
        validation.in_range(what, nodes, len(self.points), "node")
        loose = nodes[~self.used[nodes]]
        if len(loose):
            raise ValueError(
                f"{what} is on node {loose[0]}, which no part uses, at "
                f"{validation.format_point(self.points[loose[0]])}; mend the number or add the part."
            )

    def _warn_of_coincident_nodes(self) -> None:
        found = coincident_nodes(self.points, self.parts, np.all(self.supported, axis=1), self.separate)
        if found:
            warnings.warn(found, CoincidentNodesWarning, stacklevel=4)

    def _fitted(self, name: str, part: Part) -> Part:
        """Part at the points of the structure; the reason why it has no two sides is stored until that matters."""
        found, reason = part.fitted(name, self.points)
        if reason:
            self._no_sides[name] = reason
            self.check_shear(name, part.prestress, "prestress")
            self.check_shear(name, part.natural_stretch, "natural stretch")
            if not laws.is_mirror_symmetric(part.material):
                law = validation.short_repr(part.material)
                raise ValueError(f"Part {name!r}, with a law that tells a shear from its opposite, {law}, {reason}")
        return found
