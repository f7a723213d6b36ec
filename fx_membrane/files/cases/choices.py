"""Nodes and cells that tables of a case choose: by number, by group of the geometry, by place, or by a rim."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ... import Form
from ...geometry.topology import boundary_edges
from ...model.parts import Membrane
from ...model.structure import Structure
from ..drawing import Drawing, nodes_of, triangles_of
from .faults import Unknown, nearest
from .load_schema import CellChoice
from .structure_schema import BROKEN, Box, Model, NodeChoice

Nodes = NDArray[np.int64]
CHOICES = ("nodes", "group", "where", "rim_of")
NEAR = 1e-9  # of the size of the structure: a place within it of a range is in the range
NUMBERED = "after a new mesh there are other numbers; choose by where, or by rim_of"


class Outline(NamedTuple):
    """A structure between the steps of form finding.

    Attributes:
        structure: The structure.
        form: The form that it has; None before the first.
        renumbered: True after a new mesh, whose nodes and cells have other numbers than the file knows.
    """

    structure: Structure
    form: Form | None = None
    renumbered: bool = False


class Choices:
    """Choices of nodes and cells.

    Args:
        drawing: Content of the geometry.
        names: Names of the parts that the file has; those with faults may be missing in the structure.

    Attributes:
        rows: Node of the structure for each point of the drawing, -1 for a point of no part, shape (points,).
        whole: False if some part has a fault, so that numbers of nodes are not known.
    """

    def __init__(self, drawing: Drawing, names: set[str]):
        self.drawing, self._names = drawing, names
        self.rows = np.full(len(drawing.points), -1)
        self.whole = True
        self._room = NEAR * float(np.ptp(drawing.points, axis=0).max(initial=0.0)) if len(drawing.points) else 0.0

    def nodes(self, outline: Outline, table: NodeChoice) -> Nodes:
        """Choose nodes.

        Raises:
            ValueError: Not one way of the four is given; a group, a membrane or a node does not exist.
            Unknown: It depends on a table that has a fault.
        """
        one_of(table, *CHOICES, needed=True)
        structure = outline.structure
        if outline.renumbered and (table.nodes is not None or table.group is not None):
            raise ValueError(NUMBERED)
        if table.nodes is not None:
            if not self.whole:
                raise Unknown
            numbers = [self.node(entry, self.rows) for entry in table.nodes]
            return self._numbers(numbers, len(structure.points), "nodes")
        if table.group is not None:
            rows = self.rows[nodes_of(self.drawing, table.group)]
            return self.needed(rows[rows >= 0], f"no part uses a node of group {table.group!r}")
        if table.rim_of is not None:
            self.check_part(structure, table.rim_of)
            return np.unique(boundary_edges(structure.part(table.rim_of, Membrane).cells))
        found = np.flatnonzero(self.inside(table.where, structure.points) & structure.used)
        return self.needed(found, "no node is in the range of where; correct it")

    def cells(self, outline: Outline, table: CellChoice) -> Nodes | None:
        """Choose cells of a part; None for all.

        Raises:
            ValueError: Two ways are given; there is no such part, or no cell.
            Unknown: It depends on a table that has a fault.
        """
        one_of(table, "cells", "where")
        structure = outline.structure
        self.check_part(structure, table.part)
        if table.cells is not None:
            if outline.renumbered:
                raise ValueError(NUMBERED)
            return self._numbers(table.cells, len(structure.parts[table.part].cells), "cells")
        if table.where is None:
            return None
        centres = structure.points[structure.parts[table.part].cells].mean(axis=1)
        found = np.flatnonzero(self.inside(table.where, centres))
        return self.needed(found, "no cell has its centroid in the range of where; correct it")

    def lines(self, outline: Outline, table: Any) -> Nodes:
        """Lines as pairs of nodes of the structure, by group of the geometry, or by numbers of nodes, shape (n, 2).

        Raises:
            ValueError: A group has no lines, or lines to nodes that no part uses; numbers are no rows of nodes.
        """
        if outline.renumbered:
            raise ValueError(NUMBERED)
        if not self.whole:
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
        found = rows[nodes_of(self.drawing, entry)]
        if len(found) != 1:
            raise ValueError(f"{entry!r} is the name of {len(found)} nodes; name a single one, or give the group")
        if found[0] < 0:
            raise ValueError(f"{entry!r} is a node that no part uses; name another")
        return int(found[0])

    def by_hand(self, table: Any, rows: Nodes, names: Mapping[str, int] | None = None) -> Nodes:
        """Rows of nodes of a table that gives them as cells, or as lines of nodes.

        Args:
            table: The table.
            rows: Number of each point of the drawing.
            names: Further names of nodes, with their numbers.

        Raises:
            ValueError: Rows are empty or of different lengths; a name is that of no node.
        """
        given_rows = table.lines if table.lines is not None else table.cells or []
        found = [[self.node(entry, rows, names) for entry in row] for row in given_rows]
        if table.lines is not None:
            found = [list(pair) for line in found for pair in pairwise(line)]
            if not found:
                raise ValueError("lines are rows of at least two nodes; correct them")
        if not found or len(set(map(len, found))) != 1 or not found[0]:
            raise ValueError("cells are rows of nodes, all of one length; correct them")
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

    def check_part(self, structure: Structure, name: str) -> None:
        """Refuse a part that does not exist.

        Raises:
            ValueError: The file has no part of that name.
            Unknown: It has one, with a fault.
        """
        if name not in structure.parts:
            if name in self._names:
                raise Unknown
            raise ValueError(f"there is no part {name!r}{nearest(name, structure.parts)}")

    @staticmethod
    def _numbers(given: list[int], count: int, what: str) -> Nodes:
        wrong = [number for number in given if not 0 <= number < count]
        if wrong:
            raise ValueError(f"{what} has {wrong[0]}; the numbers go from 0 to {count - 1}")
        return np.array(given, dtype=np.int64)

    @staticmethod
    def needed(found: Nodes, words: str) -> Nodes:
        """Refuse an empty choice.

        Raises:
            ValueError: It is empty.
        """
        if not len(found):
            raise ValueError(words)
        return found


def given(table: Model, *without: str) -> dict[str, Any]:
    """Values that a table gives, apart from some keys: the package has the defaults."""
    return {name: getattr(table, name) for name in table.model_fields_set if name not in without}


def one_of(table: Any, *keys: str, needed: bool = False) -> None:
    """Refuse a table that gives several of some keys, or none.

    Raises:
        ValueError: It does.
    """
    found = [key for key in keys if getattr(table, key) is not None]
    if len(found) > 1 or (needed and not found):
        raise ValueError(f"give one of {', '.join(keys)}" + (f", not {' and '.join(found)}" if found else ""))


def sound(tables: Any) -> Any:
    """Entries of a dictionary, or numbered ones of a list, that have no fault of their own."""
    items = tables.items() if isinstance(tables, dict) else enumerate(tables)
    return [(name, table) for name, table in items if table is not BROKEN]
