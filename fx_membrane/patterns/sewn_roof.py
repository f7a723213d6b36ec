"""Cloth sewn together, as a function of the flat points: equilibrium, distance of its stress from the design, gradient.

    J = 1/2 sum of area |sigma - sigma_wanted|^2 / (area of all cells * s^2),   s the mean stress of the design

The norm is that of Frobenius; sigma is the Cauchy stress in axes that turn with the cell. The displacement is that of
equilibrium: its change under a change of the flat points costs one solve with the tangent K. The gradient costs one
solve with K^T, whatever the number of points is.

Source: M. Hinze, R. Pinnau, M. Ulbrich, S. Ulbrich, Optimization with PDE Constraints, Springer 2009, section 1.6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy import sparse

from ..analysis.stages import Analysis
from ..assembly.problem_under_actions import LoadedProblem
from ..assembly.stress_sensitivity import stress_derivatives, turned_stress
from ..geometry.sizes import measures
from ..model import natural_shape
from ..model.loads import Load
from ..model.parts import Membrane
from ..model.stages import Stage
from ..model.structure import Structure
from ..solvers import factorization, own
from ..solvers.base import Solver, no_monitor
from .flat_strips import CuttingPattern
from .pieces import Pieces
from .plane_cells import gradients, orientation, sides
from .reassembly import reassembled

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SewnState:
    """Equilibrium of cloth sewn together.

    Attributes:
        places: Flat points, shape (n, 2) [m].
        loaded: The structure under its actions.
        displacement: Displacement from the designed shape, shape (nodes, 3) [m].
        error: Difference of stress and design over the mean stress of the design, shape (cells, 2, 2) [-].
        objective: J [-].
    """

    places: Array
    loaded: LoadedProblem
    displacement: Array
    error: Array
    objective: float


class SewnRoof:
    """Roof of a pattern, whose flat points may move; collective.

    Args:
        pattern: The first pattern.
        pieces: Its strips, apart from each other.
        loads: Loads in the designed shape beside prestress.
        solver: As of `Analysis`.
        comm: The processes that share the work.
        progress: As of `Analysis`.

    Attributes:
        start: Equilibrium of the first pattern.
        area: Areas of the cells on the surface, shape (cells,) [m2].
        stress: Mean stress of the design, s [N/m].
        stiffness: Mean stiffness of the cloth [N/m].

    Raises:
        ValueError: The design has no prestress; gas or water in chambers, ropes or ponds tie the forces of all nodes.
        ConvergenceError: The first pattern finds no equilibrium.
    """

    def __init__(
        self,
        pattern: CuttingPattern,
        pieces: Pieces,
        loads: Sequence[Load],
        solver: Solver,
        comm: MPI.Intracomm,
        progress: bool,
    ):
        structure, self._pieces = reassembled(pattern), pieces
        self._names = pattern.strips.names
        cells = [structure.part(name, Membrane).cells for name in self._names]
        self._ends = np.cumsum([len(some) for some in cells])[:-1]
        self.area = measures(structure.points, np.concatenate(cells))
        stiffness = [pattern.strips.membrane(name).material.stiffness for name in self._names]
        self.stiffness = float(np.repeat(stiffness, [len(some) for some in cells]) @ self.area / self.area.sum())
        self._wanted = _wanted(pattern, structure)
        self.stress = float(self.area @ np.abs(np.trace(self._wanted, axis1=1, axis2=2))) / 2 / self.area.sum()
        if not self.stress:
            raise ValueError(
                "The design has no prestress that the stress of the cloth could come near to; give its membranes one."
            )
        self._shape = _frame_sides(structure, self._names)
        analysis = Analysis(structure, solver, comm, progress=progress)
        state = analysis.run([Stage("assembly", loads)])["assembly"]
        self._problem, self._solve = analysis.problem, own.prepared(solver, analysis.problem)
        self._actions = state.actions
        loaded = self._problem.under(state.actions)
        if loaded.integrals.all:
            raise ValueError(
                "The nearest stress is not found beside chambers with gas, ponds or ropes; give loads that replace "
                "them, as a Pressure."
            )
        places = np.concatenate([pattern.cloth[name].points for name in self._names])
        self.start = self._state(places, loaded, state.displacement)

    def release(self) -> None:
        """Free the factors of the solver; collective."""
        own.release(self._solve)

    def at(self, places: Array, near: SewnState) -> SewnState | None:
        """Equilibrium of other flat points, from a near one; None if there is none, or a cell is flipped."""
        flat = sides(places, self._pieces.triangles)
        if not (orientation(flat) > 0).all():
            return None
        natural = flat @ np.linalg.inv(self._shape)
        try:
            natural_shape.check("cloth", natural)
        except ValueError:
            return None
        by_name = dict(zip(self._names, np.split(natural - np.eye(2), self._ends), strict=True))
        actions = replace(self._actions, natural={**self._actions.natural, **by_name})
        loaded, x = self._problem.under(actions), self._problem.to_petsc(near.displacement)
        try:
            if not self._solve(loaded, x, no_monitor, False).converged:
                return None
            return self._state(places, loaded, self._problem.to_numpy(x))
        finally:
            x.destroy()

    def linearized(self, state: SewnState) -> Linearization:
        """Differentiate in a state."""
        flat = sides(state.places, self._pieces.triangles)
        inverse = self._shape @ np.linalg.inv(flat)  # I + H
        blocks = -np.einsum("kia,kvj->kijva", inverse, gradients(flat))
        columns = 2 * self._pieces.triangles[:, :, None] + np.arange(2)
        count = 4 * len(flat)
        rows = np.repeat(np.arange(count), 6)
        shape_by_places = sparse.csr_matrix(
            (blocks.ravel(), (rows, np.repeat(columns.reshape(-1, 6), 4, axis=0).ravel())),
            shape=(count, state.places.size),
        )
        weight = np.repeat(self.area / self.area.sum(), 4)
        return Linearization(state, self._names, shape_by_places, weight, self.stress)

    def _state(self, places: Array, loaded: LoadedProblem, displacement: Array) -> SewnState:
        x = self._problem.to_petsc(displacement)
        error = (turned_stress(loaded, x, self._names) - self._wanted) / self.stress
        x.destroy()
        objective = float(self.area @ (error**2).sum(axis=(1, 2))) / 2 / float(self.area.sum())
        return SewnState(places, loaded, displacement, error, objective)


class Linearization:
    """Derivatives of the stress error by the flat points, in equilibrium; collective.

    Args:
        state: The state.
        names: Names of the strips.
        shape_by_places: Derivative of H of the cells by the flat points, shape (4 cells, 2 n) [1/m].
        weight: Share of the area, for each component of each cell, shape (4 cells,) [-].
        stress: Mean stress of the design [N/m].
    """

    def __init__(
        self, state: SewnState, names: Sequence[str], shape_by_places: sparse.csr_matrix, weight: Array, stress: float
    ):
        self._state, self._weight, self._stress = state, weight, stress
        loaded = state.loaded
        x = loaded.discretization.to_petsc(state.displacement)
        found = stress_derivatives(loaded, x, names)
        self._by_displacement = found.by_displacement
        self._by_places = (found.by_shape @ shape_by_places).tocsr()
        self._residual_by_places = (found.residual_by_shape @ shape_by_places).tocsr()
        self._tangent = loaded.tangent(x)
        loaded.constraints.close(self._tangent)
        x.destroy()
        self._ksp = PETSc.KSP().create(loaded.comm)
        factorization.choose(self._ksp, self._tangent, symmetric=False)
        self._ksp.setOperators(self._tangent)

    def gradient(self) -> Array:
        """Gradient of J by the flat points, shape (2 n,) [1/m]."""
        return self.back(self._state.error.ravel())

    def errors(self, change: Array) -> Array:
        """Change of the stress errors with a change of the flat points, shape (2 n,) [m]; shape (4 cells,) [-]."""
        move = -self._solved(self._residual_by_places @ change, turned=False)
        return np.asarray(self._by_displacement @ move + self._by_places @ change) / self._stress

    def back(self, errors: Array) -> Array:
        """Transpose of `errors`, weighted with the areas: from (4 cells,) to (2 n,)."""
        dual = self._weight * errors / self._stress
        multiplier = self._solved(self._by_displacement.T @ dual, turned=True)
        return np.asarray(self._by_places.T @ dual - self._residual_by_places.T @ multiplier)

    def destroy(self) -> None:
        """Free the factors."""
        self._ksp.destroy()
        self._tangent.destroy()

    def _solved(self, forces: Array, turned: bool) -> Array:
        """Solve with the tangent, or its transpose, free components alone, shape (3 nodes,)."""
        loaded = self._state.loaded
        b = loaded.discretization.to_petsc(forces.reshape(-1, 3))
        loaded.constraints.zero_constrained(b)
        y = b.duplicate()
        (self._ksp.solveTranspose if turned else self._ksp.solve)(b, y)
        found = loaded.discretization.to_numpy(y).ravel()
        b.destroy(), y.destroy()
        return found


def _wanted(pattern: CuttingPattern, sewn: Structure) -> Array:
    """Stress of the design in axes of the threads of the sewn cloth, shape (cells, 2, 2) [N/m]."""
    found, design = [], pattern.strips.structure
    for name in pattern.strips.names:
        turn = _frame(sewn, name) @ _frame(design, name).transpose(0, 2, 1)
        stress = design.part(name, Membrane).prestress_tensors()
        found.append(turn @ stress @ turn.transpose(0, 2, 1))
    return np.concatenate(found)


def _frame(structure: Structure, name: str) -> Array:
    """Warp and weft of the cells as rows, shape (k, 2, 3)."""
    warp = structure.warp(name)
    return np.stack([warp, np.cross(structure.normals(name), warp)], axis=1)


def _frame_sides(structure: Structure, names: Sequence[str]) -> Array:
    """Sides of the cells on the surface in axes of warp and weft, as columns, shape (cells, 2, 2) [m]."""
    return np.concatenate(
        [_frame(structure, name) @ sides(structure.points, structure.part(name, Membrane).cells) for name in names]
    )
