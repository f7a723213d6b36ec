"""Cloth of all strips in the plane: energy, forces and stiffness by the laws of their fabrics."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy import sparse

from ..assembly.actions import unloaded
from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..model.laws import Law
from ..model.parts import Membrane
from ..model.structure import Structure
from ..results.evaluation import StateEvaluator
from .plane_cells import orientation, sides

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


class Cloth:
    """Triangles in the plane that neither wrinkle nor leave it, with their laws; the warp is along the first axis.

    Each process has the whole cloth. Stress-free shapes of cells are numbers: new ones need no compilation.

    Args:
        places: Points in a first shape without a flipped cell, shape (n, 2) [m].
        triangles: Cells of all strips, counter-clockwise, shape (k, 3).
        owner: Number of the strip of each cell, shape (k,).
        laws: Law of each strip.

    Attributes:
        start: The first shape, shape (n, 2) [m].
        triangles: As given.
        owner: As given.
        laws: As given.
    """

    def __init__(self, places: Array, triangles: Integers, owner: Integers, laws: Sequence[Law]):
        self.start, self.triangles, self.owner, self.laws = places, triangles, owner, tuple(laws)
        distinct: list[Law] = []
        for law in laws:
            if law not in distinct:
                distinct.append(law)
        kind = np.array([distinct.index(law) for law in laws])[owner]
        self._cells = {f"law {number}": np.flatnonzero(kind == number) for number in range(len(distinct))}
        parts = {
            name: Membrane(triangles[rows], law, warp=(1, 0, 0), compression_stiffness=1)
            for (name, rows), law in zip(self._cells.items(), distinct, strict=True)
        }
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of slivers and close points: the surface has told them
            structure = Structure(np.column_stack([places, np.zeros(len(places))]), parts)
        self._problem = Problem(structure, MPI.COMM_SELF)
        self._problem.allow_natural_shapes(parts)
        self._blocks = 3 * self._problem.block_of_node
        self._matrix = self._problem.create_matrix()
        self._sides = sides(places, triangles)

    def with_shapes(self, shapes: Array) -> StressFree:
        """Cloth whose cells are free of stress with given sides, as columns, shape (k, 2, 2) [m]."""
        natural = shapes @ np.linalg.inv(self._sides) - np.eye(2)
        actions = unloaded(self._problem.structure)
        given = {name: natural[rows] for name, rows in self._cells.items()}
        return StressFree(self, self._problem.under(replace(actions, natural=given)), shapes)

    def stress(self, stretch: Array) -> Array:
        """Cauchy stress of cells under symmetric stretches from their stress-free shape, both (k, 2, 2) [N/m]."""
        loaded = self.with_shapes(np.linalg.solve(stretch, self._sides)).loaded
        state = StateEvaluator(self._problem)("cloth", loaded, self._problem.create_vector(), ())
        found = np.empty((len(self.triangles), 2, 2))
        for name, rows in self._cells.items():
            found[rows] = state.membrane(name).cauchy[:, :2, :2]
        return found


class StressFree:
    """Cloth with given stress-free shapes of its cells."""

    def __init__(self, cloth: Cloth, loaded: LoadedProblem, shapes: Array):
        self.cloth, self.loaded, self.shapes = cloth, loaded, shapes

    def energy(self, places: Array) -> float:
        """Strain energy of points at places, shape (n, 2) [J]; infinite where a cell is flipped."""
        if not (orientation(sides(places, self.cloth.triangles)) > 0).all():
            return np.inf
        x = self._displacement(places)
        found = self.loaded.energy(x)
        x.destroy()
        return found if np.isfinite(found) else np.inf

    def forces(self, places: Array) -> Array:
        """Gradient of the energy, shape (n, 2) [N]."""
        x = self._displacement(places)
        b = self.loaded.residual(x)
        found = b.array_r[self.cloth._blocks[:, None] + np.arange(2)]
        x.destroy(), b.destroy()
        return np.asarray(found)

    def stiffness(self, places: Array) -> sparse.csr_array:
        """Hessian of the energy, components of a point side by side, shape (2 n, 2 n) [N/m]."""
        x = self._displacement(places)
        pointers, columns, values = self.loaded.tangent(x, self.cloth._matrix).getValuesCSR()
        x.destroy()
        rows = (self.cloth._blocks[:, None] + np.arange(2)).ravel()
        whole = sparse.csr_matrix((values, columns, pointers))
        return whole[rows][:, rows]

    def _displacement(self, places: Array):  # type: ignore[no-untyped-def]
        moved = np.column_stack([places - self.cloth.start, np.zeros(len(places))])
        return self.loaded.discretization.to_petsc(moved)
