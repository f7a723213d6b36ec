"""Forces that slack and wrinkled cells carry by the small stiffness they keep.

A real cable cannot push and a real fabric carries no compression. A model keeps a fraction of their stiffness, so that
slack nodes stay in place. If an equilibrium hangs on that fraction, the structure has none.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..assembly.forms_of_parts import stiffness
from ..geometry.extremes import TIE, first_largest
from ..geometry.sizes import lengths
from ..model.parts import Mast
from ..model.structure import Structure
from .part_results import MembraneResult
from .pieces import Pieces
from .states import StageResult

Array = NDArray[np.float64]

LIMIT = 0.01  # share of the forces of a piece, above which compression of slack parts holds the structure
COMPRESSION_ROUNDING = 1e-9  # strain below which a compression is rounding


class Push(NamedTuple):
    """Slack or wrinkled parts of one kind that hold nodes by their compression.

    Attributes:
        compression: Of each part, its most compressed cell at these nodes and its compression [N or N/m].
        largest: Largest force of cables and masts [N], or largest principal stress of membranes [N/m], in
            the cells at these nodes.
        nodes: Nodes that these parts hold, the one with the largest force first.
    """

    compression: dict[str, tuple[int, float]]
    largest: float
    nodes: NDArray[np.int64]


def pushes(result: StageResult) -> list[Push]:
    """List the parts that carry a structure though slack or wrinkled: at most one entry for bars, one for membranes.

    Compression that a part takes up within itself, or between held nodes, carries nothing: the forces of its cells must
    leave a net force on a node that is free. At the end of a mast that counts where it is above `LIMIT` of the largest
    force there. At other nodes of cables it is compared with the largest force in the same piece; what is not connected
    hides nothing. Other nodes of membranes count where it carries more than half of their load. That must be above
    `LIMIT` of the loads of the piece: folds of too much fabric that hangs push each other aside, and carry nothing.
    """
    names, held = list(result.parts), result.actions.held
    if not any(compression(result, name).any() for name in names):
        return []
    pieces = Pieces(result.structure, held.all(axis=1))
    forces = {name: _corner_forces(result, name) for name in names}
    at_node = lengths(np.where(held, 0.0, result.loads))
    for name, (_, others) in forces.items():
        np.maximum.at(at_node, result.structure.parts[name].cells, lengths(others))
    found, bars = [], result.bars
    for kind in (bars, result.membranes):
        here = {name: forces[name] for name in kind}
        net = np.zeros(held.shape)
        for name, (kept, _) in here.items():
            np.add.at(net, result.structure.parts[name].cells, kept)
        net[held] = 0.0
        size = lengths(net)
        carried = _strong(here, size, pieces) if kind is bars else _carried_loads(result, net, pieces)
        nodes = np.flatnonzero(np.where(_mast_ends(result.structure), size > LIMIT * at_node, carried))
        largest = size[nodes].max(initial=0.0)
        order = np.argsort(-np.round(size[nodes] / (TIE * largest or 1.0)), kind="stable")
        if push := _push(result, list(here), nodes[order]):
            found.append(push)
    return found


def _strong(forces: dict[str, tuple[Array, Array]], size: Array, pieces: Pieces) -> NDArray[np.bool_]:
    """Nodes at which the net force, shape (n,) [N], is large beside the others of its piece, shape (n,)."""
    largest = np.zeros(pieces.count)
    for name, (_, others) in forces.items():
        np.maximum.at(largest, pieces.cells[name], lengths(others).max(axis=1))
    return np.asarray(size > LIMIT * largest[pieces.nodes])


def _carried_loads(result: StageResult, net: Array, pieces: Pieces) -> NDArray[np.bool_]:
    """Nodes whose net forces, shape (n, 3) [N], carry most of a load that is much in their piece, (n,)."""
    loads = np.where(result.actions.held, 0.0, result.loads)
    load = lengths(loads)
    against = -(net * loads).sum(axis=1) / np.maximum(load, 1e-300)
    most = against > load / 2
    of_piece = np.bincount(pieces.nodes, load, pieces.count)
    much = np.bincount(pieces.nodes[most], against[most], pieces.count) > LIMIT * of_piece
    return np.asarray(most & much[pieces.nodes])


def _push(result: StageResult, names: list[str], nodes: NDArray[np.int64]) -> Push | None:
    """Find forces that parts of one kind carry at nodes by compression; None at rounding."""
    found, largest = {}, 0.0
    for name in names:
        there = np.isin(result.structure.parts[name].cells, nodes).any(axis=1)
        values = np.where(there, compression(result, name), 0.0)
        if values.max() > rounding(result, name):
            found[name] = (first_largest(values), float(values.max()))
        largest = max(largest, float(_sizes(result, name)[there].max(initial=0.0)))
    return Push(found, largest, nodes) if found else None


def _mast_ends(structure: Structure) -> NDArray[np.bool_]:
    """Nodes at which a mast ends, shape (n,)."""
    ends = np.zeros(len(structure.points), dtype=bool)
    for mast in structure.parts_of(Mast).values():
        ends[mast.cells] = True
    return ends


def compression(result: StageResult, name: str) -> Array:
    """Largest compression of each slack or wrinkled cell, shape (cells,) [N or N/m]; 0 in others and in masts."""
    part = result.parts[name]
    return np.where(part.taut, 0.0, np.maximum(-part.principal[:, -1], 0.0))


def _sizes(result: StageResult, name: str) -> Array:
    """Force of each cable or mast [N], or largest principal stress of each cell of a membrane [N/m], shape (cells,)."""
    return np.abs(result.bars[name].force) if name in result.bars else result.membranes[name].principal[:, 0]


def rounding(result: StageResult, name: str) -> float:
    """Compression that is rounding [N or N/m]."""
    part = result.structure.parts[name]
    kept = 1.0 if part.carries_compression else part.compression_stiffness
    return COMPRESSION_ROUNDING * kept * stiffness(part)


def _corner_forces(result: StageResult, name: str) -> tuple[Array, Array]:
    """Corner forces of the cells of a part, of compression and of the other stresses, (cells, corners, 3) [N]."""
    x = result.position[result.structure.parts[name].cells]
    if name in result.bars:
        way = x[:, 1] - x[:, 0]
        direction = way / np.maximum(np.linalg.norm(way, axis=1), 1e-300)[:, None]
        unit = np.stack([direction, -direction], axis=1)
        kept = -compression(result, name)
        return kept[:, None, None] * unit, (result.bars[name].force - kept)[:, None, None] * unit
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    # Across the side opposite to a corner, half its length times the stress acts on the corner.
    across = np.cross(np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1), normal[:, None]) / 2

    part = result.membranes[name]
    pressed = _pressed(part, normal)
    return across @ pressed, across @ (part.cauchy - pressed)


def _pressed(part: MembraneResult, normal: Array) -> Array:
    """Compressive part of the Cauchy stress of slack and wrinkled cells, shape (cells, 3, 3) [N/m]; 0 in taut ones."""
    larger, smaller = part.principal.T
    loose = part.state != "taut"
    pressed = np.where((loose & (larger <= 0))[:, None, None], part.cauchy, 0.0)
    one = np.flatnonzero(loose & (larger > 0) & (smaller < 0))
    n, s1, s2 = normal[one], larger[one, None, None], smaller[one, None, None]
    plane = np.eye(3) - n[:, :, None] * n[:, None, :]
    pressed[one] = s2 * (s1 * plane - part.cauchy[one]) / (s1 - s2)  # Sylvester's formula
    return pressed
