"""Forces of slack and wrinkled cells by their compression stiffness, and masts that nothing else holds.

A real cable cannot push and a real fabric carries no compression. A model keeps a fraction of their stiffness, so that
slack nodes stay in place. If an equilibrium hangs on that fraction, the structure has none.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..assembly.part_forms import stiffness
from ..geometry.measures import measures
from ..model.parts import Cable, Mast, Membrane
from ..solvers.lowest_mode import WEAK
from .states import BarResult, MembraneResult, StageResult

Array = NDArray[np.float64]

LIMIT = 0.01  # fraction of the largest force of its kind, above which compression of slack parts holds the structure
SEEN = 1e-9  # strain below which a compression is rounding


class Push(NamedTuple):
    """Slack or wrinkled parts of one kind that carry more than the fraction `LIMIT` of their largest force.

    Attributes:
        compression: The most compressed cell of each part, and its compression [N or N/m].
        largest: Largest force of cables and masts [N], or largest principal stress of membranes [N/m].
        nodes: Nodes that these parts hold, the one with the largest force first.
    """

    compression: dict[str, tuple[int, float]]
    largest: float
    nodes: NDArray[np.int64]


class Loose(NamedTuple):
    """Mast node that only slack cells could hold: its free direction, shape (3,)."""

    node: int
    direction: Array


def pushes(result: StageResult) -> list[Push]:
    """List the parts that carry a structure though slack or wrinkled: at most one entry for bars, one for membranes.

    Compression within a part, or between constrained nodes, carries nothing: the forces of its cells must leave a net
    force on a free node.
    """
    return [found for kind in (BarResult, MembraneResult) if (found := _push(result, kind))]


def _push(result: StageResult, kind: type[BarResult] | type[MembraneResult]) -> Push | None:
    names = [name for name, part in result.parts.items() if isinstance(part, kind)]
    if not names:
        return None
    compressions = {name: _compression(result, name) for name in names}
    largest = max(_largest(result, name) for name in names)
    carrying = {
        name: (int(values.argmax()), float(values.max()))
        for name, values in compressions.items()
        if values.max() > max(LIMIT * largest, _rounding(result, name))
    }
    nodal, strongest = np.zeros(result.displacement.shape), 0.0
    for name in names:
        kept, others = _corner_forces(result, name)
        strongest = max(strongest, float(np.linalg.norm(others, axis=2).max()))
        np.add.at(nodal, result.structure.parts[name].cells, kept)
    net = np.linalg.norm(np.where(result.actions.held, 0.0, nodal), axis=1)
    nodes = np.flatnonzero(net > LIMIT * strongest)
    if not carrying or not len(nodes):
        return None
    return Push(carrying, largest, nodes[np.argsort(-net[nodes], kind="stable")])


def loose_masts(result: StageResult) -> list[Loose]:
    """Nodes of masts that only slack cells could hold in some direction.

    A node counts if it gives way while all nodes beside it stand still. Without slack cells the list is empty: solvers
    detect the missing stiffness themselves. If every part is without force, as before any load, cables count as
    holding.
    """
    structure = result.structure
    masts, slack, held, pressed = (np.zeros(len(structure.points), dtype=bool) for _ in range(4))
    blocks = np.zeros((len(structure.points), 3, 3))
    for name, part in structure.parts.items():
        loose = slack_cells(result, name)
        slack[part.cells[loose]] = True
        pressed[part.cells[_compression(result, name) > _rounding(result, name)]] = True
        if isinstance(part, Membrane):
            held[part.cells[~loose]] = True
            continue
        blocks_here = np.where(loose[:, None, None], 0.0, _bar_tangent(result, name))
        np.add.at(blocks, part.cells, blocks_here[:, None])
        if isinstance(part, Mast):
            masts[part.cells] = True
            pressed[part.cells[result.mast(name).force < -SEEN * part.axial_stiffness * LIMIT]] = True
    nodes = np.flatnonzero(masts & slack & pressed & ~held & ~result.actions.held.all(axis=1))
    free = ~result.actions.held[nodes]
    own = blocks[nodes] * (free[:, :, None] & free[:, None, :])
    scale = np.abs(own).max(axis=(1, 2), initial=0.0)
    own[:, range(3), range(3)] += np.where(free, 0.0, scale[:, None])
    values, directions = np.linalg.eigh(own)
    return [Loose(int(nodes[i]), directions[i, :, 0]) for i in np.flatnonzero(values[:, 0] <= WEAK * scale)]


def slack_cells(result: StageResult, name: str) -> NDArray[np.bool_]:
    """Cells of a part without tension, shape (cells,)."""
    part = result.parts[name]
    return part.slack if isinstance(part, BarResult) else part.state == "slack"


def _compression(result: StageResult, name: str) -> Array:
    """Largest compression of each slack or wrinkled cell, shape (cells,) [N or N/m]; 0 in others and in masts."""
    part = result.parts[name]
    if isinstance(part, BarResult):
        return np.where(part.slack, np.maximum(-part.force, 0.0), 0.0)
    return np.where(part.state == "taut", 0.0, np.maximum(-part.principal[:, 1], 0.0))


def _largest(result: StageResult, name: str) -> float:
    part = result.parts[name]
    return float((np.abs(part.force) if isinstance(part, BarResult) else part.principal[:, 0]).max())


def _rounding(result: StageResult, name: str) -> float:
    """Compression at rounding [N or N/m]."""
    part = result.structure.parts[name]
    kept = part.compression_stiffness if isinstance(part, Cable | Membrane) else 1.0
    return SEEN * kept * stiffness(part)


def _corner_forces(result: StageResult, name: str) -> tuple[Array, Array]:
    """Corner forces of the cells of a part, of compression and of the other stresses, (cells, corners, 3) [N]."""
    part, x = result.parts[name], result.position[result.structure.parts[name].cells]
    if isinstance(part, BarResult):
        way = x[:, 1] - x[:, 0]
        direction = way / np.maximum(np.linalg.norm(way, axis=1), 1e-300)[:, None]
        unit = np.stack([direction, -direction], axis=1)
        kept = -_compression(result, name)
        return kept[:, None, None] * unit, (part.force - kept)[:, None, None] * unit
    values, directions = np.linalg.eigh(part.cauchy)
    pressed = np.where((part.state == "taut")[:, None], 0.0, np.minimum(values, 0.0))
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
    # The stress times half the length of the opposite side, across it, acts on a corner.
    across = np.cross(normal[:, None], np.roll(x, -2, axis=1) - np.roll(x, -1, axis=1)) / 2

    def forces(principal: Array) -> Array:
        stress = (directions * principal[:, None, :]) @ directions.transpose(0, 2, 1)
        return across @ stress

    return forces(pressed), forces(values - pressed)


def _bar_tangent(result: StageResult, name: str) -> Array:
    """Stiffness of each cable or mast at one end while the other is fixed, shape (cells, 3, 3) [N/m]."""
    part, state = result.structure.parts[name], result.parts[name]
    assert isinstance(state, BarResult)
    assert not isinstance(part, Membrane)
    x = result.position[part.cells]
    way = x[:, 1] - x[:, 0]
    along = part.axial_stiffness / measures(result.structure.points, part.cells) ** 3
    across = state.force / np.maximum(np.linalg.norm(way, axis=1), 1e-300)
    dyads = way[:, :, None] * way[:, None, :]
    return across[:, None, None] * np.eye(3) + along[:, None, None] * dyads
