"""Newton's equations of the nearest stress: equilibrium, the optimum over shapes, and an even mesh, solved at once."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy import sparse

from ...geometry.sizes import measures
from ...geometry.vector_columns import columns
from ...solvers import factorization
from .assembly import assembled
from .cells import Block
from .mesh_control import MeshControl, Ways
from .shape_derivatives import curvatures_by_shape, slopes_by_shape

Array = NDArray[np.float64]


class Steered(NamedTuple):
    """Lines of cables of given geometry, whose forces are unknowns, as shares of those at hand.

    Attributes:
        pulls: Unbalanced forces of each line on the nodes, shape (3 n, k) [N].
        slopes: Derivatives of its energy by the shape, shape (3 n, k).
        gradients: Those of its relative difference from the wanted geometry, shape (3 n, k) [1/m].
        gaps: That difference, shape (k,).
    """

    pulls: Array
    slopes: Array
    gradients: Array
    gaps: Array


class System(NamedTuple):
    """Derivatives of the function of multipliers and shape, see `nearest_cells`.

    Attributes:
        forces: First ones by the multipliers, the unbalanced forces, shape (3 n,) [N].
        slopes: First ones by the shape, shape (3 n,).
        stiffness: Second ones by the multipliers, sparse (3 n, 3 n).
        mixed: Those of the forces by the shape.
        curvature: Second ones by the shape.
        mass: Area at each component of the nodes, shape (3 n,) [m2].
        control: Control of the mesh.
        ways: Directions of the nodes.
        evenness: Imbalance of the mesh, shape (k,).
        evening: Its derivatives by the shape, sparse (k, 3 n).
        bodies: Derivatives of the forces on bodies along their motions by these, the last of a basis, (b, b).
        multipliers: The multipliers, shape (3 n,).
        steered: Lines of given geometry.
    """

    forces: Array
    slopes: Array
    stiffness: sparse.csr_matrix
    mixed: sparse.csr_matrix
    curvature: sparse.csr_matrix
    mass: Array
    control: MeshControl
    ways: Ways
    evenness: Array
    evening: sparse.csr_matrix
    bodies: sparse.csr_matrix
    multipliers: Array
    steered: Steered


def system_of(
    blocks: Sequence[Block],
    control: MeshControl,
    point_loads: Array,
    points: Array,
    multipliers: Array,
    steered: Steered,
    near: bool,
) -> System:
    """Assemble the derivatives in a shape with multipliers, both of shape (n, 3), under forces on the nodes [N].

    Near the optimum those of the mesh are exact, elsewhere convex.
    """
    n = len(points)
    forces, slopes, mass = -point_loads.copy(), np.zeros((n, 3)), np.zeros(n)
    matrices: list[list[tuple[NDArray[np.int64], Array]]] = [[], [], []]
    for block in blocks:
        corners, there = points[block.cells], multipliers[block.cells]
        size = measures(points, block.cells)
        length = np.sqrt(size) if block.cells.shape[1] == 3 else size
        at, pulls = columns(corners), columns(there)
        turned, slope = slopes_by_shape(block, at, pulls, length)
        for corner, part, rise in zip(block.cells.T, block.forces(at, pulls), slope, strict=True):
            np.add.at(forces, corner, part.T)
            np.add.at(slopes, corner, rise.T)
            np.add.at(mass, corner, length**2 / block.cells.shape[1])
        curvature = curvatures_by_shape(block, at, pulls, length)
        for entries, blockwise in zip(matrices, (block.stiffnesses(corners), turned, curvature), strict=True):
            entries.append((block.cells, blockwise))
    ways = control.ways(points)
    stiffness, mixed, curved = (assembled(n, entries) for entries in matrices)
    evenness, evening = control.imbalance(points, ways), control.derivatives(points, ways, near)
    bodies = control.guide.turning(points, forces)
    return System(
        forces.ravel(),
        slopes.ravel(),
        stiffness,
        mixed,
        curved,
        np.repeat(mass, 3),
        control,
        ways,
        evenness,
        evening,
        bodies,
        multipliers.ravel(),
        steered,
    )


class Equations(NamedTuple):
    """Newton's equations along the motions of the nodes, without damping.

    Attributes:
        solved: Solver for values of their matrix and right sides: the pattern is analysed once for all tries of a step.
        values: Entries of the matrix, by multipliers, shape across and along the ways, and forces of given lines.
        damped: Squared motion across the surface, in the places of these entries [m2].
        right: Right sides, of multipliers, of the shape across the ways, of the mesh, and of
            lines of given geometry.
        basis: Motions of the nodes, sparse (3 n, m).
        ways: Directions of the nodes.
    """

    solved: Callable[[Array, Array], Array]
    values: Array
    damped: Array
    right: tuple[Array, Array, Array, Array]
    basis: sparse.csr_matrix
    ways: Ways


def equations_of(system: System, basis: sparse.csr_matrix) -> Equations:
    """Project the derivatives on the motions of the nodes, sparse (3 n, m)."""
    across, along, bodies = system.ways
    curved, mixed = across.T @ system.curvature, basis.T @ system.mixed
    turning = _last(system.bodies @ bodies.across, (basis.shape[1], across.shape[1]))
    spinning = _last(system.bodies @ bodies.along, (basis.shape[1], along.shape[1]))
    lines = system.steered
    pulls, bent = sparse.csr_matrix(basis.T @ lines.pulls), sparse.csr_matrix(across.T @ lines.slopes)
    rows = [
        [basis.T @ system.stiffness @ basis, mixed @ across + turning, mixed @ along + spinning, pulls],
        [across.T @ mixed.T + turning.T, curved @ across, curved @ along, bent],
        [None, system.evening @ across, system.evening @ along, None],
        [None, *(sparse.csr_matrix(lines.gradients.T @ ways) for ways in (across, along)), None],
    ]
    slopes = across.T @ system.slopes + turning.T @ (basis.T @ system.multipliers)
    matrix, damped = _in_one_pattern(
        sparse.bmat(rows if len(lines.gaps) else [row[:3] for row in rows[:3]]),
        across.T @ sparse.diags(system.mass) @ across,
        basis.shape[1],
    )
    return Equations(
        _solver(matrix),
        matrix.data,
        damped,
        (basis.T @ system.forces, slopes, system.evenness, lines.gaps),
        basis,
        system.ways,
    )


def step_of(equations: Equations, damping: float, share: float = 1.0) -> tuple[Array, Array]:
    """Newton step of the multipliers and of the shape, both of shape (n, 3), damped like that of Levenberg.

    Args:
        equations: The equations.
        damping: Factor of the squared motion across the surface, over the area, beside the function.
        share: Share of the imbalance of the mesh that is removed.
    """
    forces, slopes, evenness, gaps = equations.right
    right = -np.concatenate([forces, slopes, share * evenness, gaps])
    found = equations.solved(equations.values - damping * equations.damped, right)
    across, along, _ = equations.ways
    count, split = len(forces), len(forces) + len(slopes)
    multipliers = np.asarray(equations.basis @ found[:count])
    shape = across @ found[count:split] + along @ found[split : split + along.shape[1]]
    return multipliers.reshape(-1, 3), np.asarray(shape).reshape(-1, 3)


def _last(block: sparse.csr_matrix, shape: tuple[int, int]) -> sparse.csr_matrix:
    """Matrix with a block in its last rows and columns, and zeros elsewhere."""
    entries = block.tocoo()
    rows, columns = shape[0] - block.shape[0] + entries.row, shape[1] - block.shape[1] + entries.col
    return sparse.coo_matrix((entries.data, (rows, columns)), shape=shape).tocsr()


def _in_one_pattern(matrix: sparse.coo_matrix, block: sparse.csr_matrix, first: int) -> tuple[sparse.csr_matrix, Array]:
    """Matrix with places for a block that begins at a diagonal entry; entries of the block in all these places."""
    entries, added = matrix.tocoo(), block.tocoo()
    places = (
        np.concatenate([entries.row, first + added.row]),
        np.concatenate([entries.col, first + added.col]),
    )
    alone = np.concatenate([entries.data, np.zeros_like(added.data)])
    beside = np.concatenate([np.zeros_like(entries.data), added.data])
    one, other = (sparse.coo_matrix((each, places), shape=matrix.shape).tocsr() for each in (alone, beside))
    return one, other.data


def tangential_multipliers(blocks: Sequence[Block], control: MeshControl, point_loads: Array, points: Array) -> Array:
    """Multipliers along the surfaces and lines of a shape that balance the forces there, shape (n, 3)."""
    forces, entries = -point_loads.copy(), []
    for block in blocks:
        corners = points[block.cells]
        entries.append((block.cells, block.stiffnesses(corners)))
        at = columns(corners)
        for corner, part in zip(block.cells.T, block.forces(at, np.zeros_like(at)), strict=True):
            np.add.at(forces, corner, part.T)
    along = control.ways(points).along
    if not along.shape[1]:
        return np.zeros_like(points)
    stiffness = (along.T @ assembled(len(points), entries) @ along).tocsr()
    return np.asarray(along @ _solver(stiffness)(stiffness.data, -(along.T @ forces.ravel()))).reshape(points.shape)


def _solver(matrix: sparse.csr_matrix) -> Callable[[Array, Array], Array]:
    """Solver of systems with the pattern of a matrix, for entries and a right side, on this process alone.

    It raises RuntimeError if the matrix is singular.
    """
    A = PETSc.Mat().createAIJ(matrix.shape, csr=(matrix.indptr, matrix.indices, matrix.data), comm=PETSc.COMM_SELF)
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(A)
    b, x = A.createVecLeft(), A.createVecRight()

    def solved(values: Array, right: Array) -> Array:
        A.setValuesCSR(matrix.indptr, matrix.indices, values)
        A.assemble()
        b.array[:] = right
        for _ in range(2):
            factorization.choose(ksp, A, symmetric=False)
            ksp.solve(b, x)
            if np.isfinite(found := x.array.copy()).all():
                return found
            factorization.release(ksp)  # the order of pivots is that of the first values: take one of these
        raise RuntimeError("Newton's equations of the nearest stress are singular")

    for each in (ksp, A, b, x):
        weakref.finalize(solved, each.destroy)  # petsc4py 3.18 keeps what nobody destroys
    return solved
