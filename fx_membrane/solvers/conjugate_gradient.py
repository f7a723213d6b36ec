"""First-order methods, steepest descent and nonlinear conjugate gradients, Gil (72), (73), (75)-(77).

They need unbalanced forces only, never a tangent, and descend from any start. They converge slowly where stiffnesses
differ.

Source: J. Nocedal, S. J. Wright, Numerical optimization (2006), section 5.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from petsc4py import PETSc

from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..checks import validation
from . import petsc_options
from .base import LIMITS, Iteration, Monitor, Solution, diverged, no_monitor, tolerance
from .conjugate_directions import Beta, Gradient, fletcher_reeves, no_memory, polak_ribiere
from .diagnosis import first_order_advice, stagnation_message
from .line_search import Point, line, rounding, search
from .outcome import Outcome
from .preconditioners import Kind, preconditioner


@dataclass(frozen=True)
class DescentControl:
    """Limits of a first-order method.

    Attributes:
        flatness: Accepted slope at the end of a step, as a fraction of that at its start: conjugate directions need
            line searches close to the minimum.
        stagnation: Fraction of its earlier minimum above which the residual stands still.
        difference: Displacement, in sizes of the structure, for the difference quotient of the curvature.
    """

    flatness: float = 0.1
    stagnation: float = 0.5
    difference: float = 1e-7


CONTROL = DescentControl()


@dataclass(frozen=True)
class SteepestDescent:
    """Steepest descent, Gil (73): each step along the unbalanced forces.

    Constrained components take their prescribed values at once; the iterates begin there.

    Raises:
        ValueError: preconditioner is none of the three; rtol is out of range; max_iterations is not a positive whole
            number.

    Args:
        preconditioner: Divisor of the unbalanced forces: None, no preconditioner; "jacobi", the diagonal of the tangent
            at the start of each load increment; "tangent", that tangent, factored once. A tangent that is not positive
            definite is shifted by a stabilization matrix; with pressure, its symmetric part is used. The diagonal helps
            where stiffness differs from node to node: in graded meshes, or with stiff cables. The tangent helps where
            it changes little. Neither always helps: on an inflated flat disc the diagonal took two to four times as
            many iterations as none.
        rtol: Relative tolerance of the unbalanced forces: their 2-norm over that of all nodal forces, reactions and
            loads included. Rounding counts as converged. A start converges only at rounding.
        max_iterations: Maximum number of iterations for one load increment.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> state = Analysis(rope, SteepestDescent("tangent")).run([pull])["pull"]
        >>> state.cable("rope").force.round(1).tolist()
        [1012.2, 1012.2]
    """

    preconditioner: Kind = None
    rtol: float = 1e-10
    max_iterations: int = 10_000

    def __post_init__(self) -> None:
        _check(self)

    def prepare(self, problem: Problem) -> Descent:
        """Return a function that brings a vector to equilibrium and keeps its workspace between calls."""
        return Descent(self, no_memory, problem)


@dataclass(frozen=True)
class ConjugateGradient:
    """Nonlinear conjugate gradients, Gil (75)-(77).

    Each direction adds a fraction beta of the previous one. It restarts along the unbalanced forces where it would not
    descend. So it does after as many steps as there are free components. Constrained components take their prescribed
    values at once; the iterates begin there.

    Raises:
        ValueError: beta is none of the two; preconditioner is none of the three; rtol is out of range; max_iterations
            is not a positive whole number.

    Args:
        beta: "PR", Polak-Ribiere, or "FR", Fletcher-Reeves, Gil (77).
        preconditioner: As of `SteepestDescent`; beta is then that of the preconditioned forces.
        rtol: As of `SteepestDescent`.
        max_iterations: Maximum number of iterations for one load increment.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> state = Analysis(rope, ConjugateGradient(preconditioner="jacobi")).run([pull])["pull"]
        >>> state.cable("rope").force.round(1).tolist()
        [1012.2, 1012.2]
    """

    beta: Literal["FR", "PR"] = "PR"
    preconditioner: Kind = None
    rtol: float = 1e-10
    max_iterations: int = 10_000

    def __post_init__(self) -> None:
        remedy = '"FR" (Fletcher-Reeves) or "PR" (Polak-Ribiere)'
        validation.keep(self, beta=validation.choice("ConjugateGradient beta", self.beta, ("FR", "PR"), remedy))
        _check(self)

    def prepare(self, problem: Problem) -> Descent:
        """Return a function that brings a vector to equilibrium and keeps its workspace between calls."""
        return Descent(self, fletcher_reeves if self.beta == "FR" else polak_ribiere, problem)


def _check(settings: SteepestDescent | ConjugateGradient) -> None:
    name = type(settings).__name__
    remedy = 'None, "jacobi" (the diagonal of the tangent) or "tangent"'
    given = settings.preconditioner
    preconditioner = validation.choice(f"{name} preconditioner", given, (None, "jacobi", "tangent"), remedy)
    validation.keep(settings, preconditioner=preconditioner)
    validation.store(settings, validation.tolerance, "rtol")
    validation.store(settings, validation.positive_integer, "max_iterations")


class Descent:
    """The iteration.

    Attributes:
        problem: The problem of the present solve.
        now: Gradient at the last iterate.
        before: Gradient at the previous iterate.
        direction: Last search direction.
        anew: True if the next direction restarts along the unbalanced forces.
        age: Number of directions since the last restart.
        restart: Value of `age` that forces a restart: as many directions as there are free components are conjugate.
        noise: Rounding of energy differences along the last direction [J].
    """

    def __init__(self, settings: SteepestDescent | ConjugateGradient, beta: Beta, problem: Problem):
        self.settings, self.beta = settings, beta
        self.size = problem.structure.size
        where, factors = type(settings).__name__, settings.preconditioner == "tangent"
        petsc_options.tell_not_for_steps(problem.comm, where, factors)
        self.preconditioner = preconditioner(problem, settings.preconditioner)
        create = problem.discretization.create_vector
        self.now, self.before = Gradient(create(), create()), Gradient(create(), create())
        self.direction = create()

    def release(self) -> None:
        """Free the factors of the preconditioner until the next solve; collective."""
        self.preconditioner.release()

    def __call__(
        self, problem: LoadedProblem, x: PETSc.Vec, monitor: Monitor = no_monitor, thorough: bool = True
    ) -> Solution:
        """Bring x to equilibrium."""
        self.problem = problem
        self.history: list[Iteration] = []
        self.anew, self.age = True, 0
        self.restart = self.free_components()
        self.problem.constraints.impose(x)
        if self.arrived(x, 0.0, monitor):
            return Solution(Outcome.CONVERGED, Outcome.CONVERGED.value, tuple(self.history))
        divide = self.preconditioner.at(problem, x)
        if divide is None:
            return Solution(Outcome.INDEFINITE, Outcome.INDEFINITE.value, tuple(self.history))
        for _ in range(self.settings.max_iterations):
            divide(*self.now)
            length = self.step(x)
            if length is None:
                return self.failure(x, Outcome.NO_DESCENT)
            if self.arrived(x, length, monitor):
                return Solution(Outcome.CONVERGED, Outcome.CONVERGED.value, tuple(self.history))
            if diverged(self.problem, x, self.history[-1].residual):
                return self.failure(x, Outcome.DIVERGED)
        return self.failure(x, Outcome.SLOW)

    def arrived(self, x: PETSc.Vec, length: float, monitor: Monitor) -> bool:
        """Record an iterate and its gradient; return True if it is the solution."""
        b = self.now.g
        energy = self.problem.energy_and_residual(x, b)
        accepted = tolerance(self.problem, x, b, self.settings.rtol if self.history else LIMITS.rounding)
        self.problem.constraints.zero_constrained(b)
        max_norm = b.norm(PETSc.NormType.NORM_INFINITY)
        self.history.append(Iteration(energy, max_norm, length))
        monitor(len(self.history) - 1, self.history[-1])
        return self.problem.beyond_rounding(x, b) < accepted

    def step(self, x: PETSc.Vec) -> float | None:
        """Take one step; return its length, or None if no length lowers the energy."""
        self.turn()
        length = self.go(x, self.direction)
        if length is None and self.age:
            self.anew = True
            self.turn()
            length = self.go(x, self.direction)
        self.anew = False
        self.now, self.before = self.before, self.now  # the next gradient replaces the last but one
        return length

    def turn(self) -> None:
        """Set the search direction from the last iterate."""
        d, (g, s) = self.direction, self.now
        if not self.anew and self.age + 1 < self.restart:
            d.scale(self.beta(self.now, self.before))
            d.axpy(-1.0, s)  # Gil (76)
            if d.dot(g) < 0:
                self.age += 1
                return
        self.age = 0
        s.copy(d)
        d.scale(-1.0)  # Gil (73), (75)

    def go(self, x: PETSc.Vec, d: PETSc.Vec) -> float | None:
        """Length of a step along a direction scaled to the minimum of its quadratic model.

        On a quadratic energy the full step is exact. The curvature is a difference of two gradients: a product with the
        tangent would take its assembly, which costs five times as much.
        """
        with self.problem.discretization.work(1) as (step,):
            d.copy(step)
            step.scale(self.full(x, d))
            first = Point(0.0, self.history[-1].energy, float(self.now.g.dot(step)))
            self.noise = rounding(self.problem, first, x, step)
            alpha = search(line(self.problem, x, step, first), self.noise, CONTROL.flatness)
            if alpha is not None:
                x.axpy(alpha, step)  # Gil (72)
        return alpha

    def full(self, x: PETSc.Vec, d: PETSc.Vec) -> float:
        """Factor that scales a direction to the full step, limited to displacements of the structure's size."""
        max_norm = d.norm(PETSc.NormType.NORM_INFINITY)
        difference = CONTROL.difference * self.size / max_norm
        slope = float(self.now.g.dot(d))
        with self.problem.discretization.work(2) as (near, b):
            near.waxpy(difference, d, x)
            self.problem.residual(near, b)
            curvature = (float(b.dot(d)) - slope) / difference
        most = self.size / max_norm
        return min(-slope / curvature, most) if curvature > 0 else most

    def free_components(self) -> int:
        """Count of unconstrained components."""
        with self.problem.discretization.work(1) as (free,):
            free.set(1.0)
            self.problem.constraints.zero_constrained(free)
            return int(free.sum())

    def stands_still(self) -> bool:
        """Return True if later iterates changed the energy by rounding only and did not lower the residual."""
        half = len(self.history) // 2
        fallen = abs(self.history[half].energy - self.history[-1].energy)
        before, after = (min(entry.residual for entry in part) for part in (self.history[:half], self.history[half:]))
        return fallen <= self.noise * (len(self.history) - half) and after > CONTROL.stagnation * before

    def failure(self, x: PETSc.Vec, outcome: Outcome) -> Solution:
        """End of a failure after the last iterate.

        Smaller load increments would hardly need fewer iterations, so they are no remedy for slow convergence.
        """
        name, last = type(self.settings).__name__, self.history[-1].residual
        at_rounding = outcome is Outcome.SLOW and self.stands_still()
        reason = stagnation_message(self.problem, x, len(self.history) - 1, last, at_rounding, solver=name)
        if outcome is Outcome.SLOW:
            steepest = isinstance(self.settings, SteepestDescent)
            reason += first_order_advice(at_rounding, steepest, divided=self.settings.preconditioner == "tangent")
        return Solution(outcome, reason, tuple(self.history))
