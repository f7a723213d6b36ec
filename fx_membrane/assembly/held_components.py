"""Constrained components of the displacement: supports and prescribed displacements, on vectors and on the tangent."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..runtime.processes import somewhere
from .actions import Actions
from .discretization import Discretization


@dataclass(frozen=True, eq=False)
class Constraints:
    """Constrained components that this process owns, and their displacements; `LoadedProblem.constraints` has them.

    Its methods prepare a linear system of free components. They are collective, and change what they are given.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> problem = Problem(rope)
        >>> loaded = problem.under(problem.actions_of(Stage("pull", [PointLoad(1, (0, 0, -10.0))])))
        >>> x = problem.create_vector()
        >>> b, K = loaded.residual(x), loaded.tangent(x)
        >>> loaded.constraints.constrain_residual(x, b)
        >>> loaded.constraints.constrain_tangent(x, K, b)
        >>> problem.to_numpy(b)[:, 2].tolist()  # reactions are gone
        [0.0, 10.0, 0.0]

    Attributes:
        discretization: The numbering of the components.
        constrained: Their numbers in the PETSc system, shape (count,).
        prescribed: Their displacements, shape (count,) [m].
        stiffness: A typical stiffness, their diagonal entry in the tangent [N/m]: it scales their error to a force.
    """

    discretization: Discretization
    constrained: NDArray[np.int32]
    prescribed: NDArray[np.float64]
    stiffness: float

    @cached_property
    def rows(self) -> NDArray[np.int32]:
        """Positions of the constrained components in this process's part of a vector, shape (count,)."""
        return self.constrained - 3 * self.discretization.first_block

    def constrain_residual(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Replace reactions in the residual by the error of the constrained components times `stiffness` [N]."""
        rows = self.rows
        b.array[rows] = self.stiffness * (x.array_r[rows] - self.prescribed)

    def constrain_tangent(self, x: PETSc.Vec, A: PETSc.Mat, b: PETSc.Vec) -> None:
        """Constrain A dx = b: dx closes the error of constrained components, b gets its effect on others."""
        rows = self.rows
        with self.discretization.work(2) as (gap, work):
            gap.set(0.0)
            gap.array[rows] = x.array_r[rows] - self.prescribed
            if gap.norm():
                A.mult(gap, work)
                b.axpy(-1.0, work)
            b.array[rows] = self.stiffness * gap.array_r[rows]
        self.close(A)

    def close(self, A: PETSc.Mat) -> PETSc.Mat:
        """Replace rows and columns of constrained components by `stiffness` on the diagonal.

        PETSc's `zeroRowsColumns` does not take an upper triangle that several processes share.
        """
        with self.discretization.work(1) as (free,):
            free.set(1.0)
            self.zero_constrained(free)
            A.diagonalScale(free, free)
        count = len(self.constrained)
        each = np.arange(count + 1, dtype=PETSc.IntType)  # one entry in each row
        A.setValuesIJV(each, self.constrained, np.full(count, self.stiffness), rowmap=self.constrained)
        A.assemble()
        return A

    def impose(self, x: PETSc.Vec) -> bool:
        """Impose the prescribed displacements; return True if a component was elsewhere."""
        rows = self.rows
        elsewhere = bool((x.array_r[rows] != self.prescribed).any())
        x.array[rows] = self.prescribed
        return somewhere(self.discretization.comm, elsewhere)

    def zero_constrained(self, v: PETSc.Vec) -> None:
        """Set the entries of constrained components to zero."""
        v.array[self.rows] = 0.0

    def moved(self) -> bool:
        """Return True if a prescribed displacement is not zero."""
        return somewhere(self.discretization.comm, bool(self.prescribed.any()))


def constraints(discretization: Discretization, actions: Actions, stiffness: float) -> Constraints:
    """Constraints of actions, scaled by a stiffness [N/m]."""
    owned = discretization.owned_nodes
    return Constraints(
        discretization, discretization.dofs(actions.held), actions.displacement[owned][actions.held[owned]], stiffness
    )
