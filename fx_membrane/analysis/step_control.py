"""Step control of the continuation by arc length: how far apart points are, and when a step is taken back."""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class StepControl:
    """Limits that a step along a path keeps to.

    Attributes:
        few: Points of a corrector that count as few; after more of them the next step is shorter.
        turn: Angle between a step and the tangent at its end [rad]; after a larger one the next step is shorter.
        sharp: A step with a larger angle is taken back and halved, unless the path has a kink there,
        drift: and so is one whose curve leaves the path by a larger share of the step (see `path_check`),
        coarse: or over which the load factor changes by more than so many times what it should,
        patience: but not more often than that for this reason alone.
        halvings: Most halvings of a step.
        short: A step shorter than this share of the first is not looked at: rounding hides the path.
        flat: Largest cosine between the path and the axis of the load factor at a limit point.
        exact: Error of the load factor at a limit point where the path has a kink there, as a share of it.
        search: Most trials for a limit point.
        kept: Share of the kept stiffness of wrinkled and slack cells that is left at a limit point.
    """

    few: int = 4
    turn: float = 0.2
    sharp: float = 0.6
    drift: float = 0.01
    coarse: float = 1.5
    patience: int = 4
    halvings: int = 12
    short: float = 2.5e-4
    flat: float = 1e-5
    exact: float = 1e-6
    search: int = 30
    kept: float = 0.01

    def stretch(self, corrections: int, turn: float) -> float:
        """Length of the next step as a multiple of the last, from the points of its corrector and its angle [rad]."""
        pace = min(math.sqrt(self.few / corrections), self.turn / max(turn, 1e-300))
        return min(max(pace, 0.5), 2.0)
