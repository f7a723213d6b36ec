"""Water that spills from full basins into others: amounts that depend on the shape.

A basin k that is full up to its outlet holds V_k(u), up to the height of that outlet. What has come to it beyond that
runs into the basin behind the outlet:

    s_k(u) = max(a_k(u) - V_k(u), 0),    a_k(u) = own rain + sum of s_j(u) of the basins j that spill into it.

The derivative of an amount is minus that of the volumes of all full basins on the ways to it. Two basins that spill
into one another give each other only water from elsewhere. If both are full, the rest waits until they merge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from petsc4py import PETSc

from ..geometry.hollows import OUTSIDE
from .pond_cells import VOLUME_ROUNDING, PondCells


class Spilt(NamedTuple):
    """Water that runs over.

    Attributes:
        volume: Its volume [m3].
        sources: Numbers of the full basins on its ways.
    """

    volume: float = 0.0
    sources: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Cascade:
    """Basins of a pond that spill into one another; methods are collective.

    Attributes:
        cells: Cells of each basin.
        own: Water of each without that from others [m3].
        into: Number of the basin into which each spills; -1 for the outside.
    """

    cells: tuple[PondCells, ...]
    own: Sequence[float]
    into: Sequence[int]

    @cached_property
    def _before(self) -> list[list[int]]:
        """Basins that spill into each."""
        found: list[list[int]] = [[] for _ in self.into]
        for number, behind in enumerate(self.into):
            if behind != OUTSIDE:
                found[behind].append(number)
        return found

    def inflow(self, number: int, x: PETSc.Vec, without: int = OUTSIDE) -> Spilt:
        """Water that spills into a basin, of all others but one."""
        found = [self.spilt(other, x) for other in self._before[number] if other != without]
        return Spilt(sum(one.volume for one in found), tuple(source for one in found for source in one.sources))

    def spilt(self, number: int, x: PETSc.Vec) -> Spilt:
        """Water that spills from a basin into the one behind its outlet; none over the edge."""
        behind = self.into[number]
        if behind == OUTSIDE:
            return Spilt()
        come = self.inflow(number, x, without=behind)
        amount = self.own[number] + come.volume
        if amount <= 0:
            return Spilt()
        cells = self.cells[number]
        full = cells.full(cells.places(x)).volume
        if not full <= amount * (1 + VOLUME_ROUNDING):
            return Spilt()
        return Spilt(max(amount - full, 0.0), (*come.sources, number))

    def amounts(self, x: PETSc.Vec) -> list[float]:
        """Water of each basin, and what is above its outlet and waits there [m3]."""
        return [
            own + self.inflow(number, x).volume - self.spilt(number, x).volume for number, own in enumerate(self.own)
        ]
