"""Energy of water on a membrane: a given level, or a volume whose level follows from the shape.

With W(u, h) the integral of half the square of the depth below the level h, and g the specific weight,

    given level:    E = -g W(u, h),                        dE = -g W_u
    given volume:   E = max over h of g (h V0 - W(u, h)),  dE = -g W_u,  d2E = -g W_uu + g V_u V_u^T / V_h

with V = W_h. The first is the work of water that flows in from a reservoir. The second is the potential of the own
weight of the water. A drain caps the level at its own height z, and the rest of the water runs off. Where that node is
held, this is a given level. Where it moves, the forces have no potential: the tangent has the part -g V_u dz, of rank
one and not symmetric. The integrals are exact, see `geometry.water_on_triangles`.

Rain has a level in each of its basins (`model.basins`), which are energies of their own. Their volumes are kept between
events, so that their water has a potential.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..geometry import water_on_triangles as water
from ..model.basins import Basin
from ..model.ponds import Pond, triangles_of
from .acting_ponds import amount_of, pond_groups, water_of
from .actions import ActingPond
from .discretization import Discretization
from .node_values import NodeValues

Array = NDArray[np.float64]

STEPS = 200
EQUAL = 1e-15  # relative difference of volumes at which the search for a level ends
ROUNDING = 1e-13  # relative difference of volumes that is rounding


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
class PondEnergy:
    """Energy of a pond, an `one_integral.IntegralEnergy`; each process sums over cells of its own.

    Attributes:
        discretization: The numbering.
        waters: Ponds that share their cells, so that they are one: a given level, or amounts that add up. With their
            factors.
        held: Components of nodes with a given displacement, shape (n, 3).
        basin: Number of its basin in the water of the ponds; None for one level on all cells.
    """

    discretization: Discretization
    waters: tuple[ActingPond, ...]
    held: NDArray[np.bool_]
    basin: int | None = None
    is_load: ClassVar[bool] = True

    @property
    def name(self) -> str:
        """Name in messages."""
        return f"Pond on {self.pond.part!r}"

    @property
    def pond(self) -> Pond:
        """The first pond."""
        return self.waters[0].pond

    @property
    def _weight(self) -> float:
        """Specific weight in effect [N/m3]."""
        return self.pond.weight * (self.waters[0].factor if self.pond.level is not None else 1.0)

    @cached_property
    def amount(self) -> float:
        """Volume of the water that has come, or that of its basin [m3]."""
        total = amount_of(self.discretization.structure, self.waters)
        if self.basin is None:
            return total
        water = water_of(self.waters)
        assert water is not None
        return float(water.volumes(total)[self.basin])

    @cached_property
    def triangles(self) -> NDArray[np.int64]:
        """Its cells, upwards, shape (k, 3)."""
        triangles = triangles_of(self.discretization.structure, self.pond)
        return triangles if self.found is None else triangles[self.found.cells]

    @cached_property
    def outlets(self) -> NDArray[np.int64]:
        """Nodes over which water runs off at their present height, shape (k,): outlets of a basin, or drains."""
        if self.found is not None:
            return self.found.outlets
        return np.unique(np.concatenate([np.asarray(entry.pond.drains) for entry in self.waters])).astype(np.int64)

    @property
    def found(self) -> Basin | None:
        """Its basin; None for one level on all cells."""
        water = water_of(self.waters)
        return None if self.basin is None or water is None else water.basins[self.basin]

    @cached_property
    def _cells(self) -> tuple[NodeValues, NDArray[np.intp], NDArray[np.intp]]:
        """Nodes of the cells of this process and of all outlets, and the positions of both in them."""
        mine = np.zeros(len(self.discretization.structure.points), dtype=bool)
        mine[self.discretization.owned_nodes] = True
        own = self.triangles[mine[self.triangles[:, 0]]]
        nodes, places = np.unique(np.concatenate([own.ravel(), self.outlets]), return_inverse=True)
        places = places.ravel()
        return NodeValues(self.discretization, nodes), places[: own.size].reshape(-1, 3), places[own.size :]

    def water(self, x: PETSc.Vec) -> Water:
        """State of the water for a displacement; collective."""
        return self._water(*self._places(x))

    def energy(self, x: PETSc.Vec) -> float:
        """Energy for a displacement [J]."""
        lifted, pressed = self._energies(x)
        return lifted - pressed

    def size(self, x: PETSc.Vec) -> float:
        """Size of the terms of the energy, which nearly cancel [J]."""
        return sum(map(abs, self._energies(x)))

    def _energies(self, x: PETSc.Vec) -> tuple[float, float]:
        """Energy of the amount at the level, which a given level has not, and potential of the pressure [J]."""
        corners, heights = self._places(x)
        found = self._water(corners, heights)
        if not np.isfinite(found.level):
            return 0.0, 0.0
        total = self._sum(water.potentials(corners, found.level))
        lifted = 0.0 if self.pond.level is not None else found.level * self.amount
        return self._weight * lifted, self._weight * total

    def add_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Subtract the forces of the water from a residual [N]."""
        corners, heights = self._places(x)
        found = self._water(corners, heights)
        if np.isfinite(found.level):
            self._add(-self._weight * water.potential_gradients(corners, found.level), b)

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Add the derivative of the forces at a fixed level to a tangent [N/m]."""
        corners, heights = self._places(x)
        found = self._water(corners, heights)
        if not np.isfinite(found.level):
            return
        nodes, cells, _ = self._cells
        blocks = -self._weight * water.potential_hessians(corners, found.level).transpose(0, 1, 3, 2, 4)
        rows, columns = np.repeat(cells, 3, axis=1).ravel(), np.tile(cells, 3).ravel()
        nodes.add_blocks(A, rows, columns, blocks.reshape(-1, 3, 3))

    def border(self, x: PETSc.Vec, b: PETSc.Vec, kept: bool = False) -> float | None:
        """Set a vector to the derivative of the volume, return the wet area over the weight; see `FollowingEnergy`."""
        corners, heights = self._places(x)
        found = self._water(corners, heights)
        if self.pond.level is not None or (found.is_capped and not kept) or not found.area > 0:
            return None
        b.set(0.0)
        self._add(water.volume_gradients(corners, found.level), b)
        return found.area / self._weight

    def follows(self, x: PETSc.Vec) -> bool:
        """Return True if the level of some water is that of an outlet that moves."""
        return self.is_at_outlet(x) and self.water(x).area > 0

    def is_at_outlet(self, x: PETSc.Vec) -> bool:
        """Return True if the level is that of an outlet that moves, with water or without."""
        outlet = self.water(x).outlet if self.pond.level is None and not self._fixed else -1
        return outlet >= 0 and not self.held[self.outlets[outlet], 2]

    def one_sided_border(self, x: PETSc.Vec, b: PETSc.Vec, row: PETSc.Vec) -> None:
        """Set vectors to the derivative of the volume at a fixed level, and to minus that of the pressure."""
        corners, heights = self._places(x)
        found = self._water(corners, heights)
        nodes, _, places = self._cells
        b.set(0.0)
        self._add(water.volume_gradients(corners, found.level), b)
        row.set(0.0)
        values = np.zeros_like(nodes.points)
        once = self.discretization.comm.rank == 0  # on all processes together
        values[places[found.outlet], 2] = -self._weight * once
        nodes.add(values, row)

    @cached_property
    def _fixed(self) -> bool:
        """True if all outlets are held."""
        return bool(self.held[self.outlets, 2].all())

    def _places(self, x: PETSc.Vec) -> tuple[Array, Array]:
        """Corners of the cells of this process, shape (cells, 3, 3), and heights of all outlets, shape (k,) [m]."""
        nodes, cells, exits = self._cells
        positions = nodes.positions(x)
        return np.asarray(positions[cells]), positions[exits, 2]

    def _add(self, values: Array, b: PETSc.Vec) -> None:
        """Add values at the corners of the cells, shape (cells, 3, 3), to a vector."""
        nodes, cells, _ = self._cells
        sums = np.zeros_like(nodes.points)
        np.add.at(sums, cells, values)
        nodes.add(sums, b)

    def _sum(self, values: Array) -> float:
        return float(self.discretization.comm.allreduce(float(values.sum())))

    def _filled(self, corners: Array, level: float) -> Water:
        volume, area = water.volumes(corners, level)
        sums = self.discretization.comm.allreduce(np.array([volume.sum(), area.sum()]))
        return Water(level, float(sums[0]), float(sums[1]), False)

    def _water(self, corners: Array, heights: Array) -> Water:
        if self.pond.level is not None:
            return self._filled(corners, self.pond.level)
        if not (self.amount > 0 and self._finite(corners)):
            return DRY
        lowest = float(heights.min(initial=np.inf))
        rim = np.inf if self.found is not None else min(entry.overflow for entry in self.waters)
        cap = min(lowest, rim)
        if np.isfinite(cap):
            full = self._filled(corners, cap)
            if full.volume <= self.amount * (1 + ROUNDING):  # as a basin that is full
                return full._replace(is_capped=True, outlet=int(heights.argmin()) if lowest < rim else -1)
        return self._level(corners, cap)

    def _finite(self, corners: Array) -> bool:
        return bool(np.isfinite(self._sum(corners)))

    def _level(self, corners: Array, cap: float) -> Water:
        """Level of the volume, by Newton's method on a convex function of the level, from above and from its bottom."""
        comm = self.discretization.comm
        heights = corners[:, :, 2]
        low = -float(max(comm.allgather(float((-heights).max(initial=-np.inf)))))
        high = float(max(comm.allgather(float(heights.max(initial=-np.inf)))))
        plan = self._sum(water.plan_areas(corners))
        high = min(cap, high + self.amount / max(plan, 1e-300)) if plan > 0 else cap
        found = self._filled(corners, high)
        for _ in range(STEPS):
            over = found.volume - self.amount
            if abs(over) <= EQUAL * self.amount:
                break
            if over > 0:
                high = found.level
            else:
                low = found.level
            level = found.level - over / found.area if found.area > 0 else np.nan
            level = level if low < level < high else (low + high) / 2
            if level in (low, high, found.level):
                break
            found = self._filled(corners, level)
        return found


def pond_energies(
    discretization: Discretization, ponds: Sequence[ActingPond], held: NDArray[np.bool_]
) -> list[PondEnergy]:
    """Energies of the water of ponds, of those that share their cells together: one, or one for each basin."""
    found = []
    for group in pond_groups(ponds):
        if any(entry.factor for entry in group):
            water = water_of(group)
            basins: Sequence[int | None] = [None] if water is None else range(len(water.basins))
            found += [PondEnergy(discretization, group, held, basin) for basin in basins]
    return found
