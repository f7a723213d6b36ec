"""Newton's equations of the nearest stress: equilibrium, the optimum over shapes, and an even mesh, solved at once."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc
from scipy import sparse

from ...geometry.measures import measures
from ...solvers import factorization
from .assembly import assembled
from .cells import Block
from .mesh_control import MeshControl, Ways

Array = NDArray[np.float64]

FIRST = 1e-5  # length of a difference for first derivatives, over the size of the cell
SECOND = 1e-3  # the same, for second ones


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
        bodies: Derivatives of the forces on bodies along their motions by these, the last of the ways across, (b, b).
        multipliers: The multipliers, shape (3 n,).
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


def system_of(
    blocks: Sequence[Block], control: MeshControl, point_loads: Array, points: Array, multipliers: Array, near: bool
) -> System:
    """Take the derivatives in a shape with multipliers, both of shape (n, 3), under forces on the nodes [N].

    Near the optimum those of the mesh are exact, elsewhere convex.
    """
    n = len(points)
    forces, slopes, mass = -point_loads.copy(), np.zeros((n, 3)), np.zeros(n)
    matrices: list[list[tuple[NDArray[np.int64], Array]]] = [[], [], []]
    for block in blocks:
        corners, there = points[block.cells], multipliers[block.cells]
        size = measures(points, block.cells)
        length = np.sqrt(size) if block.cells.shape[1] == 3 else size
        by_shape = _slopes(block, corners, there, FIRST * length)
        for corner, part, slope in zip(
            block.cells.T, block.forces(corners, there).swapaxes(0, 1), by_shape[1].swapaxes(0, 1), strict=True
        ):
            np.add.at(forces, corner, part)
            np.add.at(slopes, corner, slope)
            np.add.at(mass, corner, length**2 / block.cells.shape[1])
        curvature = _curvatures(block, corners, there, SECOND * length)
        for entries, blockwise in zip(matrices, (block.stiffnesses(corners), by_shape[0], curvature), strict=True):
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
    )


def step_of(system: System, basis: sparse.csr_matrix, damping: float, share: float = 1.0) -> tuple[Array, Array]:
    """Newton step of the multipliers and of the shape, both of shape (n, 3), damped like that of Levenberg.

    Args:
        system: The derivatives.
        basis: Motions of the nodes, sparse (3 n, m).
        damping: Factor of the squared motion across the surface, over the area, beside the function.
        share: Share of the imbalance of the mesh that is removed.
    """
    across, along = system.ways
    curved, mixed = across.T @ system.curvature, basis.T @ system.mixed
    turning = _last(system.bodies, (basis.shape[1], across.shape[1]))
    weight = sparse.diags(damping * system.mass)
    matrix = sparse.bmat(
        [
            [basis.T @ system.stiffness @ basis, mixed @ across + turning, mixed @ along],
            [across.T @ mixed.T + turning.T, curved @ across - across.T @ weight @ across, curved @ along],
            [None, system.evening @ across, system.evening @ along],
        ]
    ).tocsr()
    slopes = across.T @ system.slopes + turning.T @ (basis.T @ system.multipliers)
    right = -np.concatenate([basis.T @ system.forces, slopes, share * system.evenness])
    found = _solved(matrix, right)
    count = basis.shape[1]
    split = count + across.shape[1]
    multipliers = np.asarray(basis @ found[:count])
    shape = across @ found[count:split] + along @ found[split:]
    return multipliers.reshape(-1, 3), np.asarray(shape).reshape(-1, 3)


def _last(block: sparse.csr_matrix, shape: tuple[int, int]) -> sparse.csr_matrix:
    """Matrix with a block in its last rows and columns, and zeros elsewhere."""
    entries = block.tocoo()
    rows, columns = shape[0] - block.shape[0] + entries.row, shape[1] - block.shape[1] + entries.col
    return sparse.coo_matrix((entries.data, (rows, columns)), shape=shape).tocsr()


def tangential_multipliers(blocks: Sequence[Block], control: MeshControl, point_loads: Array, points: Array) -> Array:
    """Multipliers along the surfaces and lines of a shape that balance the forces there, shape (n, 3)."""
    forces, entries = -point_loads.copy(), []
    for block in blocks:
        corners = points[block.cells]
        entries.append((block.cells, block.stiffnesses(corners)))
        for corner, part in zip(
            block.cells.T, block.forces(corners, np.zeros_like(corners)).swapaxes(0, 1), strict=True
        ):
            np.add.at(forces, corner, part)
    along = control.ways(points).along
    if not along.shape[1]:
        return np.zeros_like(points)
    stiffness = (along.T @ assembled(len(points), entries) @ along).tocsr()
    return np.asarray(along @ _solved(stiffness, -(along.T @ forces.ravel()))).reshape(points.shape)


def _solved(matrix: sparse.csr_matrix, right: Array) -> Array:
    """Solution of a linear system, on this process alone.

    Raises:
        RuntimeError: The matrix is singular.
    """
    A = PETSc.Mat().createAIJ(matrix.shape, csr=(matrix.indptr, matrix.indices, matrix.data), comm=PETSc.COMM_SELF)
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOperators(A)
    factorization.choose(ksp, A, symmetric=False)
    b, x = A.createVecLeft(), A.createVecRight()
    b.array[:] = right
    ksp.solve(b, x)
    found = x.array.copy()
    for each in (ksp, A, b, x):
        each.destroy()
    if not np.isfinite(found).all():
        raise RuntimeError("Newton's equations of the nearest stress are singular")
    return found


def _moved(corners: Array, length: Array, *moves: tuple[int, int]) -> Array:
    """Corners with components moved by lengths, each in a sense."""
    moved = corners.copy()
    flat = moved.reshape(len(moved), -1)
    for number, sense in moves:
        flat[:, number] += sense * length
    return moved


def _slopes(block: Block, corners: Array, multipliers: Array, length: Array) -> tuple[Array, Array]:
    """Take derivatives of forces and energies by the shape, shapes (cells, 3 k, 3 k) and (cells, k, 3)."""
    count = corners.shape[1] * 3
    mixed, slopes = np.zeros((len(corners), count, count)), np.zeros((len(corners), count))
    for number in range(count):
        up, down = (_moved(corners, length, (number, sense)) for sense in (1, -1))
        rise = block.forces(up, multipliers) - block.forces(down, multipliers)
        mixed[:, :, number] = rise.reshape(len(corners), count) / (2 * length[:, None])
        slopes[:, number] = (block.energies(up, multipliers) - block.energies(down, multipliers)) / (2 * length)
    return mixed, slopes.reshape(corners.shape)


def _curvatures(block: Block, corners: Array, multipliers: Array, length: Array) -> Array:
    """Second derivatives of energies by the shape, shape (cells, 3 k, 3 k)."""
    count = corners.shape[1] * 3
    found = np.zeros((len(corners), count, count))

    def energies(*moves: tuple[int, int]) -> Array:
        return block.energies(_moved(corners, length, *moves), multipliers)

    here = energies()
    up = [energies((number, 1)) for number in range(count)]
    for i in range(count):
        for j in range(i + 1):
            both = energies((i, 1), (j, 1)) - up[i] - up[j] + here
            found[:, i, j] = found[:, j, i] = both / length**2
    return found
