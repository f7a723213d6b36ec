"""Outcome of the search for an equilibrium, as an enumeration of sentences."""

from __future__ import annotations

from enum import Enum


class Outcome(Enum):
    """Outcome of the search for an equilibrium; the value is a sentence on it.

    Of several that apply, the graver counts: FALLEN, then UNSTABLE, SNAPPED, STABILIZED, CONVERGED.

    Attributes:
        CONVERGED: Equilibrium, found from the start given.
        STABILIZED: Equilibrium, found after a homotopy in a fading stabilization.
        SNAPPED: Equilibrium beyond a loss of stability.
        FALLEN: Equilibrium beyond a loss of stability of what slack parts alone had held.
        UNSTABLE: Equilibrium that is not stable, as far as the solver looked (see `stability`).
        MAX_ITERATIONS: Failure: the iterations ran out.
        SLOW: Failure of a first-order method whose iterations ran out.
        STAGNATED: Failure: unbalanced forces are small, but do not fall below the tolerance.
        DIVERGED: Failure: displacements are far beyond the size of the structure, or not numbers.
        SINGULAR: Failure: a tangent is singular, with any shift.
        SINGULAR_START: Failure: the tangent of a start is singular, and there is no shift.
        LINEAR_LIMIT: Failure: the iterative linear solver that PETSc options choose ran out of iterations.
        NO_DESCENT: Failure: no step along the search direction lowers the energy.
        INDEFINITE: Failure: the tangent is no preconditioner.
        MECHANISM: Failure: the structure has a free motion.
        SLACK_MECHANISM: Failure: only slack parts resist a motion of masts.
        NO_EQUILIBRIUM: Failure: a solver calls a state an equilibrium that breaks its constraints.
        UNDEFINED: Failure: an energy term is not a number at the start.
        WORK_LIMIT: Failure: the limit of work is used up.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> outcome = Analysis(rope).run([pull])["pull"].increments[-1].outcome
        >>> outcome.name, outcome.converged, outcome.lost_stability
        ('CONVERGED', True, False)
    """

    CONVERGED = "equilibrium was found."
    STABILIZED = "equilibrium was found after a homotopy in a fading stabilization."
    SNAPPED = "the structure lost its stability, and has snapped through or buckled into another shape."
    FALLEN = "the structure lost its stability, and what slack parts alone had held has fallen."
    UNSTABLE = "the equilibrium that was found is not stable, and none that is was found from there."
    MAX_ITERATIONS = "the iterations ran out."
    SLOW = "the iterations of a first-order method ran out; smaller increments need hardly fewer."
    STAGNATED = "the unbalanced forces are small but do not fall below the tolerance."
    DIVERGED = "the iteration diverged."
    SINGULAR = "the tangent stiffness is singular."
    SINGULAR_START = "the tangent stiffness is singular at the start, and so it is in any smaller increment."
    LINEAR_LIMIT = "the linear solver ran out of iterations, as it may in any smaller increment."
    NO_DESCENT = "no step lowers the energy."
    INDEFINITE = (
        "the tangent at the start cannot be made positive definite, not even by a shift, and is no preconditioner; "
        "do without (preconditioner=None)."
    )
    MECHANISM = "the structure is a mechanism."
    SLACK_MECHANISM = "the structure is a mechanism but for the small stiffness that slack parts keep."
    NO_EQUILIBRIUM = "the state that the solver calls an equilibrium breaks its constraints."
    UNDEFINED = "an energy term is not a number at the start, and so it is in any smaller increment."
    WORK_LIMIT = "the limit of work is used up."

    @property
    def converged(self) -> bool:
        """True for an equilibrium."""
        return self in _EQUILIBRIA

    @property
    def lost_stability(self) -> bool:
        """True for an equilibrium beyond a loss of stability."""
        return self in (Outcome.SNAPPED, Outcome.FALLEN)

    @property
    def retry(self) -> bool:
        """True for a failure that a smaller load increment may avoid."""
        return not self.converged and self not in _FINAL


_EQUILIBRIA = (Outcome.CONVERGED, Outcome.STABILIZED, Outcome.SNAPPED, Outcome.FALLEN, Outcome.UNSTABLE)
_FINAL = (
    *(Outcome.SLOW, Outcome.SINGULAR_START, Outcome.INDEFINITE, Outcome.MECHANISM),
    *(Outcome.LINEAR_LIMIT, Outcome.NO_EQUILIBRIUM, Outcome.UNDEFINED, Outcome.WORK_LIMIT),
)
