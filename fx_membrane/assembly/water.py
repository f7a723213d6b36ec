"""Energy of water on a membrane: a given level, or a volume whose level follows from the shape.

With W(u, h) the integral of half the square of the depth below the level h, and g the specific weight,

    given level:    E = -g W(u, h),                        dE = -g W_u
    given volume:   E = max over h of g (h V0 - W(u, h)),  dE = -g W_u,  d2E = -g W_uu + g V_u V_u^T / V_h

with V = W_h. The first is the work of water that flows in from a reservoir. The second is the potential of the own
weight of the water. A drain caps the level at its own height z, and the rest of the water runs off. Where that node is
held, this is a given level. Where it moves, the forces have no potential: the tangent has the part -g V_u dz, of rank
one and not symmetric. The integrals are exact, see `geometry.water_on_triangles`.

Rain has a level in each of its basins (`model.basins`), which are energies of their own. Full basins spill into others
(`cascade`), whose amount a(u) then depends on the shape of those. The last term becomes g V_u (V_u - a_u)^T / V_h, not
symmetric either. The energy of spilt water is left out: where it falls, it is lost.
"""

from __future__ import annotations

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
from .cascade import Cascade
from .discretization import Discretization
from .pond_cells import Places, PondCells, Water


class BasinOfCascade(NamedTuple):
    """A basin among those that spill into one another.

    Attributes:
        number: Its number.
        found: The basin.
        cascade: All of them.
    """

    number: int
    found: Basin
    cascade: Cascade


