"""Size of load increments: halved after failures, and limited by the smallest load factor that failed."""

from dataclasses import dataclass
from fractions import Fraction

HALVINGS = 8
NEAR = Fraction(1, 50)  # of a load factor: accuracy of the bracket if more would take long
LONG = 500  # number of lost iterations that is long


@dataclass
class Ceiling:
    """The least load factor that failed from the previous states.

    Attributes:
        factor: That load factor; None before the first failure.
        vain: Number of iterates spent on it.
        smooth: True if the homotopy may still help; it starts afresh for any increment.
    """

    factor: Fraction | None = None
    vain: int = 0
    smooth: bool = True

    def next(self, start: Fraction, size: Fraction) -> Fraction:
        """Load factor to try from a start."""
        limit = self.factor if self.factor is not None and self.vain >= LONG else Fraction(1)
        return min(start + size, limit)

    def found(self, factor: Fraction) -> None:
        """Record a load factor with an equilibrium."""
        if self.factor is not None and factor >= self.factor:
            self.factor, self.vain, self.smooth = None, 0, True

    def failed(self, factor: Fraction, iterates: int) -> None:
        """Record a load factor without an equilibrium."""
        # A fallback that fails near a load fails closer to it, too; at half of the load it may help.
        self.smooth = self.factor is not None and 2 * factor <= self.factor
        self.factor = factor
        self.vain += iterates

    def reached(self, start: Fraction) -> bool:
        """Return True if a start is close to the ceiling after many lost iterations, so that it counts as the end."""
        return self.factor is not None and self.vain >= LONG and self.factor - start <= NEAR * self.factor

    def words(self, start: Fraction) -> str:
        """Sentence that the structure likely carries no more than the ceiling; empty far below it."""
        if not start or self.factor is None or self.factor - start > NEAR * self.factor:
            return ""
        return (
            f"from load factor {float(start):.6g} on no equilibrium was found, in however small increments, and likely "
            "there is none: it is the largest load that the structure bears (as fabric with a free edge, which flies "
            "off where a pressure exceeds what holds it down). More increments will not help; stay below that load, or "
            "add supports, members, weight or prestress. On fine meshes of slack fabric iterations may be too few; "
            "Newton(max_iterations=...) allows more."
        )
