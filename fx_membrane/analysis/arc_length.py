"""Continuation by arc length: equilibrium paths past limit points, as in snap-through, snap-back and inflation.

The load factor is an additional unknown. An additional equation sets the distance of the next point along the
path: it lies in a plane across the tangent of the path, at a given length from the last point,

    t_u . (u - u_n) + psi^2 t_f (factor - factor_n) = length.

psi, the weight of the load factor, is the norm of the first du/dfactor: at the start displacement and load count alike.
The path continues in the sense of the last step. Steps become shorter where Newton's method takes many iterations, and
longer elsewhere. A step that may have missed limit points, or jumped to another branch, is halved (`path_check`).

Source: E. Riks, An incremental approach to the solution of snapping and buckling problems, Int. J. Solids Structures
15 (1979) 529-551.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

from mpi4py import MPI
from petsc4py import PETSc

from .. import _dolfinx
from ..assembly.actions import between, with_constraints_of
from ..checks import validation
from ..checks.values import counted
from ..model.digests import fingerprint, of_settings, of_stages
from ..model.restraint import check_supports
from ..model.stages import Stage
from ..model.structure import Structure
from ..results.states import StageResult
from ..results.strain_limits import warn_of_large_prestress
from ..results.told_states import UnstableStateWarning
from ..runtime.processes import refuse_differences, together
from ..solvers.base import no_monitor
from ..solvers.bordered_newton import BorderedNewton, Plane, Point, Step
from ..solvers.curvature import negative_curvature_direction
from ..solvers.diagnosis import linear_failure
from ..solvers.undefined_terms import undefined_term
from . import path_check, path_ends, path_start
from .path import EquilibriumPath, PathPoint
from .path_geometry import Metric, PathState
from .path_remarks import warn_of_slack_parts
from .path_walk import Walk
from .step_control import StepControl
from .work import Work, WorkDone, WorkLimit


class PathError(RuntimeError):
    """Failure to start a path or to find its next point.

    Attributes:
        path: The path up to the failure.
    """

    def __init__(self, message: str, path: EquilibriumPath):
        super().__init__(message)
        self.path = replace(path, reason=message)


def equilibrium_path(
    start: Structure | StageResult,
    stage: Stage,
    load_factor: float | None = 1.0,
    displacement: tuple[int, str, float] | None = None,
    max_points: int = 200,
    rtol: float = 1e-10,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
    limit: WorkLimit = WorkLimit(),
) -> EquilibriumPath:
    """Equilibrium path of a stage by arc length: a sequence of neighbouring states, the start first.

    The load factor multiplies the stage's own loads and prescribed displacements. It grows from 0, falls after a limit
    point of the load, and so on. From point to point it changes by 1 / `stage.increments`, seldom by up to half as much
    more; points are closer where the path turns. Each limit point, where the load factor turns, is a point of the path.
    The path between points is checked, and steps that are too long are halved. So limit points hardly depend on
    `stage.increments`. At a bifurcation the path continues straight on, and only `negative_pivots` shows it. Small
    loads or imperfections may bend it aside there, and long steps may miss that: compare with more `increments`.

    Args:
        start: The structure, if its reference shape is nearly or exactly in equilibrium; or the final state of the
            stage before this one.
        stage: Loads and prescribed displacements to apply.
        load_factor: Load factor above 0 at which the path ends, however it gets there; None for no end. For the other
            sense, reverse the loads.
        displacement: Node, component "x", "y" or "z", and displacement [m] at which the path ends, too. The component
            must be free, or one that the stage moves.
        max_points: Maximum number of points, the start included.
        rtol: Relative tolerance of the unbalanced forces: their 2-norm over that of all nodal forces, reactions and
            loads included. Rounding counts as converged.
        comm: The processes that share the work; each must give the same start and stage.
        limit: Most work that the path may take.

    Raises:
        ValueError: The stage does not fit the structure or the start, or moves nothing; the structure is not
            supported; an argument is out of its range.
        PathError: The start is not in equilibrium, or its tangent is singular; no next point was found; the limit of
            work is used up; the exception has the path up to there.

    Warns:
        UnstableStateWarning: The start is not stable; or slack or wrinkled parts carry points of the path.
        LargeStrainWarning: Strains that belong to the prestress of a structure are above 5 %.

    Example:
        >>> points = [(-1, 0, 0), (1, 0, 0), (0, 0, 0.4)]
        >>> truss = Structure(points, {"bars": Mast([[0, 2], [1, 2]], 1e5)}, [Support([0, 1]), Support(2, "y")])
        >>> path = equilibrium_path(truss, Stage("push", [PointLoad(2, (0, 0, -3e3))], increments=5))
        >>> path.load_factors[path.limit_points].round(4).tolist()
        [0.6572, -0.6572]
    """
    validation.communicator("equilibrium_path comm", comm)
    with together(comm):
        validation.instance("equilibrium_path start", start, Structure | StageResult)
        validation.plain("equilibrium_path stage", stage, Stage)
        max_points = validation.positive_integer("equilibrium_path max_points", max_points)
        rtol = validation.tolerance("equilibrium_path rtol", rtol)
        structure = start if isinstance(start, Structure) else start.structure
        validation.plain("equilibrium_path limit", limit, WorkLimit)
        path_start.check_stage(structure, start, stage)
    given = {"load_factor": load_factor, "displacement": displacement, "max_points": max_points, "rtol": rtol}
    state = () if isinstance(start, Structure) else (start.displacement, start.actions)
    refuse_differences(
        comm, lambda: of_settings({"start": state} | given) | of_stages([stage]) | {"limit": fingerprint(limit)}
    )
    problem, before, shape = path_start.begun(start, comm)
    after = problem.actions_of(stage, before, shape)
    path_start.refuse_first_water(stage.name, before, after)
    check_supports(structure, after.held, [acting.term for acting in after.terms])
    before, after = problem.with_gas_of_start(before, after, shape, stage.name)
    begin = with_constraints_of(before, after, shape)
    fixed = after.held & (after.displacement == begin.displacement)
    ends = path_ends.ends(problem, load_factor, displacement, fixed, shape)
    path = EquilibriumPath(stage.name, structure, begin, after, (), False, reason="", owner=problem)
    x = problem.to_petsc(shape)
    with together(comm):
        if isinstance(start, Structure) and comm.rank == 0:  # a state already has its remarks
            warn_of_large_prestress(structure, stacklevel=3)
    newton = BorderedNewton(problem, path.start, path.end, x, rtol)
    newton.monitor = Work(limit, comm, no_monitor, what="a path")
    try:
        path = _traced(_Tracer(newton, path, 1 / stage.increments), x, ends, max_points)
    except PathError as error:
        warn_of_slack_parts(problem, error.path, newton.pulse, stacklevel=2)
        raise
    else:
        warn_of_slack_parts(problem, path, newton.pulse, stacklevel=2)
        return path
    finally:
        newton.free()


def _traced(tracer: _Tracer, x: PETSc.Vec, ends: list[Plane], max_points: int) -> EquilibriumPath:
    """Trace a path; a `PathError` has it up to a failure, or to the limit of work."""
    try:
        return tracer.run(x, ends, max_points)
    except WorkDone as done:
        raise PathError(_cut_off(tracer.path, done), tracer.path) from None


def _cut_off(path: EquilibriumPath, done: WorkDone) -> str:
    factors = path.load_factors
    where = (
        f"after {counted(len(factors), 'point')}, at load factor {factors[-1]:.6g}"
        if len(factors)
        else "before its start"
    )
    return f"The path of stage {path.name!r} ended {where}: {done}; allow more (WorkLimit), or fewer increments."


class _Tracer:
    """Continuation of a path.

    Attributes:
        path: The points found.
        share: Predicted maximum change of the load factor from point to point.
    """

    def __init__(self, newton: BorderedNewton, path: EquilibriumPath, share: float):
        self.newton, self.path, self.share = newton, path, share
        self.control = StepControl()

    def run(self, x: PETSc.Vec, ends: list[Plane], max_points: int) -> EquilibriumPath:
        """Follow the path from a shape on."""
        here = self.start(x)
        self.record(here)
        self.warn_of_unstable_start(here)
        length = self.first = self.share / here.direction.factor
        while not self.path.complete and len(self.path.points) < max_points:
            last = here
            _dolfinx.free_dropped(self.newton.problem.comm)
            here, length, complete = self.next(last, length, ends)
            if last.turned(here):
                end = self.pass_limit_point(last, here, ends)
                here, complete = (end, True) if end else (here, complete)
            if len(self.path.points) < max_points:
                self.record(here, complete)
            longest = self.share / max(abs(here.direction.factor), 1e-300)
            length = min(length * self.control.stretch(len(here.point.iterations)), longest)
        return replace(self.path, reason="complete" if self.path.complete else self.too_few_points())

    def pass_limit_point(self, last: PathState, here: PathState, ends: list[Plane]) -> PathState | None:
        """Record the limit point between two points, or return the end of the path if it comes first."""
        limit = self.walk.limit_point(last, here)
        if limit is None:  # it is close to the last point
            points = self.path.points
            self.path = replace(self.path, points=(*points[:-1], points[-1]._replace(limit=True)))
            return None
        end = path_ends.passed(last.point, limit.point, ends)  # and passed again beyond it
        point = end and self.newton.find(*end)
        if point:
            return self.walk.arrive(last, point)
        relaxed = self.walk.without_compression(last, limit, here)
        self.record(relaxed or limit, limit=True, left=self.control.compression_stiffness if relaxed else 1.0)
        return None

    def too_few_points(self) -> str:
        """Sentence on the end of an incomplete path."""
        factors = self.path.load_factors
        return (
            f"ended after {counted(len(factors), 'point')}, the most it was to have (max_points), at load factor "
            f"{factors[-1]:.6g}; on the way it was between {factors.min():.6g} and {factors.max():.6g}. Allow more "
            "points, or fewer increments of the stage."
        )

    def warn_of_unstable_start(self, here: PathState) -> None:
        """Warn of a start with more negative curvature than the buckles of wrinkled and slack cells."""
        problem = self.newton.problem
        if not here.negative_pivots:
            return
        if negative_curvature_direction(problem.under(self.path.start), here.point.x).negative:
            warnings.warn(
                f"The path of stage {self.path.name!r} starts from an equilibrium that is not stable (negative "
                f"pivots: {here.negative_pivots}), and what follows may not be what the structure does; "
                "stability(state) shows how it gives way. Add supports, members or prestress against that, or start "
                "from a stable state.",
                UnstableStateWarning,
                stacklevel=5,
            )

    def start(self, x: PETSc.Vec) -> PathState:
        """Find equilibrium at the load factor 0."""
        newton = self.newton
        words = undefined_term(newton.under(1.0), x)
        if words:
            raise PathError(f"The path of stage {self.path.name!r} has no start: {words}", self.path)
        point = newton.find(Point(x, 0.0), Plane(newton.zero, 1.0, 0.0))
        if point is None or not newton.linearize(point.x, point.factor):
            reason = "it is not in equilibrium." if point is None else linear_failure(newton.under(0.0), newton.A)
            raise PathError(
                f"The path of stage {self.path.name!r} has no start: {reason} Bring the structure to equilibrium by a "
                "stage of an `Analysis`, and start from its result.",
                self.path,
            )
        psi = float(newton.du_load.norm())
        if not psi > 1e-14 * newton.size:
            raise ValueError(f"Stage {self.path.name!r} moves nothing; give it loads or prescribed displacements.")
        self.walk = Walk(newton, Metric(psi), self.control)
        return PathState(point, self.walk.direction(Step(newton.zero, 1.0)), 0.0, newton.negative_pivots())

    def next(self, last: PathState, length: float, ends: list[Plane]) -> tuple[PathState, float, bool]:
        """Find the next point; return it, the length of the step, and True if it is an end."""
        metric = self.walk.metric
        for halvings in range(self.control.halvings + 1):
            point = self.walk.find(last, length)
            end = point and path_ends.passed(last.point, point, ends)
            if end:
                point = self.newton.find(*end)
                if point and not 0 <= metric.product(last.direction, point.since(last.point)) <= length * (1 + 1e-6):
                    point = None  # outside the step
            if point:
                here = self.walk.arrive(last, point)
                if self.fits(last, here, halvings):
                    return here, length, end is not None
            length /= 2
        raise PathError(
            f"The path of stage {self.path.name!r} was lost after {counted(len(self.path.points), 'point')}, at load "
            f"factor {last.point.factor:.6g}: no next point, however near. Give the stage more increments, so that "
            "points are closer; where the structure wrinkles or slackens, a larger compression_stiffness; a larger "
            "rtol if that asks for more digits than rounding leaves.",
            self.path,
        )

    def fits(self, last: PathState, here: PathState, halvings: int) -> bool:
        """Return True if the step is short enough."""
        control, metric = self.control, self.walk.metric
        if metric.length(here.point.since(last.point)) <= control.short * self.first:
            return True
        if not path_check.follows(self.newton, metric, last, here, control):
            return False
        change = abs(here.point.factor - last.point.factor)
        return change <= control.coarse * self.share or halvings >= control.patience

    def record(self, found: PathState, complete: bool = False, limit: bool = False, left: float = 1.0) -> None:
        """Add a point to the path."""
        x, factor, iterations = found.point
        gas = self.newton.problem.under(between(self.path.start, self.path.end, factor)).chambers(x)
        point = PathPoint(factor, self.newton.problem.to_numpy(x), found.negative_pivots, iterations, limit, left, gas)
        self.path = replace(self.path, points=(*self.path.points, point), complete=complete)
