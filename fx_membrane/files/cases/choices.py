"""Nodes and cells that tables of a case choose: by number, by group of the geometry, by place, or by a rim."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ... import Form
from ...geometry.topology import boundary_edges
from ...model.parts import Membrane
from ...model.structure import Structure
from ..drawing import Drawing, nodes_of, triangles_of
from .faults import Unknown, Wrong, at_key, nearest
from .load_schema import CellChoice
from .names import check_groups
from .structure_schema import Box, NodeChoice
from .table import BROKEN, is_whole, one_of

Nodes = NDArray[np.int64]
CHOICES = ("nodes", "group", "where", "rim_of")
RANGE_TOLERANCE = 1e-9  # of the size of the structure: a place within it of a range is in the range
NUMBERED = "after a new mesh there are other numbers; choose by where, or by rim_of"


class Outline(NamedTuple):
    """A structure between the steps of form finding.

    Attributes:
        structure: The structure; None if it is not known.
        form: The form that it has; None before the first.
        renumbered: True after a new mesh, whose nodes and cells have other numbers than the file knows.
    """

    structure: Any
    form: Form | None = None
    renumbered: bool = False


class Choices:
    """Choices of nodes and cells.

    Args:
        drawing: Content of the geometry; None if that has a fault.
        kinds: See the attribute.

    Attributes:
        kinds: Dimension of each part that the file has, None for an unknown one; None if parts have a fault. Those
            with faults may be missing in the structure.
        rows: Node of the structure for each point of the drawing, -1 for a point of no part, shape (points,).
        drawn: False if the geometry has a fault.
        groups, chambers: Names that the geometry and the file have, in spite of faults; None if they are not known.
        whole: False if some part has a fault, so that numbers of nodes are not known.
        formed: False if some step of form finding has a fault, so that its bars may be missing.
    """

    def __init__(self, drawing: Drawing | None, kinds: Mapping[str, int | None] | None):
        self.drawn, self.kinds = drawing is not None, kinds
        self.groups: Collection[str] | None = None
        self.chambers: Collection[str] | None = None
        self.drawing = drawing = drawing or Drawing("the geometry", "group", np.zeros((0, 3)))
        self.rows = np.full(len(drawing.points), -1)
        self.whole, self.formed = self.drawn, True
        self._room = (
            RANGE_TOLERANCE * float(np.ptp(drawing.points, axis=0).max(initial=0.0)) if len(drawing.points) else 0.0
        )

    def nodes(self, outline: Outline, table: NodeChoice) -> Nodes:
        """Choose nodes.

        Raises:
            ValueError: Not one way of the four is given; a group, a membrane or a node does not exist.
            Unknown: It depends on a table that has a fault.
        """
        if table is BROKEN:
            raise Unknown
        key = one_of(table, *CHOICES, needed=True)
        structure = outline.structure
        if table.rim_of is not None:
            self.check_part(structure, table.rim_of, 2, "rim_of")
        if table.group is not None and not self.drawn:
            with at_key("group"):
                check_groups(self.groups, table.group)
        if structure is None or not is_whole(getattr(table, key)):
            raise Unknown
        if outline.renumbered and key in ("nodes", "group"):
            raise Wrong(NUMBERED, key)
        if table.nodes is not None:
            if not self.whole:
                raise Unknown
            return self.numbers(self.named(table.nodes, self.rows), len(structure.points), "nodes")
        if table.group is not None:
            with at_key("group"):
                rows = self.rows[nodes_of(self.drawing, table.group)]
            return self.needed(rows[rows >= 0], "group", f"no part uses a node of group {table.group!r}")
        if table.rim_of is not None:
            return np.unique(boundary_edges(structure.part(table.rim_of, Membrane).cells))
        found = np.flatnonzero(self.inside(table.where, structure.points) & structure.used)
        return self.needed(found, "where", "no node is in the range of where; correct it")

    def cells(self, outline: Outline, table: CellChoice, wanted: int) -> Nodes | None:
        """Choose cells of a part of a wanted dimension; None for all.

        Raises:
            ValueError: Two ways are given; the part does not exist, or no cell.
            Unknown: It depends on a table that has a fault.
        """
        one_of(table, "cells", "where")
        structure = outline.structure
        self.check_part(structure, table.part, wanted)
        if structure is None or not is_whole((table.cells, table.where)):
            raise Unknown
        if table.cells is not None:
            if outline.renumbered:
                raise Wrong(NUMBERED, "cells")
            return self.numbers(table.cells, len(structure.parts[table.part].cells), "cells")
        if table.where is None:
            return None
        centres = structure.points[structure.parts[table.part].cells].mean(axis=1)
        found = np.flatnonzero(self.inside(table.where, centres))
        return self.needed(found, "where", "no cell has its centroid in the range of where; correct it")

    def lines(self, outline: Outline, table: Any) -> Nodes:
        """Lines as pairs of nodes of the structure, by group of the geometry, or by numbers of nodes, shape (n, 2).

        Raises:
            ValueError: A group has no lines, or lines to nodes that no part uses; numbers are no rows of nodes.
        """
        if outline.renumbered:
            raise ValueError(NUMBERED)
        if not (self.whole and is_whole((table.group, table.cells, table.lines))):
            raise Unknown
        if table.group is None:
            return self.by_hand(table, self.rows)
        rows = self.rows[self.of_groups(table.group, split=False)]
        if rows.shape[1] != 2:
            raise ValueError(f"group {table.group!r} has faces; give one of lines")
        if (rows < 0).any():
            raise ValueError(f"group {table.group!r} has lines to nodes that no part uses; make a part of them")
        return rows

    def node(self, entry: int | str, rows: Nodes, names: Mapping[str, int] | None = None) -> int:
        """Find the number of a node: a number as it is; a name, of those given or of a group of one point.

        Args:
            entry: Number or name.
            rows: Number of each point of the drawing.
            names: Further names.

        Raises:
            ValueError: There is no node of that name, or the group has several.
        """
        if not isinstance(entry, str):
            return entry
        if names and entry in names:
            return names[entry]
        if not self.drawn:
            raise Unknown
        found = rows[nodes_of(self.drawing, entry)]
        if len(found) != 1:
            raise ValueError(f"{entry!r} is the name of {len(found)} nodes; name a single one, or give the group")
        if found[0] < 0:
            if not self.whole:
                raise Unknown
            raise ValueError(f"{entry!r} is a node that no part uses; name another")
        return int(found[0])

    def named(
        self, entries: list[int | str], rows: Nodes, names: Mapping[str, int] | None = None, *keys: str | int
    ) -> list[int]:
        """Find the numbers of several nodes, see `node`; keys lead to them in the table, "nodes" if none are given."""
        found, wrong = [], list[Wrong]()
        for number, entry in enumerate(entries):
            try:
                found.append(self.node(entry, rows, names))
            except Unknown:
                continue
            except ValueError as error:
                wrong.append(Wrong(str(error), *(keys or ("nodes",)), number))
        if wrong:
            raise wrong[0].beside(wrong[1:])
        if len(found) < len(entries):
            raise Unknown
        return found

    def by_hand(self, table: Any, rows: Nodes, names: Mapping[str, int] | None = None) -> Nodes:
        """Rows of nodes of a table that gives them as cells, or as lines of nodes.

        Args:
            table: The table.
            rows: Number of each point of the drawing.
            names: Further names of nodes, with their numbers.

        Raises:
            ValueError: Rows are empty or of different lengths; a name is that of no node.
        """
        key = "cells" if table.lines is None else "lines"
        if not is_whole(getattr(table, key)):
            raise Unknown
        found = [self.named(row, rows, names, key, number) for number, row in enumerate(getattr(table, key) or [])]
        if key == "lines":
            found = [list(pair) for line in found for pair in pairwise(line)]
            if not found:
                raise Wrong("lines are rows of at least two nodes; correct them", key)
        if not found or len(set(map(len, found))) != 1 or not found[0]:
            raise Wrong("cells are rows of nodes, all of one length; correct them", key)
        return np.array(found, dtype=np.int64)

    def of_groups(self, names: str | list[str], split: bool) -> Nodes:
        """Cells of a group, or of several one after the other, as rows of points of the drawing.

        Raises:
            ValueError: A group does not exist, or they are of different kinds.
        """
        found = [triangles_of(self.drawing, name, split) for name in ([names] if isinstance(names, str) else names)]
        if len({cells.shape[1] for cells in found}) != 1:
            raise ValueError(f"groups {names!r} are not of one kind; give some of lines, or some of faces")
        return np.vstack(found)

    def inside(self, box: Box | None, points: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Find the points in a range of places, shape (n,)."""
        found = np.ones(len(points), dtype=bool)
        for axis, ends in enumerate((box.x, box.y, box.z) if box else ()):
            if ends is not None:
                found &= (points[:, axis] >= ends[0] - self._room) & (points[:, axis] <= ends[1] + self._room)
        return found

    def check_part(self, structure: Structure | None, name: Any, wanted: int = 0, key: str = "part") -> None:
        """Refuse a part that does not exist, or of another dimension.

        Args:
            structure: The structure; None if it is not known.
            name: Name of the part.
            wanted: Dimension that it must have; 0 for any.
            key: Key of the table that names it; empty for the table itself.

        Raises:
            ValueError: The file has no part of that name, or one of another dimension, or one that is made later.
            Unknown: It has one, with a fault.
        """
        keys = (key,) if key else ()
        if name is BROKEN or self.kinds is None:
            raise Unknown
        if name not in self.kinds:
            raise Wrong(f"there is no part {name!r}{nearest(name, self.kinds)}", *keys)
        if wanted and self.kinds[name] not in (None, wanted):
            raise Wrong(f"part {name!r} is {'no membrane' if wanted == 2 else 'no cable or mast'}; name one", *keys)
        if structure is None or name not in structure.parts:
            if structure is not None and self.whole and self.formed:
                raise Wrong(f"part {name!r} comes with a later step of form finding; name another", *keys)
            raise Unknown

    @staticmethod
    def numbers(given: list[int], count: int, key: str) -> Nodes:
        """Refuse numbers that are not there.

        Raises:
            ValueError: One is not.
        """
        words = f"is not there; the numbers go from 0 to {count - 1}"
        wrong = [Wrong(f"{n} {words}", key, row) for row, n in enumerate(given) if not 0 <= n < count]
        if wrong:
            raise wrong[0].beside(wrong[1:])
        return np.array(given, dtype=np.int64)

    def needed(self, found: Nodes, key: str, words: str) -> Nodes:
        """Refuse an empty choice.

        Raises:
            ValueError: It is empty.
            Unknown: It is, and so may be because a part has a fault.
        """
        if not len(found):
            raise Wrong(words, key) if self.whole else Unknown
        return found
