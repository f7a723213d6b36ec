"""Continuation by arc length: equilibrium paths past limit points, as in snap-through, snap-back and inflation.

The load factor is one more unknown. One more equation says how far along the path the next point is: it lies in the
plane across the tangent of the path at the last point, at a given length from it,

    t_u . (u - u_n) + psi^2 t_f (factor - factor_n) = length.

psi, the weight of the load factor, is the norm of the first du/dfactor: at the start displacement and load count alike.
The path goes on in the sense of the last step. Steps become shorter where Newton's method takes many iterations or the
path turns, and longer elsewhere.

Source: E. Riks, An incremental approach to the solution of snapping and buckling problems, Int. J. Solids Structures
15 (1979) 529-551.
"""

import math
import warnings
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from . import _dolfinx, load_case, loads, path_ends, validation
from .bordered_newton import BorderedNewton, Plane, Point, Step
from .curvature import downhill
from .diagnosis import linear_failure
from .equilibrium_path import EquilibriumPath, PathPoint
from .fingerprints import of_settings, of_stages
from .large_strain import warn_of_large_prestress
from .loads import Stage
from .problem import Problem
from .processes import refuse_differences, together
from .results import StageResult, UnstableStateWarning
from .rigid_motion import check_supports
from .structure import Structure

FEW = 4  # a point that takes more is followed by a shorter step
TURN = 0.2  # angle between a step and the tangent at its end [rad]; a larger one is followed by a shorter step
SHARP = 0.6  # a step with a larger angle is taken back and halved,
COARSE = 1.5  # and so is one over which the load factor changes by more than so many times what it should,
KINK = 4  # but not more often than that: where cables or cells slacken the path has a kink
HALVINGS = 12
FLAT = 1e-5  # largest cosine between the path and the axis of the load factor at a limit point
SEARCH = 10  # most trials for one


class ContinuationError(RuntimeError):
    """A path has no start, or no further point was found.

    Attributes:
        path: The path as far as it was found.
    """

    def __init__(self, message: str, path: EquilibriumPath):
        super().__init__(message)
        self.path = replace(path, reason=message)


