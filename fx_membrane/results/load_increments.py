"""Load increments of a stage: iterations, outcome, gas and water at the end of each."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from ..assembly.gas import ChamberResult
from ..model.water_events import BasinResult, WaterEvent
from ..solvers.base import Iteration
from ..solvers.outcome import Outcome

NO_CHAMBERS: dict[str, ChamberResult] = {}


class Increment(NamedTuple):
    """Load increment.

    Attributes:
        load_factor: Fraction of the stage's own loads and displacements, in (0, 1].
        iterations: The iterates of the solver, the start first. Of several attempts of `Newton`, those of the one that
            gives the outcome: the one after the homotopy if it converged, or else the first.
        outcome: Outcome, the gravest of those that apply.
        extra_iterations: Number of iterates missing from `iterations`: those of rejected attempts and of the homotopy.
        fallen: Sentence on the parts that only slack parts held before; empty unless the outcome is FALLEN.
        chambers: Gas in the chambers at its end, by name.
        basins: Rain in the basins of membranes at its end.
        events: Water that ran over, and basins that merged or parted, at its end.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))], increments=2)
        >>> [(one.load_factor, one.outcome.name) for one in Analysis(rope).run([pull])["pull"].increments]
        [(0.5, 'CONVERGED'), (1.0, 'CONVERGED')]
    """

    load_factor: float
    iterations: tuple[Iteration, ...]
    outcome: Outcome = Outcome.CONVERGED
    extra_iterations: int = 0
    fallen: str = ""
    chambers: Mapping[str, ChamberResult] = NO_CHAMBERS
    basins: tuple[BasinResult, ...] = ()
    events: tuple[WaterEvent, ...] = ()

    @property
    def total_iterations(self) -> int:
        """Number of iterations, those of rejected attempts and of the homotopy among them."""
        return len(self.iterations) - 1 + self.extra_iterations
