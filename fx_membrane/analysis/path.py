"""Equilibrium path: load factors, displacements and stability of a sequence of neighbouring states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..assembly.actions import Actions, between
from ..assembly.gas import ChamberResult
from ..assembly.problem import Problem
from ..checks import validation, values
from ..checks.values import counted
from ..model.digests import of_settings
from ..model.structure import Structure
from ..results.evaluation import StateEvaluator
from ..results.load_increments import NO_CHAMBERS, Increment
from ..results.owner import Owned, problem_of
from ..results.remarks import remarked, warn_of_remarks
from ..results.states import StageResult
from ..runtime.notebook_pictures import picture_html, picture_png
from ..runtime.processes import refuse_differences, together
from ..solvers.base import Iteration

NO_LOAD = 1e-9  # load factor, as a fraction of the largest on a path, at which loads are rounding


class PathPoint(NamedTuple):
    """Equilibrium state on a path.

    Attributes:
        load_factor: Multiplier of the stage's own loads and prescribed displacements.
        displacement: Displacement from the reference position, shape (n, 3) [m].
        negative_pivots: Number of negative eigenvalues of the tangent under the loads at this point: 0 where stable. At
            a limit point, where one eigenvalue is zero up to rounding, it may be counted or not. None for an
            unsymmetric tangent: under a pressure or a `ForceTerm`, without a potential.
        iterations: The iterates of the corrector, the predictor first.
        limit: True if the load factor turns here.
        compression_stiffness: Fraction of that of each part in effect: 1, but 0.01 at a limit point with wrinkled or
            slack cells, so that they carry no compression there. It is 1 at a limit point where no point was found with
            less.
        chambers: Gas in the chambers, by name.

    Example:
        >>> points = [(-1, 0, 0), (1, 0, 0), (0, 0, 0.4)]
        >>> truss = Structure(points, {"bars": Mast([[0, 2], [1, 2]], 1e5)}, [Support([0, 1]), Support(2, "y")])
        >>> path = equilibrium_path(truss, Stage("push", [PointLoad(2, (0, 0, -3e3))], increments=5))
        >>> top = next(point for point in path.points if point.limit)
        >>> round(top.load_factor, 4), round(float(top.displacement[2, 2]), 4), top.compression_stiffness
        (0.6572, -0.1691, 1.0)
    """

    load_factor: float
    displacement: NDArray[np.float64]
    negative_pivots: int | None
    iterations: tuple[Iteration, ...]
    limit: bool = False
    compression_stiffness: float = 1.0
    chambers: Mapping[str, ChamberResult] = NO_CHAMBERS


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPath(Owned):
    """Equilibrium states of a stage, each close to the one before.

    Attributes:
        name: Name of the stage.
        structure: The structure.
        start: Actions at the load factor 0.
        end: Actions at the load factor 1.
        points: The states; the first is the start.
        complete: True if the path reached its end.
        reason: Sentence on why it ends there: it is complete, it has the maximum number of points, or the message of
            its `PathError`.
        owner: The problem on which the path was computed; None in a copy, see `problem`.

    Example:
        >>> points = [(-1, 0, 0), (1, 0, 0), (0, 0, 0.4)]
        >>> truss = Structure(points, {"bars": Mast([[0, 2], [1, 2]], 1e5)}, [Support([0, 1]), Support(2, "y")])
        >>> path = equilibrium_path(truss, Stage("push", [PointLoad(2, (0, 0, -3e3))], increments=5))
        >>> path.complete, len(path.limit_points), int(path.negative_pivots.max())
        (True, 2, 1)
    """

    name: str
    structure: Structure
    start: Actions
    end: Actions
    points: tuple[PathPoint, ...]
    complete: bool
    reason: str
    owner: Problem | None = field(default=None, kw_only=True)

    def __repr__(self) -> str:
        last = f", load factor {self.points[-1].load_factor:.4g}" if self.points else ""
        return f"EquilibriumPath({self.name!r}, {counted(len(self.points), 'point')}{last}, complete={self.complete})"

    def _repr_html_(self) -> str:
        """Show the path and its curve in notebooks."""
        return f"<b>{escape(repr(self))}</b><p>{escape(self.reason)}</p>" + picture_html(self)

    def _repr_png_(self) -> bytes | None:
        """Show a picture where a notebook takes no HTML."""
        return picture_png(self)

    @property
    def load_factors(self) -> NDArray[np.float64]:
        """Load factors of the points, shape (points,)."""
        return np.array([point.load_factor for point in self.points])

    @property
    def displacements(self) -> NDArray[np.float64]:
        """Displacements at the points, shape (points, n, 3) [m]."""
        return np.array([point.displacement for point in self.points]).reshape(-1, *self.structure.points.shape)

    @property
    def negative_pivots(self) -> NDArray[np.int64] | None:
        """Numbers of negative eigenvalues at the points, shape (points,): 0 where stable; None as for the points."""
        counts = [point.negative_pivots for point in self.points]
        return None if None in counts else np.array(counts, dtype=np.int64)

    @property
    def limit_points(self) -> NDArray[np.int64]:
        """Indices of the points at which the load factor turns, shape (count,).

        Wrinkled and slack cells keep a fraction of their stiffness, `compression_stiffness`. It raises the load factors
        of the points about in proportion, by 0.05 to 0.2 % at the default of 1e-4. Limit points are those of the
        structure with a hundredth of that, within 0.01 %. Where their `compression_stiffness` is 1 they have the same
        error as the other points. Points beside a limit point can be above it by the difference.
        """
        return np.flatnonzero([point.limit for point in self.points])

    def state(self, point: int, comm: MPI.Intracomm = MPI.COMM_WORLD) -> StageResult:
        """Compute all results at a point: stresses, forces, reactions.

        Args:
            point: Index of the point; negative numbers count from the last.
            comm: The processes that share the work; all of them ask for the same point.

        Raises:
            ValueError: The path has no point of that number.

        Warns:
            LargeStrainWarning: Strains are above 5 %.
            UnstableStateWarning: Slack or wrinkled parts carry a mast, or more than 1 % of the forces or loads
                connected with them.
            LostPrestressWarning: No cell of a part has 1 % of its prestress left.
            UnbalancedStateWarning: Unbalanced forces are above 1e-6 of the loads.
        """
        count = len(self.points)
        validation.communicator("state comm", comm)
        with together(comm):
            if not values.is_whole(type(point)) or not -count <= point < count:
                raise ValueError(
                    f"Point {validation.short_repr(point)} of the path is not there; it has {counted(count, 'point')}."
                )
        chosen = self.points[point]
        refuse_differences(comm, lambda: of_settings({"point": chosen[:2], "end": (self.start, self.end)}))
        problem = problem_of(self, comm)
        view = problem.under(between(self.start, self.end, chosen.load_factor))
        view = view.without_compression_stiffness(chosen.compression_stiffness)
        x = problem.to_petsc(chosen.displacement)
        increment = Increment(chosen.load_factor, chosen.iterations)
        loaded = abs(chosen.load_factor) > NO_LOAD * np.abs(self.load_factors).max()
        result = remarked(StateEvaluator(problem)(self.name, view, x, (increment,)), None, bool(loaded))
        with together(comm):
            warn_of_remarks(result, comm, stacklevel=3)
        return result
