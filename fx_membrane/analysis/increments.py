"""How far an increment of load reaches, where some were too long: halved, and up to what was found to be too much."""

from dataclasses import dataclass
from fractions import Fraction

HALVINGS = 8
NEAR = Fraction(1, 50)  # of a load factor: it is bracketed well enough where more would take long
LONG = 500  # iterations in vain that are long


@dataclass
class Ceiling:
    """The least load factor at which nothing was found from the states before it.

    Attributes:
        factor: That factor; None where nothing failed yet.
        vain: Number of iterates spent on it.
        smooth: Whether drawing the structure smooth may still help; it begins anew, whatever the increment.
    """

    factor: Fraction | None = None
    vain: int = 0
    smooth: bool = True

    def next(self, start: Fraction, size: Fraction) -> Fraction:
        """Load factor to try from a start."""
        limit = self.factor if self.factor is not None and self.vain >= LONG else Fraction(1)
        return min(start + size, limit)

    def found(self, factor: Fraction) -> None:
        """Hears of an equilibrium."""
        if self.factor is not None and factor >= self.factor:
            self.factor, self.vain, self.smooth = None, 0, True

    def failed(self, factor: Fraction, iterates: int) -> None:
        """Hears of a load factor at which nothing was found."""
        # What does not help near a load does not help nearer to it; at half of it, it may.
        self.smooth = self.factor is not None and 2 * factor <= self.factor
        self.factor = factor
        self.vain += iterates

    def reached(self, start: Fraction) -> bool:
        """Whether a start is so near, after so much in vain, that it is taken for the end."""
        return self.factor is not None and self.vain >= LONG and self.factor - start <= NEAR * self.factor

    def words(self, start: Fraction) -> str:
        """That there is likely nothing beyond it; empty where it is not near enough to tell."""
        if not start or self.factor is None or self.factor - start > NEAR * self.factor:
            return ""
        return (
            f"from load factor {float(start):.6g} on no equilibrium was found, in however small increments, and likely "
            "there is none: it is the largest load that the structure bears (as fabric with a free edge, which flies "
            "off where a pressure exceeds what holds it down). More steps will not help; stay below that load, or add "
            "supports, members, weight or prestress. On fine meshes of slack fabric iterations may be too few; "
            "Newton(max_iterations=...) allows more."
        )
