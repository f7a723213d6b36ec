"""Cells under the water of a pond or a basin, and the level of an amount on them.

Each process sums over cells of its own. The integrals are exact, see `geometry.water_on_triangles`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..geometry import water_on_triangles as water
from .discretization import Discretization
from .node_values import NodeValues

Array = NDArray[np.float64]

MAX_LEVEL_STEPS = 200
EQUAL_VOLUMES = 1e-15  # relative difference of volumes at which the search for a level ends
VOLUME_ROUNDING = 1e-13  # relative difference of volumes that is rounding


class Water(NamedTuple):
    """State of the water.

    Attributes:
        level: Its height [m]; minus infinity without water.
        volume: Its volume [m3].
        area: Wet area in plan [m2].
        is_capped: True at the height of an outlet.
        outlet: Position of that outlet among those of the pond; -1 if it is not capped.
    """

    level: float
    volume: float
    area: float
    is_capped: bool
    outlet: int = -1


DRY = Water(-np.inf, 0.0, 0.0, False)


@dataclass(frozen=True, eq=False)
class Places:
    """Shape of the cells of this process.

    Attributes:
        corners: Corners of the cells, shape (cells, 3, 3) [m].
        exits: Heights of all outlets, shape (k,) [m].
        known: Water of the amounts that were asked for; of an infinite one that up to the lowest outlet.
    """

    corners: Array
    exits: Array
    known: dict[float, Water] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class PondCells:
    """Cells of a pond or of a basin, with its outlets; methods are collective.

    Attributes:
        discretization: The numbering.
        triangles: Its cells, upwards, shape (k, 3).
        outlets: Nodes over which water runs off at their present height, shape (k,): outlets of a basin, or drains.
        rim: Height of a rim that does not move, over which water runs off, too [m].
    """

    discretization: Discretization
    triangles: NDArray[np.int64]
    outlets: NDArray[np.int64]
    rim: float = np.inf
    _last: list[Places] = field(default_factory=list, repr=False)

    @cached_property
    def _cells(self) -> tuple[NodeValues, NDArray[np.intp], NDArray[np.intp]]:
        """Nodes of the cells of this process and of all outlets, and the positions of both in them."""
        mine = np.zeros(len(self.discretization.structure.points), dtype=bool)
        mine[self.discretization.owned_nodes] = True
        own = self.triangles[mine[self.triangles[:, 0]]]
        nodes, places = np.unique(np.concatenate([own.ravel(), self.outlets]), return_inverse=True)
        places = places.ravel()
        return NodeValues(self.discretization, nodes), places[: own.size].reshape(-1, 3), places[own.size :]

    def places(self, x: PETSc.Vec) -> Places:
        """Shape for a displacement; the last one, with its known water, if no node has moved since."""
        nodes, cells, exits = self._cells
        positions = nodes.positions(x)
        corners, heights = np.asarray(positions[cells]), positions[exits, 2]
        for last in self._last:
            same = np.array_equal(corners, last.corners) and np.array_equal(heights, last.exits)
            if self.discretization.comm.allreduce(same, MPI.LAND):
                return last
        self._last[:] = [Places(corners, heights)]
        return self._last[0]

    def full(self, at: Places) -> Water:
        """Water up to the lowest outlet; none of infinite volume if there is no outlet."""
        if np.inf not in at.known:
            at.known[np.inf] = self._full(at)
        return at.known[np.inf]

    def _full(self, at: Places) -> Water:
        lowest = float(at.exits.min(initial=np.inf))
        cap = min(lowest, self.rim)
        if not np.isfinite(cap):
            return Water(cap, np.inf, np.nan, False)
        outlet = int(at.exits.argmin()) if lowest < self.rim else -1
        return self.filled(at, cap)._replace(is_capped=True, outlet=outlet)

    def filled(self, at: Places, level: float) -> Water:
        """Water up to a level."""
        volume, area = water.volumes(at.corners, level)
        sums = self.discretization.comm.allreduce(np.array([volume.sum(), area.sum()]))
        return Water(level, float(sums[0]), float(sums[1]), False)

    def holding(self, at: Places, amount: float) -> Water:
        """Water of an amount, of which what is above the lowest outlet runs off [m3]."""
        if amount not in at.known:
            at.known[amount] = self._holding(at, amount)
        return at.known[amount]

    def _holding(self, at: Places, amount: float) -> Water:
        if not (amount > 0 and np.isfinite(self.sum(at.corners))):
            return DRY
        full = self.full(at)
        if full.volume <= amount * (1 + VOLUME_ROUNDING):  # as a basin that is full
            return full
        return self._level(at, amount, full.level)

    def add(self, values: Array, b: PETSc.Vec, outlet: int = -1, height: float = 0.0) -> None:
        """Add values at the corners of the cells, shape (cells, 3, 3), and at the height of an outlet, to a vector."""
        nodes, cells, exits = self._cells
        sums = np.zeros_like(nodes.points)
        np.add.at(sums, cells, values)
        if outlet >= 0 and self.discretization.comm.rank == 0:  # on all processes together
            sums[exits[outlet], 2] += height
        nodes.add(sums, b)

    def add_matrix(self, blocks: Array, A: PETSc.Mat) -> None:
        """Add second derivatives by the corners of the cells, shape (cells, 3, 3, 3, 3), to a tangent."""
        nodes, cells, _ = self._cells
        rows, columns = np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, 3).ravel()
        nodes.add_blocks(A, rows, columns, blocks.transpose(0, 1, 3, 2, 4).reshape(-1, 3, 3))

    def add_capacity_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Add the derivative of the volume up to the lowest outlet to a vector [m2]."""
        at = self.places(x)
        full = self.full(at)
        self.add(water.volume_gradients(at.corners, full.level), b, full.outlet, full.area)

    def sum(self, values: Array) -> float:
        """Sum of values over all processes."""
        return float(self.discretization.comm.allreduce(float(values.sum())))

    def _level(self, at: Places, amount: float, cap: float) -> Water:
        """Level of an amount, by Newton's method on a convex function of the level, from above and from its bottom."""
        comm = self.discretization.comm
        heights = at.corners[:, :, 2]
        low = -float(max(comm.allgather(float((-heights).max(initial=-np.inf)))))
        high = float(max(comm.allgather(float(heights.max(initial=-np.inf)))))
        plan = self.sum(water.plan_areas(at.corners))
        high = min(cap, high + amount / max(plan, 1e-300)) if plan > 0 else cap
        found = self.filled(at, high)
        for _ in range(MAX_LEVEL_STEPS):
            over = found.volume - amount
            if abs(over) <= EQUAL_VOLUMES * amount:
                break
            if over > 0:
                high = found.level
            else:
                low = found.level
            level = found.level - over / found.area if found.area > 0 else np.nan
            level = level if low < level < high else (low + high) / 2
            if level in (low, high, found.level):
                break
            found = self.filled(at, level)
        return found
