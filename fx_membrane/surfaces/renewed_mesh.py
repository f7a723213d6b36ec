"""Nodes and cells of a structure on another mesh of its membranes."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import lengths
from ..geometry.topology import boundary_edges
from ..model.parts import Membrane, Part
from ..model.structure import Structure
from .feature_lines import Division, Features, divided, features
from .flattening import Flat
from .patch_plan import check_plan, flat_of, graded, ordered
from .plan_mesh import PlanSegments, triangulated
from .transfer import at_nodes, between, main_direction, rise_of_line, rise_of_surface

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class NewMesh(NamedTuple):
    """New mesh, and the data of the parts on it.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        nodes: New number of each old node, or -1, shape (old nodes,).
        cells: New cells of each part.
        prestress: Prestress of each part per cell, as its class takes it; none where that of the part remains.
        warp: Warp of each membrane per cell, where the part has one per cell.
        supports: New nodes of each support.
    """

    points: Array
    nodes: Integers
    cells: dict[str, Integers]
    prestress: dict[str, Array]
    warp: dict[str, Array]
    supports: list[Integers]


class _Nodes:
    """New nodes, each in an old cell of one to three nodes."""

    def __init__(self, old: Array) -> None:
        self.old, self.count = old, 0
        self.corners: list[Integers] = []
        self.shares: list[Array] = []
        self.rises: list[Array] = []

    def add(self, corners: Integers, shares: Array, rise: Array | float = 0.0) -> Integers:
        """Add nodes in old cells, shape (k, up to 3), at some shares of their corners; return their numbers.

        The rise leads from the flat cell to the node, shape (k, 3).
        """
        missing = 3 - corners.shape[1]
        self.corners.append(np.concatenate([corners, np.repeat(corners[:, :1], missing, axis=1)], axis=1))
        self.shares.append(np.concatenate([shares, np.zeros((len(shares), missing))], axis=1))
        self.rises.append(np.broadcast_to(rise, (len(corners), 3)))
        self.count += len(corners)
        return np.arange(self.count - len(corners), self.count)

    def all(self) -> tuple[Integers, Array]:
        """Old corners and shares of all, both of shape (count, 3)."""
        return np.concatenate(self.corners), np.concatenate(self.shares)

    @property
    def points(self) -> Array:
        """Positions, shape (count, 3) [m]."""
        corners, shares = self.all()
        return between(self.old, corners, shares) + np.concatenate(self.rises)


class _Line(NamedTuple):
    """New nodes along a line, their numbers, and their places along the old one."""

    nodes: Integers
    division: Division


def new_mesh(structure: Structure, size: Callable[[Array], Array], keep: Integers) -> NewMesh:
    """Mesh the membranes of a structure anew.

    Args:
        structure: The structure.
        size: Wanted size at places, shape (k, 3) to (k,) [m].
        keep: Nodes that stay, shape (k,).

    Raises:
        ValueError: A membrane is closed, folds in its plan, or the size is too large for its lines.
    """
    found = features(structure, keep)
    nodes, number = _Nodes(structure.points), np.full(len(structure.points), -1, dtype=np.int64)
    number[found.nodes] = nodes.add(found.nodes[:, None], np.ones((len(found.nodes), 1)))
    lines = [_line(structure.points, line, size, nodes, number) for line in found.lines]
    cells: dict[str, Integers] = {}
    prestress: dict[str, Array] = {}
    warp: dict[str, Array] = {}
    pieces: dict[str, list[_Piece]] = {}
    plans = [_plan(structure, found, index, lines, nodes, size) for index in range(len(found.patches))]
    for plan, mesh in zip(plans, triangulated([plan.segments for plan in plans]), strict=True):
        pieces.setdefault(plan.part, []).append(_piece(structure, plan, nodes, *mesh))
    for name, of_part in pieces.items():
        membrane = structure.part(name, Membrane)
        cells[name] = np.concatenate([piece.cells for piece in of_part])
        if np.ndim(membrane.prestress) > 1 and np.shape(membrane.prestress) != (2, 2):
            prestress[name] = np.concatenate([piece.stress for piece in of_part])
        if membrane.warp is not None and np.ndim(membrane.warp) == 2:
            warp[name] = np.concatenate([piece.warp for piece in of_part])
    for name, part in structure.bars.items():
        cells[name], forces = _bar(structure.points, part, found, name, lines, number)
        if np.ndim(part.prestress):
            prestress[name] = forces
    return NewMesh(nodes.points, number, cells, prestress, warp, _supports(structure, nodes))


def _line(points: Array, line: Integers, size: Callable[[Array], Array], nodes: _Nodes, number: Integers) -> _Line:
    division = divided(points[line], size)
    edge, share = division.edge[1:-1], division.share[1:-1]
    corners, shares = np.stack([edge, edge + 1], axis=1), np.stack([1 - share, share], axis=1)
    within = nodes.add(line[corners], shares, rise_of_line(points[line], corners, shares))
    return _Line(np.concatenate([number[line[:1]], within, number[line[-1:]]]), division)


def _bar(
    points: Array, part: Part, found: Features, name: str, lines: list[_Line], number: Integers
) -> tuple[Integers, Array]:
    """Cells of a bar and their forces, interpolated along each line between the middles of its old cells."""
    force = part.prestress_tensors().ravel()
    cells, forces = [number[part.cells[found.loose[name]]]], [force[found.loose[name]]]
    for old, owners, line in zip(found.lines, found.owners, lines, strict=True):
        if ("bar", name) not in owners:
            continue
        rows = [
            found.bars[name][min(edge), max(edge)] for edge in zip(old[:-1].tolist(), old[1:].tolist(), strict=True)
        ]
        length = lengths(np.diff(points[old], axis=0))
        before = np.append(0.0, np.cumsum(length))
        at = before[line.division.edge] + line.division.share * length[line.division.edge]
        period = before[-1] if old[0] == old[-1] else None
        middles = (at[1:] + at[:-1]) / 2, (before[1:] + before[:-1]) / 2
        cells.append(np.column_stack([line.nodes[:-1], line.nodes[1:]]))
        forces.append(np.interp(*middles, force[rows], period=period))
    return np.concatenate(cells), np.concatenate(forces)


def _supports(structure: Structure, nodes: _Nodes) -> list[Integers]:
    """Find the new nodes of each support: those in old cells that it holds at all corners."""
    corners, shares = nodes.all()
    rim = np.zeros(len(structure.points), dtype=bool)
    for part in structure.membranes.values():
        rim[boundary_edges(part.cells)] = True
    within = (shares > 0).all(axis=1)  # of a triangle
    between_edges = within & rim[corners].all(axis=1)  # a corner of the rim, whose edges are held
    found = []
    for support in structure.supports:
        held = np.zeros(len(structure.points), dtype=bool)
        held[np.asarray(support.nodes)] = True
        found.append(np.flatnonzero((held[corners] | (shares == 0)).all(axis=1) & ~between_edges))
    return found


class _Plan(NamedTuple):
    """Patch in its plan.

    Attributes:
        part: Name of its membrane.
        rows: Cells of the membrane, shape (k,).
        old: Old nodes of the patch, ascending.
        flat: Its old cells in the plan.
        used: New nodes on its lines and alone, the first points of its segments.
        segments: Segments of the plan.
    """

    part: str
    rows: Integers
    old: Integers
    flat: Flat
    used: Integers
    segments: PlanSegments


class _Piece(NamedTuple):
    """New cells of a patch, with stress in the frame of warp and weft, and warp."""

    cells: Integers
    stress: Array
    warp: Array


def _plan(
    structure: Structure,
    found: Features,
    index: int,
    lines: list[_Line],
    nodes: _Nodes,
    size: Callable[[Array], Array],
) -> _Plan:
    """Lay a patch out in its plan, with the new nodes on its lines."""
    patch = found.patches[index]
    part = structure.part(patch.part, Membrane)
    old, local = np.unique(part.cells[patch.rows], return_inverse=True)
    triangles, points = local.reshape(-1, 3), structure.points[old]
    flat = flat_of(patch.part, points, triangles)
    used, segments, loops = _segments(found, index, part.cells[patch.rows], lines, nodes)
    corners, shares = nodes.all()
    places = between(flat.points, np.searchsorted(old, corners[used]), shares[used])
    wanted = graded(points, size(points), nodes.points[used[segments]]) * flat.scale
    plan = PlanSegments(
        places,
        *ordered(patch.part, places, nodes.points[used], segments, loops),
        np.full(len(used), wanted.max()),
        float(wanted.max()),
        (flat.points, triangles, wanted),
        f"the plan of part {patch.part!r}",
    )
    check_plan(patch.part, plan, nodes.points[used])
    return _Plan(patch.part, patch.rows, old, flat, used, plan)


def _piece(structure: Structure, plan: _Plan, nodes: _Nodes, new_places: Array, cells: Integers) -> _Piece:
    """Take the mesh of a plan back to the surface."""
    part, flat, rows, used = structure.part(plan.part, Membrane), plan.flat, plan.rows, plan.used
    triangles, points = flat.triangles, structure.points[plan.old]
    cell, shares = flat.locate(new_places[len(used) :])
    rise = rise_of_surface(points, triangles, cell, shares)
    within = nodes.add(plan.old[triangles[cell]], shares, rise)
    where, shares = flat.locate(new_places[cells].mean(axis=1))
    stress = at_nodes(flat.points, triangles, np.asarray(part.prestress_tensors())[rows])
    warp = structure.warp(plan.part)[rows]
    lines_of_warp = at_nodes(flat.points, triangles, warp[:, :, None] * warp[:, None, :])
    sense = between(at_nodes(flat.points, triangles, warp), triangles[where], shares)
    direction = main_direction(between(lines_of_warp, triangles[where], shares))
    direction *= np.where(np.sum(direction * sense, axis=1) < 0, -1.0, 1.0)[:, None]
    return _Piece(np.concatenate([used, within])[cells], between(stress, triangles[where], shares), direction)


def _segments(
    found: Features, index: int, cells: Integers, lines: list[_Line], nodes: _Nodes
) -> tuple[Integers, Integers, Integers]:
    """Nodes of a patch on its lines and alone, segments as rows of them, and 0 at the rim, -1 elsewhere."""
    edges = {tuple(sorted(edge)) for side in ([0, 1], [1, 2], [2, 0]) for edge in cells[:, side].tolist()}
    segments, loops = [], []
    for old, owners, line in zip(found.lines, found.owners, lines, strict=True):
        if tuple(sorted(old[:2].tolist())) in edges:
            segments.append(np.column_stack([line.nodes[:-1], line.nodes[1:]]))
            loops += [0 if ("rim", index) in owners else -1] * (len(line.nodes) - 1)
    rows = np.concatenate(segments)
    alone = np.flatnonzero(np.isin(found.nodes, cells))  # kept nodes have the first numbers
    used = np.union1d(rows, alone)
    return used, np.searchsorted(used, rows), np.array(loops)