@dataclass(frozen=True, eq=False)
class PondEnergy:
    """Energy of a pond, an `one_integral.IntegralEnergy`; each process sums over cells of its own.

    Attributes:
        cells: Its cells and outlets.
        waters: Ponds that share their cells, so that they are one: a given level, or amounts that add up. With their
            factors.
        held: Components of nodes with a given displacement, shape (n, 3).
        amount: Volume of the water that has come, or that of its basin without what spills into it [m3].
        basin: Its basin in the water of the ponds; None for one level on all cells.
    """

    cells: PondCells
    waters: tuple[ActingPond, ...]
    held: NDArray[np.bool_]
    amount: float
    basin: BasinOfCascade | None = None
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
    def outlets(self) -> NDArray[np.int64]:
        """Nodes over which water runs off at their present height, shape (k,)."""
        return self.cells.outlets

    @property
    def _weight(self) -> float:
        """Specific weight in effect [N/m3]."""
        return self.pond.weight * (self.waters[0].factor if self.pond.level is not None else 1.0)

    def water(self, x: PETSc.Vec) -> Water:
        """State of the water for a displacement; collective."""
        return self._state(x)[1]

    def energy(self, x: PETSc.Vec) -> float:
        """Energy for a displacement [J]."""
        lifted, pressed = self._energies(x)
        return lifted - pressed

    def size(self, x: PETSc.Vec) -> float:
        """Size of the terms of the energy, which nearly cancel [J]."""
        return sum(map(abs, self._energies(x)))

    def _energies(self, x: PETSc.Vec) -> tuple[float, float]:
        """Energy of the amount at the level, which a given level does not have, and potential of the pressure [J]."""
        at, found = self._state(x)
        if not np.isfinite(found.level):
            return 0.0, 0.0
        total = self.cells.sum(water.potentials(at.corners, found.level))
        lifted = 0.0 if self.pond.level is not None else found.level * self.amount
        return self._weight * lifted, self._weight * total

    def add_gradient(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Subtract the forces of the water from a residual [N]."""
        at, found = self._state(x)
        if np.isfinite(found.level):
            self.cells.add(-self._weight * water.potential_gradients(at.corners, found.level), b)

    def add_hessian(self, x: PETSc.Vec, A: PETSc.Mat) -> None:
        """Add the derivative of the forces at a fixed level to a tangent [N/m]."""
        at, found = self._state(x)
        if np.isfinite(found.level):
            self.cells.add_matrix(-self._weight * water.potential_hessians(at.corners, found.level), A)

    def border(self, x: PETSc.Vec, b: PETSc.Vec, kept: bool = False) -> float | None:
        """Set a vector to the derivative of the volume, return the wet area over the weight; see `FollowingEnergy`."""
        at, found = self._state(x)
        if self.pond.level is not None or (found.is_capped and not kept) or not found.area > 0:
            return None
        b.set(0.0)
        self.cells.add(water.volume_gradients(at.corners, found.level), b)
        return found.area / self._weight

    def follows(self, x: PETSc.Vec) -> bool:
        """Return True if some water is at an outlet that moves, or other basins spill into it."""
        found = self.water(x)
        if not found.area > 0:
            return False
        return self._moves_with(found) or (not found.is_capped and bool(self._sources(x)))

    def is_without_potential(self, x: PETSc.Vec) -> bool:
        """Return True if the level is at an outlet that moves, with water or without, or others spill into it."""
        return self._moves_with(self.water(x)) or bool(self._sources(x))

    def one_sided_border(self, x: PETSc.Vec, b: PETSc.Vec, row: PETSc.Vec) -> float:
        """Set vectors to the derivative of the volume at a fixed level, and to the row; return the compliance.

        At an outlet the row is minus the derivative of the pressure, with the compliance 1. Elsewhere it is that of the
        volume here and in the full basins that spill into this one.
        """
        at, found = self._state(x)
        gradient = water.volume_gradients(at.corners, found.level)
        b.set(0.0)
        self.cells.add(gradient, b)
        row.set(0.0)
        if found.is_capped:
            self.cells.add(np.zeros_like(gradient), row, found.outlet, -self._weight)
            return 1.0
        b.copy(row)
        assert self.basin
        for source in self._sources(x):
            self.basin.cascade.cells[source].add_capacity_gradient(x, row)
        return found.area / self._weight

    def _moves_with(self, found: Water) -> bool:
        """Return True if the level is that of an outlet that moves."""
        if self.pond.level is not None or self._fixed or found.outlet < 0:
            return False
        return not self.held[self.outlets[found.outlet], 2]

    def _sources(self, x: PETSc.Vec) -> tuple[int, ...]:
        """Full basins that spill into this one, on all ways."""
        return self.basin.cascade.inflow(self.basin.number, x).sources if self.basin else ()

    @cached_property
    def _fixed(self) -> bool:
        """True if all outlets are held."""
        return bool(self.held[self.outlets, 2].all())

    def _state(self, x: PETSc.Vec) -> tuple[Places, Water]:
        """Shape of the cells of this process, and the water on them."""
        at = self.cells.places(x)
        if self.pond.level is not None:
            return at, self.cells.filled(at, self.pond.level)
        come = self.basin.cascade.inflow(self.basin.number, x).volume if self.basin else 0.0
        return at, self.cells.holding(at, self.amount + come)


def pond_energies(
    discretization: Discretization, ponds: Sequence[ActingPond], held: NDArray[np.bool_]
) -> list[PondEnergy]:
    """Energies of the water of ponds, of those that share their cells together: one, or one for each basin."""
    found = []
    for group in pond_groups(ponds):
        if any(entry.factor for entry in group):
            found += _energies_of(discretization, group, held)
    return found


def _energies_of(
    discretization: Discretization, group: tuple[ActingPond, ...], held: NDArray[np.bool_]
) -> list[PondEnergy]:
    """Energies of ponds that share their cells."""
    structure = discretization.structure
    triangles, total, standing = triangles_of(structure, group[0].pond), amount_of(structure, group), water_of(group)
    if standing is None:
        drains = np.unique(np.concatenate([np.asarray(entry.pond.drains) for entry in group])).astype(np.int64)
        cells = PondCells(discretization, triangles, drains, min(entry.overflow for entry in group))
        return [PondEnergy(cells, group, held, total)]
    basins, own = standing.basins, standing.volumes(total).tolist()
    parts = tuple(PondCells(discretization, triangles[basin.cells], basin.outlets) for basin in basins)
    cascade = Cascade(parts, own, standing.ways)
    return [
        PondEnergy(cells, group, held, amount, BasinOfCascade(number, basin, cascade))
        for number, (cells, amount, basin) in enumerate(zip(parts, own, basins, strict=True))
    ]