def trace(
    start: Structure | StageResult,
    stage: Stage,
    load_factor: float | None = 1.0,
    displacement: tuple[int, str, float] | None = None,
    max_points: int = 200,
    rtol: float = 1e-10,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> EquilibriumPath:
    """Equilibrium states of a stage in the order in which they follow from each other, by arc length.

    The load factor, which multiplies the stage's own loads and prescribed displacements, grows from 0, falls where the
    structure snaps through, and so on. From point to point it changes by 1 / `stage.steps`, seldom by up to half as
    much more; where the path turns, points are closer, and where the load factor turns is a point: a limit point. At a
    bifurcation the path goes straight on, and only `negative_pivots` tells.

    Args:
        start: The structure, if its reference shape is in equilibrium or nearly so; or the final state of the stage
            that this one comes after.
        stage: What is applied.
        load_factor: Where the path ends, whatever way it takes there, above 0; None: nowhere. For the other sense, turn
            the loads.
        displacement: A node, one of the components "x", "y" and "z", and its displacement [m]: where the path ends too.
            The component must be free, or one that the stage moves.
        max_points: Most points, the start included.
        rtol: Converged when the 2-norm of the unbalanced forces is below rtol times that of all nodal forces,
            reactions and loads included, or at rounding.
        comm: The processes that share the work; each must give the same start and stage.

    Raises:
        ValueError: The stage does not fit the structure or the start, or moves nothing; the structure is not
            supported; an argument is out of its range.
        ContinuationError: The start is not in equilibrium or has a singular tangent, or no next point was found; what
            was found is on the exception.

    Warns:
        UnstableStateWarning: The start is not stable.
        LargeStrainWarning: Strains that belong to the prestress of a structure are above 5 %.
    """
    with together(comm):
        validation.instance("trace start", start, Structure | StageResult)
        validation.instance("trace stage", stage, Stage)
        validation.whole("trace max_points", max_points)
        validation.tolerance("trace rtol", rtol)
        structure = start if isinstance(start, Structure) else start.structure
        _check_stage(structure, start, stage)
    state = () if isinstance(start, Structure) else (start.displacement, start.actions)
    given = {"load_factor": load_factor, "displacement": displacement, "max_points": max_points, "rtol": rtol}
    refuse_differences(comm, lambda: of_settings({"start": state} | given) | of_stages([stage]))
    shape = np.zeros(structure.points.shape) if isinstance(start, Structure) else start.displacement
    before = load_case.unloaded(structure) if isinstance(start, Structure) else start.actions
    problem = Problem(structure, comm)
    after = load_case.target(problem, stage, before)
    check_supports(structure, after.held)
    begin = load_case.taking_hold(before, after, shape)
    fixed = after.held & (after.displacement == begin.displacement)
    ends = path_ends.ends(problem, load_factor, displacement, fixed)
    path = EquilibriumPath(stage.name, structure, begin, after, (), False, reason="")
    x = problem.discretization.distribute(shape)
    with together(comm):
        if isinstance(start, Structure) and comm.rank == 0:  # a state has been remarked on
            warn_of_large_prestress(structure, stacklevel=3)
    newton = BorderedNewton(problem, path.start, path.end, x, rtol)
    try:
        return _Tracer(newton, path, 1 / stage.steps).run(x, ends, max_points)
    finally:
        newton.free()


def _check_stage(structure: Structure, start: Structure | StageResult, stage: Stage) -> None:
    name = None if isinstance(start, Structure) else start.name
    if stage.after != name:
        given = "a structure" if name is None else f"the final state of {name!r}"
        raise ValueError(
            f"Stage {stage.name!r} has after={stage.after!r}, but the path starts from {given}; "
            f"start from what the stage comes after, or give it after={name!r}."
        )
    loads.check(structure, [replace(stage, after=None)])


class _Arrival(NamedTuple):
    """A point and what its tangent tells: the direction of the path there, its angle to the way from the last point."""

    point: Point
    direction: Step
    turn: float
    negative_pivots: int | None


class _Tracer:
    """Follows a path.

    Attributes:
        path: What was found.
        share: Largest change of the load factor from point to point, as predicted.
        psi: Weight of the load factor.
    """

    def __init__(self, newton: BorderedNewton, path: EquilibriumPath, share: float):
        self.newton, self.path, self.share = newton, path, share
        self.psi = 1.0

    def run(self, x: PETSc.Vec, ends: list[Plane], max_points: int) -> EquilibriumPath:
        """The path from a shape on."""
        here = self.start(x)
        self.record(here)
        self.warn_of_unstable_start(here)
        length = self.share / here.direction.factor
        while not self.path.complete and len(self.path.points) < max_points:
            last = here
            _dolfinx.free_dropped(self.newton.problem.discretization.comm)
            here, length, complete = self.next(last, length, ends)
            if last.direction.factor * here.direction.factor < 0 and len(self.path.points) < max_points - 1:
                limit = self.limit_point(last, here)
                end = limit and path_ends.passed(last.point, limit.point, ends)  # and passed again behind it
                point = end and self.newton.find(*end)
                if point:
                    here, complete = self.arrive(last, point), True
                else:
                    self.record(limit)
            self.record(here, complete)
            pace = min(math.sqrt(FEW / len(here.point.iterations)), TURN / max(here.turn, 1e-300))
            longest = self.share / max(abs(here.direction.factor), 1e-300)
            length = min(length * min(max(pace, 0.5), 2.0), longest)
        return replace(self.path, reason="complete" if self.path.complete else self.too_few_points())

    def too_few_points(self) -> str:
        """Why a path that is not complete ends without being lost."""
        factors = self.path.load_factors
        return (
            f"ended after {len(factors)} points, the most it was to have (max_points), at load factor "
            f"{factors[-1]:.6g}; on the way it was between {factors.min():.6g} and {factors.max():.6g}. Allow more "
            "points, or fewer steps of the stage (steps=...)."
        )

    def warn_of_unstable_start(self, here: _Arrival) -> None:
        """Warns where the start is not stable by more than the buckles of wrinkled and slack cells."""
        problem = self.newton.problem
        if not here.negative_pivots:
            return
        problem.apply(self.path.start)
        if downhill(problem, here.point.x).negative:
            warnings.warn(
                f"The path of stage {self.path.name!r} starts from an equilibrium that is not stable (negative "
                f"pivots: {here.negative_pivots}), and what follows may not be what the structure does; "
                "stability(state) shows how it gives way. Add supports, members or prestress against that, or start "
                "from a stable state.",
                UnstableStateWarning,
                stacklevel=4,
            )

    def start(self, x: PETSc.Vec) -> _Arrival:
        """Equilibrium at the load factor 0."""
        newton = self.newton
        point = newton.find(Point(x, 0.0), Plane(newton.zero, 1.0, 0.0))
        if point is None or not newton.linearize(point.x):
            reason = "it is not in equilibrium." if point is None else linear_failure(newton.problem, newton.A)
            raise ContinuationError(
                f"The path of stage {self.path.name!r} has no start: {reason} Bring the structure to equilibrium by a "
                "stage of an `Analysis`, and start from its result.",
                self.path,
            )
        self.psi = float(newton.along.norm())
        if not self.psi > 1e-14 * newton.size:
            raise ValueError(f"Stage {self.path.name!r} moves nothing; give it loads or prescribed displacements.")
        return _Arrival(point, self.direction(Step(newton.zero, 1.0)), 0.0, newton.negative_pivots())

    def next(self, last: _Arrival, length: float, ends: list[Plane]) -> tuple[_Arrival, float, bool]:
        """The next point, the length of the step to it, and whether it is an end."""
        for halvings in range(HALVINGS + 1):
            point = self.find(last, length)
            end = point and path_ends.passed(last.point, point, ends)
            if end:
                point = self.newton.find(*end)
                if point and not 0 <= self.product(last.direction, point.since(last.point)) <= length * (1 + 1e-6):
                    point = None  # not between the two
            if point:
                here = self.arrive(last, point)
                fine = here.turn <= SHARP and abs(point.factor - last.point.factor) <= COARSE * self.share
                if fine or halvings >= KINK:
                    return here, length, end is not None
            length /= 2
        raise ContinuationError(
            f"The path of stage {self.path.name!r} was lost after {len(self.path.points)} points, at load factor "
            f"{last.point.factor:.6g}: no next point, however near. Give the stage more steps (steps=...), so that "
            "points are closer; where the structure wrinkles or slackens, a larger compression_stiffness; a larger "
            "rtol if that asks for more digits than rounding leaves.",
            self.path,
        )

    def find(self, last: _Arrival, length: float) -> Point | None:
        """The point at a length from another; None if there is none to be found."""
        plane = Plane(last.direction.x, self.psi**2 * last.direction.factor, 0.0)
        plane = plane._replace(distance=plane.beyond(last.point) + length)
        return self.newton.find(last.point.moved(last.direction, length), plane)

    def arrive(self, last: _Arrival, point: Point) -> _Arrival:
        """Where the path goes on from a point that follows another."""
        step = point.since(last.point)
        onward = self.direction(step) if self.newton.linearize(point.x) else self.unit(step)
        cosine = self.product(step, onward) / math.sqrt(self.product(step, step))
        return _Arrival(point, onward, math.acos(min(max(cosine, -1.0), 1.0)), self.newton.negative_pivots())

    def limit_point(self, last: _Arrival, here: _Arrival) -> _Arrival | None:
        """The point between two at which the load factor turns, by false position (Pegasus); None at a kink."""
        a, slope_a = 0.0, last.direction.factor
        b, slope_b = self.product(last.direction, here.point.since(last.point)), here.direction.factor
        for _ in range(SEARCH):
            length = (a * slope_b - b * slope_a) / (slope_b - slope_a)
            point = self.find(last, length)
            if not point:
                return None
            found = self.arrive(last, point)
            slope = found.direction.factor
            if self.psi * abs(slope) <= FLAT:
                return found
            if slope * slope_b < 0:
                a, slope_a = b, slope_b
            else:
                slope_a *= slope_b / (slope_b + slope)
            b, slope_b = length, slope
        return None

    def direction(self, step: Step) -> Step:
        """The tangent of the path, of unit length, on from a step."""
        tangent = Step(self.newton.along, 1.0)
        return self.unit(tangent, backwards=self.product(tangent, step) < 0)

    def unit(self, step: Step, backwards: bool = False) -> Step:
        scale = (-1 if backwards else 1) / math.sqrt(self.product(step, step))
        x = step.x.copy()
        x.scale(scale)
        return Step(x, scale * step.factor)

    def product(self, a: Step, b: Step) -> float:
        return float(a.x.dot(b.x)) + self.psi**2 * a.factor * b.factor

    def record(self, found: _Arrival | None, complete: bool = False) -> None:
        """Adds a point to the path, if there is one."""
        if found:
            x, factor, iterations = found.point
            shape = self.newton.problem.discretization.gather(x)
            point = PathPoint(factor, shape, found.negative_pivots, iterations)
            self.path = replace(self.path, points=(*self.path.points, point), complete=complete)
