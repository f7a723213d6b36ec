"""Circular holes of sails, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..checks import validation
from ..model.by_value import ByValue


@dataclass(frozen=True, eq=False)
class RoundHole(ByValue):
    """Circular hole of a sail, as below a mast head.

    Args:
        centre: Its centre, shape (2,), its height free; or (3,), the ring at that height [m].
        radius: Its radius in plan [m].

    Raises:
        ValueError: The centre is no point; the radius is not positive.

    Example:
        >>> RoundHole((6, 6, 5), radius=0.6).radius
        0.6
    """

    centre: ArrayLike
    radius: float

    def __post_init__(self) -> None:
        validation.store(self, validation.finite, "centre")
        if self.centre.shape not in ((2,), (3,)):  # type: ignore[union-attr]  # an array by now
            raise ValueError(f"RoundHole centre is {validation.short_repr(self.centre)}; give (x, y) or (x, y, z).")
        validation.store(self, validation.positive, "radius")
