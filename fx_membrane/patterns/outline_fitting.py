"""Outer loop of cutting patterns: flat outlines move until the stress after assembly is nearest to that of the design.

Least squares with exact gradients, see `sewn_roof`, under equal lengths of both sides of seams. The method is scipy's
trust region for equality constraints. Its Hessian is that of Gauss and Newton, as products with vectors: two solves
with the tangent of the equilibrium each.

Points of a seam that slide along it on both sides change the mesh, not the cloth. The stress changes by the error of
the mesh alone. The strain energy of the motion, with a small weight, keeps these points where they are. It leaves that
share of an error that the outlines could remove.

Source: R. H. Byrd, M. E. Hribar, J. Nocedal, SIAM J. Optim. 9 (1999) 877-900, for the method; J. Nocedal, S. J. Wright,
Numerical Optimization (2006), section 10.3, for least squares.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.optimize import NonlinearConstraint, OptimizeResult, minimize
from scipy.sparse.linalg import LinearOperator

from ..checks import validation
from ..model.loads import Load
from ..runtime.processes import together
from ..solvers.base import Solver
from ..solvers.newton import Newton
from ..solvers.progress import Pulse
from .compensated_cloth import map_stretch
from .flat_shapes import refuse_folds
from .flat_strips import CuttingPattern
from .named_membranes import on_strips
from .outline_motion import OutlineMotion
from .pieces import Pieces, pieces_of
from .plane_cells import sides
from .sewn_roof import Linearization, SewnRoof, SewnState
from .stress_fit import StressFit, errors_of

Array = NDArray[np.float64]

CALM = 1e-2  # weight of the strain energy of the motion, as stress
REFUSED = 1e6  # objective of a pattern without equilibrium, over that of the first
FIRST = 0.1  # root mean square of the first trust region, over the edge of a cell
RMS_ROUNDING = 1e-9  # rms error that rounding may have
EQUAL_LENGTHS = 1e-9  # difference of bound lengths over the length that a pattern may have
MEMORY = 3  # accepted steps in a row with less than the tolerance of gain that end the loop


def nearest_stress_pattern(
    pattern: CuttingPattern,
    loads: Sequence[Load] = (),
    *,
    tolerance: float = 1e-4,
    max_iterations: int = 50,
    solver: Solver = Newton(),
    comm: MPI.Intracomm = MPI.COMM_WORLD,
    progress: bool = True,
) -> CuttingPattern:
    """Move the flat outlines of a pattern so that the stress after assembly is nearest to that of the design.

    Nearest is the least mean over the area of the squared Frobenius norm of stress less design. The stress is that in
    equilibrium of the cloth sewn together. Compensation of the given pattern is the start. Inner points
    follow the outlines. Sides of seams keep the difference of their lengths, segment by segment; decompensated edges
    keep their lengths.

    Within strips curvature leaves little to gain over least energy. More is gained at held borders, where strips of
    least energy end without their neighbours. Where cables are the edges, error may move to them from within.
    Compensation by factors that do not fit the prestress is mended, too.

    Args:
        pattern: The pattern, as of `cutting_pattern`.
        loads: As of `prove_pattern`.
        tolerance: Relative decrease of the sum of squares in a step that counts as none [-].
        max_iterations: Maximum number of steps.
        solver: As of `Analysis`.
        comm: The processes that share the work.
        progress: True to report the progress on stderr.

    Returns:
        The pattern with new cloth; its `fit` tells the errors before and after. The pattern is the best one found where
        the steps end early, and `fit.remark` says why.

    Raises:
        ValueError: It is no pattern; the design has no prestress; chambers with gas, ponds or ropes act; a number is
            not positive; as of `reassembled` and `Analysis.run`.
        ConvergenceError: The strips of the given pattern, sewn together, find no equilibrium.

    Example:
        >>> points, triangles = rectangle(8.0, 6.0, 8, 6)
        >>> points[:, 2] = points[:, 0] * points[:, 1] / 12.0  # a hypar, cut along a cable
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable(polyline(range(27, 36)), 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> short = cutting_pattern(cut_strips(roof, ["valley"]), compensation=0.99)  # too short for the prestress
        >>> pattern = nearest_stress_pattern(short, progress=False)
        >>> pattern.fit.converged, bool(pattern.fit.after.rms < 0.5 * pattern.fit.before.rms)
        (True, True)

    Source:
        Least squares of the stress after assembly: J. Linhard, R. Wüchner, K.-U. Bletzinger, Int. J. Struct. Stab. 8
        (2008); K.-U. Bletzinger, J. Linhard, R. Wüchner, in: CISM 519 (2010).
    """
    with together(comm):
        validation.plain("nearest_stress_pattern pattern", pattern, CuttingPattern)
        tolerance = validation.positive("nearest_stress_pattern tolerance", tolerance)
        max_iterations = validation.positive_integer("nearest_stress_pattern max_iterations", max_iterations)
        pieces = pieces_of(pattern.strips)
        given = on_strips("nearest_stress_pattern loads", pattern.strips, loads)
    roof = SewnRoof(pattern, pieces, given, solver, comm, progress)
    kept = tuple(one for one in pattern.decompensated if isinstance(one, str))
    motion = OutlineMotion(pattern.strips, pieces, roof.start.places, kept)
    pulse = Pulse("nearest stress", comm.rank == 0 and progress)
    search = Search(roof, motion, pulse, tolerance)
    if roof.start.objective > RMS_ROUNDING**2 / 2:
        search.run(max_iterations)
    else:
        search.converged = True
    search.close()
    return _pattern(pattern, pieces, roof, search)


class Search:
    """Search for the outlines of the nearest stress, whose best pattern is kept; collective.

    Args:
        roof: The roof.
        motion: The outlines.
        pulse: Sign of life.
        tolerance: Relative decrease of the objective that counts as none [-].

    Attributes:
        best: State of the best pattern.
        tried: Number of patterns tried.
        converged: No step lowers the objective any more.
        remark: Reason for an early end.
    """

    def __init__(self, roof: SewnRoof, motion: OutlineMotion, pulse: Pulse, tolerance: float):
        self._roof, self._motion, self._pulse, self._tolerance = roof, motion, pulse, tolerance
        self._scale = roof.start.objective or 1.0
        self._calm = CALM * roof.stiffness / (roof.stress**2 * roof.area.sum() * self._scale)
        zero = np.zeros(motion.count)
        self._near = self.best = roof.start
        self._known: tuple[Array, SewnState | None] = (zero, roof.start)
        self._slopes: tuple[Array, Linearization] | None = None
        self._values: list[float] = []
        self.tried, self.refused, self.converged, self.remark = 0, 0, False, ""

    def run(self, steps: int) -> None:
        """Lower the objective from the first pattern."""
        size = np.sqrt(self._roof.area.mean() * self._motion.count)
        bound = NonlinearConstraint(
            self._motion.differences, 0.0, 0.0, jac=self._motion.slopes, hess=self._motion.curvature
        )
        found = minimize(
            self.objective,
            np.zeros(self._motion.count),
            jac=self.gradient,
            hess=self.hessian,
            constraints=[bound] if self._motion.bound else [],
            method="trust-constr",
            callback=self._stop,
            options={"initial_tr_radius": FIRST * size, "gtol": 0.0, "xtol": 1e-9 * size, "maxiter": steps},
        )
        vanished = found.status == 2  # the trust region
        self.converged = self.converged or (vanished and self._known[1] is not None)
        self._finish(found)

    def close(self) -> None:
        """Free matrices and factors."""
        if self._slopes is not None:
            self._slopes[1].destroy()
            self._slopes = None
        self._roof.release()

    def objective(self, z: Array) -> float:
        """Objective over that of the first pattern, with the strain energy of the motion."""
        state = self._state(z)
        if state is None:
            return REFUSED
        spread = self._motion.spread(z)
        return state.objective / self._scale + self._calm * float(spread @ self._motion.resistance(spread)) / 2

    def gradient(self, z: Array) -> Array:
        """Gradient of the objective, shape (count,) [1/m]."""
        slopes = self._linearized(z).gradient() / self._scale
        return self._motion.gathered(slopes + self._calm * self._motion.resistance(self._motion.spread(z)))

    def hessian(self, z: Array) -> LinearOperator:
        """Products of the Hessian of Gauss and Newton with vectors."""
        slopes = self._linearized(z)

        def product(direction: Array) -> Array:
            self._pulse(self._words())
            spread = self._motion.spread(np.ravel(direction))
            forces = slopes.back(slopes.errors(spread)) / self._scale
            return self._motion.gathered(forces + self._calm * self._motion.resistance(spread))

        return LinearOperator((len(z), len(z)), matvec=product, dtype=np.float64)

    def _state(self, z: Array) -> SewnState | None:
        if not np.array_equal(z, self._known[0]):
            self._pulse(self._words())
            self.tried += 1
            state = self._roof.at(self._motion.places(z), self._near)
            self.refused += state is None
            self._known = z.copy(), state
        return self._known[1]

    def _linearized(self, z: Array) -> Linearization:
        if self._slopes is None or not np.array_equal(z, self._slopes[0]):
            state = self._state(z)
            assert state is not None  # a refused pattern is no step
            if self._slopes is not None:
                self._slopes[1].destroy()
            self._slopes, self._near = (z.copy(), self._roof.linearized(state)), state
        return self._slopes[1]

    def _stop(self, z: Array, state: OptimizeResult) -> bool:
        """Return True if the last accepted steps gained nothing."""
        value = float(state.fun)
        if not self._values or value != self._values[-1]:
            self._values.append(value)
        last = self._values[-MEMORY:]
        if len(last) == MEMORY and last[0] - min(last) < self._tolerance * last[0]:
            self.converged = True
        return self.converged

    def _finish(self, found: OptimizeResult) -> None:
        """Take the pattern found, its seams made as long to rounding, if it is better than the first."""
        z = self._motion.with_equal_seams(found.x)
        state = self._state(z)
        if state is None and self._slopes is not None:
            z, state = self._slopes[0], self._near  # of the last step
            self.converged = False
        if not self.converged:
            self.remark = "more steps are needed; give a larger max_iterations"
            if self.refused:
                self.remark = f"{self.refused} patterns found no equilibrium, or turned a cell over"
        if np.abs(self._motion.differences(z)).max(initial=0.0) > EQUAL_LENGTHS:
            self.converged, self.remark = False, "the pattern found has no equal seams; the given one is kept"
        elif state is not None and state.objective < self._roof.start.objective:
            self.best = state

    def _words(self) -> str:
        rms = np.sqrt(2 * self._near.objective)
        return f"pattern {self.tried}, rms tensor error {100 * rms:.4g} % of {100 * self._first():.4g} %"

    def _first(self) -> float:
        return float(np.sqrt(2 * self._roof.start.objective))


def _pattern(pattern: CuttingPattern, pieces: Pieces, roof: SewnRoof, search: Search) -> CuttingPattern:
    """Pattern of the best state, with its report."""
    best, converged, remark = search.best, search.converged, search.remark
    try:
        refuse_folds(best.places, pieces, "The cloth")
    except ValueError as error:
        best, converged, remark = roof.start, False, str(error)
    borders = [edge.nodes for edge in pattern.strips.edges if not edge.is_seam]
    border = np.isin(pieces.nodes[pieces.triangles], np.concatenate([np.empty(0, np.int64), *borders])).any(axis=1)
    before, after = (errors_of(state.error, roof.area, border) for state in (roof.start, best))
    fit = StressFit(before, after, search.tried, converged, remark)
    if best is roof.start:
        return replace(pattern, fit=fit)
    return replace(
        pattern,
        cloth=pieces.flat_strips(pattern.strips, best.places),
        compensation=_compensation(pattern, pieces, best.places),
        fit=fit,
    )


def _compensation(pattern: CuttingPattern, pieces: Pieces, places: Array) -> dict[str, Array]:
    """Mean ratios of cloth to flat lengths along warp and weft, by strip."""
    found = {}
    for number, name in enumerate(pieces.names):
        flat, cells = pattern.flat[name], pieces.cells_of(number)
        ratios = map_stretch(sides(places, pieces.triangles[cells]) @ np.linalg.inv(sides(flat.points, flat.triangles)))
        found[name] = np.average(np.diagonal(ratios, axis1=1, axis2=2), axis=0, weights=flat.areas)
    return found
