"""Masts and stays between nodes, and the forces in them that balance given ones; or the reason why there are none."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...checks import validation
from ...geometry.sizes import measures
from ...model.parts import Bar, Cable, Mast
from .bar_forces import RANK, nearest, signed

Array = NDArray[np.float64]

BALANCED_FORCE = 1e-9  # unbalanced force, relative to the largest that is to be balanced, that is rounding of a form
ZERO_LENGTH = 1e-9  # length of a bar, relative to the extent of all points, that counts as none


@dataclass(frozen=True)
class BarFrame:
    """Masts and stays, and the components of nodes in which they must balance the forces.

    Attributes:
        parts: Masts and stays by name.
        points: Positions of all nodes, shape (n, 3) [m].
        free: Components to balance, shape (n, 3).
    """

    parts: Mapping[str, Bar]
    points: Array
    free: NDArray[np.bool_]

    def __post_init__(self) -> None:
        size = np.ptp(self.points, axis=0).max()
        for name, part in self.parts.items():
            for cell in np.flatnonzero(measures(self.points, part.cells) <= ZERO_LENGTH * size)[:1]:
                a, b = part.cells[cell]
                raise ValueError(
                    f"Part {name!r}, cell {cell} has no length: its nodes {a} and {b} are both at {self._place(a)}; "
                    "move its foot away from the head."
                )

    @cached_property
    def cells(self) -> NDArray[np.int64]:
        """Cells of all parts, shape (bars, 2)."""
        return np.concatenate([part.cells for part in self.parts.values()])

    @cached_property
    def wanted(self) -> Array:
        """Wanted forces, zero for none, shape (bars,) [N]."""
        return np.concatenate([part.prestress_tensors().ravel() for part in self.parts.values()])

    @cached_property
    def signs(self) -> Array:
        """Signs of the forces that the bars are to carry, shape (bars,)."""
        return np.concatenate([np.full(len(part.cells), sign_of(part)) for part in self.parts.values()])

    def pulls(self, forces: Array) -> Array:
        """Sum up the forces of the bars on the nodes, shape (n, 3) [N], from axial ones, shape (bars,) [N]."""
        total = np.zeros(self.points.shape)
        for end, sign in zip(self.cells.T, (1, -1), strict=True):
            np.add.at(total, end, sign * forces[:, None] * self._directions)
        return total

    def balance(self, reactions: Array) -> Array:
        """Find forces of the bars that balance reactions in the free components, shape (bars,) [N].

        Args:
            reactions: Forces of supports on the nodes, which the bars replace, shape (n, 3) [N].

        Raises:
            ValueError: No forces of the right signs do; the message names a node or a bar, and the remedy.
        """
        nodes, local = np.unique(self.cells, return_inverse=True)
        blocks, bars = np.zeros((len(nodes), 3, len(self.cells))), np.arange(len(self.cells))
        for end, sign in zip(local.reshape(self.cells.shape).T, (1, -1), strict=True):
            blocks[end, :, bars] += sign * self._directions
        free = self.free[nodes]
        matrix, target = blocks[free] * self.signs, reactions[nodes][free]
        rest = target - matrix @ signed(matrix, target)
        limit = BALANCED_FORCE * max(np.abs(target).max(initial=0.0), np.abs(self.wanted).max())
        if np.abs(rest).max(initial=0.0) <= limit:
            return np.asarray(self.signs * nearest(matrix, target, np.abs(self.wanted)))
        any_sign, _, rank, _ = np.linalg.lstsq(matrix, target, rcond=RANK)
        left = target - matrix @ any_sign
        one_sided = bool(np.abs(left).max() <= limit)
        if one_sided and rank == len(bars):
            raise ValueError(self._wrong_sign(any_sign))
        missing = np.zeros(self.points.shape)
        missing[np.repeat(nodes, 3).reshape(free.shape)[free], np.nonzero(free)[1]] = rest if one_sided else left
        raise ValueError(self._unbalanced(reactions, missing, one_sided))

    def unmet(self, forces: Array, tolerance: float) -> str:
        """Tell of the bar that is farthest from its wanted force, in words; empty if all are near."""
        off = np.where(self.wanted != 0, np.abs(forces - self.wanted), 0.0)
        if off.max() <= tolerance * np.abs(self.wanted).max():
            return ""
        bar = int(off.argmax())
        name, cell = self._names[bar]
        return (
            f"The form balances with {forces[bar]:.4g} in cell {cell} of part {name!r}, not with the wanted "
            f"{self.wanted[bar]:.4g}: reactions and directions of the bars decide; want that force, or none, or move "
            "the feet."
        )

    @cached_property
    def _names(self) -> list[tuple[str, int]]:
        return [(name, cell) for name, part in self.parts.items() for cell in range(len(part.cells))]

    @cached_property
    def _directions(self) -> Array:
        way = self.points[self.cells[:, 1]] - self.points[self.cells[:, 0]]
        return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True))

    def _wrong_sign(self, amounts: Array) -> str:
        bar = int(np.argmin(amounts))
        names = self._names
        kind, stress, other = ("mast", "tension", "cable") if self.signs[bar] < 0 else ("stay", "compression", "mast")
        a, b = map(self._place, self.cells[bar])
        return (
            f"The {kind} in cell {names[bar][1]} of part {names[bar][0]!r}, from {a} to {b}, would be in {stress}, "
            f"{-amounts[bar]:.4g}, and the directions of the bars leave no other forces; move its foot, or make it a "
            f"{other}."
        )

    def _unbalanced(self, reactions: Array, missing: Array, one_sided: bool) -> str:
        node = int(np.argmax(np.linalg.norm(missing, axis=1)))
        rest = missing[node]
        kinds = "masts in compression and stays in tension" if one_sided else "forces along the bars"
        return (
            f"No {kinds} balance node {node} at {self._place(node)}: of the force {format_force(reactions[node])} "
            f"that they are to put on it, at least {format_force(rest)} is missing; add a stay there in the direction "
            f"{format_force(rest / np.linalg.norm(rest))}, or a mast from the other side, or move the feet."
        )

    def _place(self, node: int) -> str:
        return validation.format_point(self.points[node])


def sign_of(part: Bar) -> int:
    """Sign of the forces that a part is to carry: masts push, stays pull."""
    return -1 if part.is_strut else 1


def checked_parts(bars: Any) -> dict[str, Mast | Cable]:
    """Check masts and stays by name.

    Raises:
        ValueError: It is no mapping of them; a wanted force has the wrong sign.
    """
    validation.instance("bars", bars, Mapping)
    if not bars:
        raise ValueError("bars is empty; give at least one Mast or Cable by name.")
    for name, part in bars.items():
        validation.plain(f"bars: part {validation.name('part', name)!r}", part, Mast | Cable)
        force = part.prestress_tensors().ravel()
        for cell in np.flatnonzero(force * sign_of(part) < 0)[:1]:
            kind, stress = ("mast", "tension") if part.is_strut else ("stay", "compression")
            raise ValueError(
                f"Part {name!r}, cell {cell}: its prestress {force[cell]:g}, the wanted force, is a {stress}, which no "
                f"{kind} is to carry; change its sign, or give zero for none."
            )
    return {validation.name("part", name): part for name, part in bars.items()}


def format_force(force: Array) -> str:
    """Show a force in a message, without the rounding in its zeros."""
    largest = max(np.abs(force).max(), np.finfo(float).tiny)
    return f"({', '.join(f'{component:.4g}' for component in np.round(force / largest, 9) * largest + 0.0)})"
