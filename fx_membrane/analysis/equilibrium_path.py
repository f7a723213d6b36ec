"""Equilibrium states that follow from each other along a path: load factors, displacements, stability."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..assembly import load_cases
from ..assembly.problem import Actions, Problem
from ..checks import validation, values
from ..model.fingerprints import of_settings
from ..model.structure import Structure
from ..results.evaluation import Recorder
from ..results.remarks import remarked, warn_of_remarks
from ..results.states import Increment, StageResult
from ..runtime.processes import refuse_differences, together
from ..solvers.base import Iteration

NO_LOAD = 1e-9  # load factor, as a share of the largest on a path, at which loads are rounding


class PathPoint(NamedTuple):
    """One equilibrium state.

    Attributes:
        load_factor: Multiplier of the stage's own loads and prescribed displacements.
        displacement: From the reference position, shape (n, 3) [m].
        negative_pivots: Number of negative eigenvalues of the tangent under the loads at this point: 0 where stable. At
            a limit point, where one eigenvalue is zero but for rounding, it may be counted or not. None where the
            tangent is not symmetric: under a pressure without a potential.
        iterations: The iterates of the corrector, what was predicted first.
        limit: Whether the load factor turns here.
        kept: Share of each `compression_stiffness` that was left: 1, but 0.01 at a limit point with wrinkled or slack
            cells, so that they carry no compression there; 1 at one of these where no point was found with less.
    """

    load_factor: float
    displacement: NDArray[np.float64]
    negative_pivots: int | None
    iterations: tuple[Iteration, ...]
    limit: bool = False
    kept: float = 1.0


@dataclass(frozen=True, eq=False, repr=False)
class EquilibriumPath:
    """Equilibrium states of a stage, each near the one before.

    Attributes:
        name: Name of the stage.
        structure: The structure.
        start: What acts on it at the load factor 0.
        end: What acts on it at the load factor 1.
        points: The states; the first is the start.
        complete: Whether the path ends where it was to end.
        reason: In words, why it ends where it does: it is complete, it has as many points as it was to have at most,
            or, on a `ContinuationError`, what that says.
    """

    name: str
    structure: Structure
    start: Actions
    end: Actions
    points: tuple[PathPoint, ...]
    complete: bool
    reason: str

    def __repr__(self) -> str:
        last = f", load factor {self.points[-1].load_factor:.4g}" if self.points else ""
        return f"EquilibriumPath({self.name!r}, {len(self.points)} points{last}, complete={self.complete})"

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
        """Numbers of the points at which the load factor turns, shape (count,).

        Wrinkled and slack cells keep a share of their stiffness, `compression_stiffness`, and with it raise the load
        factors of the points, by 0.05 to 0.2 % at the default of 1e-4 and about in proportion to it. Limit points are
        those of the structure that keeps a hundredth of that, within 0.01 %, unless their `kept` is 1: then
        they are off like the others. Points beside one can be above it by the difference.
        """
        return np.flatnonzero([point.limit for point in self.points])

    def state(self, point: int, comm: MPI.Intracomm = MPI.COMM_WORLD) -> StageResult:
        """All results at a point: stresses, forces, reactions.

        Args:
            point: Number of the point; negative numbers count from the last.
            comm: The processes that share the work; all of them ask for the same point.

        Raises:
            ValueError: There is no such point.

        Warns:
            LargeStrainWarning: Strains are above 5 %.
            UnstableStateWarning: Slack or wrinkled parts carry more than 1 % of the largest force of their kind.
            LostPrestressWarning: No cell of a part has 1 % of its prestress left.
            UnbalancedStateWarning: Unbalanced forces are above 1e-6 of the loads.
        """
        count = len(self.points)
        validation.communicator("state comm", comm)
        with together(comm):
            if not values.is_whole(type(point)) or not -count <= point < count:
                raise ValueError(f"Point {validation.shown(point)} of the path is not there; it has {count} points.")
        chosen = self.points[point]
        refuse_differences(comm, lambda: of_settings({"point": chosen[:2], "end": (self.start, self.end)}))
        problem = Problem(self.structure, comm)
        actions = load_cases.between(self.start, self.end, chosen.load_factor)
        problem.apply(actions)
        x = problem.discretization.distribute(chosen.displacement)
        increment = Increment(chosen.load_factor, chosen.iterations)
        with problem.without_kept_stiffness(chosen.kept):
            loaded = abs(chosen.load_factor) > NO_LOAD * np.abs(self.load_factors).max()
            result = remarked(Recorder(problem)(self.name, x, actions, (increment,)), None, bool(loaded))
        with together(comm):
            warn_of_remarks(result, comm, stacklevel=3)
        return result
