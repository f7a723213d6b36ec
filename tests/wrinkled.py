"""Fabrics, random strains in each state, and the formulas of the relaxed energy for them."""

import itertools

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from scipy.spatial.transform import Rotation

from fx_membrane import (
    Analysis,
    Fabric,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    _dolfinx,
    natural_frequencies,
)
from fx_membrane.assembly import wrinkling_direction
from fx_membrane.assembly.problem import Problem
from fx_membrane.forms import wrinkling
from fx_membrane.geometry.sizes import normals

FABRICS = {
    "isotropic": Fabric(5000.0, 0.3),
    "isotropic, nu 0.5": Fabric(5000.0, 0.5),
    "isotropic, nu -0.6": Fabric(5000.0, -0.6),
    "woven": OrthotropicFabric(8000.0, 3000.0, nu=0.4, Gt=500.0),
    "woven, weft stiffer": OrthotropicFabric(1000.0, 8000.0, nu=0.2, Gt=100.0),
}
PAIR = ("isotropic", "woven")
STATES = np.array(["taut", "wrinkled", "slack"])
COUNT = 60  # cells in each state
ROW, COLUMN = np.array([0, 1, 0]), np.array([0, 1, 1])  # components 11, 22, 12


def as_woven(fabric):
    """Orthotropic fabric with the same constants."""
    if isinstance(fabric, OrthotropicFabric):
        return fabric
    return OrthotropicFabric(fabric.Et, fabric.Et, fabric.nu, fabric.Et / (2 * (1 + fabric.nu)))


def compliance(fabric):
    """C^-1 for stresses 11, 22, 12 and strains 11, 22, 2 x 12."""
    f = as_woven(fabric)
    mixed = -f.nu / f.Et_warp
    return np.array([[1 / f.Et_warp, mixed, 0], [mixed, 1 / f.Et_weft, 0], [0, 0, 1 / f.Gt]])


def tensor(v, shear=1.0):
    """Tensors (n, 2, 2) of components 11, 22, 12, the last times `shear`."""
    return np.stack([v[:, 0], shear * v[:, 2], shear * v[:, 2], v[:, 1]], axis=-1).reshape(-1, 2, 2)


def engineering(e):
    """Strains 11, 22, 2 x 12 of tensors."""
    return e[:, ROW, COLUMN] * [1, 1, 2]


def stress(e, fabric):
    """C : e as tensors."""
    return tensor(engineering(e) @ np.linalg.inv(compliance(fabric)))


def inner(a, b):
    return np.einsum("nij,nij->n", a, b)


def state_of(e, fabric):
    taut = np.linalg.eigvalsh(stress(e, fabric))[:, 0] >= 0
    slack = np.linalg.eigvalsh(e)[:, 1] <= 0
    return np.where(taut, 0, np.where(slack, 2, 1))


def strains(fabric, seed, count=COUNT, margin=0.05):
    """Random total strains, `count` in each state, and prestresses; none within `margin` of a switch."""
    rng = np.random.default_rng(seed)
    stresses = tensor(rng.normal(size=(400 * count, 3)) * [1.0, 1.0, 0.7])
    e = tensor(engineering(stresses) @ compliance(fabric), 0.5)
    e = np.where(rng.random(len(e))[:, None, None] < 0.5, e, tensor(rng.normal(size=(len(e), 3))))
    e *= 0.03 * rng.uniform(0.3, 1, len(e))[:, None, None] / np.abs(e).max(axis=(1, 2))[:, None, None]
    values = np.concatenate([np.linalg.eigvalsh(stress(e, fabric)), np.linalg.eigvalsh(e)], axis=1)
    scale = np.repeat([np.abs(values[:, :2]).max(axis=1), np.abs(values[:, 2:]).max(axis=1)], 2, axis=0).T
    clear = (np.abs(values) > margin * scale).all(axis=1)
    state = state_of(e, fabric)
    chosen = np.concatenate([np.flatnonzero(clear & (state == k))[:count] for k in range(3)])
    assert len(chosen) == 3 * count
    sigma0 = stress(tensor(0.01 * rng.normal(size=(3 * count, 3))), fabric)
    return e[chosen], sigma0


def cells_in_space(count, seed):
    """Triangles that share no node, anywhere, all of one side: their normals lie within 80 degrees of each other."""
    rng = np.random.default_rng(seed)
    flat = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 0.8, 0]]) + 0.1 * rng.normal(size=(count, 3, 3)) * [1, 1, 0]
    tilt = rng.normal(size=(count, 3)) * [1, 1, 0]
    tilt *= np.radians(rng.uniform(0, 40, (count, 1))) / np.linalg.norm(tilt, axis=1, keepdims=True)
    spin = Rotation.from_rotvec(rng.uniform(-np.pi, np.pi, (count, 1)) * [0, 0, 1])
    turned = np.einsum("nij,nkj->nki", (Rotation.from_rotvec(tilt) * spin).as_matrix(), flat)
    return (turned + rng.normal(size=(count, 1, 3))).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def shapes(E, seed):
    """Points, cells, warps and displacements of cells with the strains E, in random orientation."""
    points, cells = cells_in_space(len(E), seed)
    rng = np.random.default_rng(seed)
    warp = rng.normal(size=(len(E), 3))
    n = normals(points, cells)
    t = warp - np.sum(warp * n, axis=1, keepdims=True) * n
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    T = np.stack([t, np.cross(n, t)], axis=-1)
    values, vectors = np.linalg.eigh(np.eye(2) + 2 * E)
    U = np.einsum("nij,nj,nkj->nik", vectors, np.sqrt(values), vectors)
    F = Rotation.random(len(E), random_state=seed + 1).as_matrix() @ T @ U
    X = points[cells] - points[cells[:, :1]]
    x = np.einsum("nij,njk,nlk->nli", F, T.swapaxes(1, 2), X)
    return points, cells, warp, (x - X).reshape(-1, 3)


def run(part, points, u):
    structure = Structure(points, {"part": part})
    hold = PrescribedDisplacement(np.arange(len(points)), u)
    return Analysis(structure, comm=MPI.COMM_SELF).run([Stage("moved", displacements=[hold])])["moved"]


class Formula:
    """Energy, state, stress and tangent of a fabric as the formulas give them, for strains cell by cell."""

    def __init__(self, fabric, count):
        points, cells = cells_in_space(count, 0)
        self.fabric, self.mesh = fabric, _dolfinx.create_mesh(points, cells)
        self.order = _dolfinx.cell_order(self.mesh)
        self.e, self.s, self.angle = self._field(4), self._field(4), self._field(1)
        sigma0 = ufl.as_matrix([[self.s[0], self.s[1]], [self.s[2], self.s[3]]])
        E = ufl.variable(ufl.as_matrix([[self.e[0], self.e[1]], [self.e[2], self.e[3]]]))
        if isinstance(fabric, Fabric):
            relaxed = wrinkling.isotropic(E, sigma0, ufl.as_ufl(fabric.Et), ufl.as_ufl(fabric.nu))
        else:
            warp, weft, nu, Gt = map(ufl.as_ufl, (fabric.Et_warp, fabric.Et_weft, fabric.nu, fabric.Gt))
            relaxed = wrinkling.orthotropic(E, sigma0, warp, weft, nu, Gt, self.angle[0])
        S = ufl.variable(ufl.diff(relaxed.energy, E))
        C = ufl.diff(S, E)
        pairs = list(itertools.product(range(2), repeat=2))
        derivatives = [*(S[ij] for ij in pairs), *(C[ij + kl] for ij in pairs for kl in pairs)]
        values = ufl.as_vector([relaxed.energy, relaxed.state, *derivatives])
        self.expression = _dolfinx.cell_expression(values, self.mesh)

    def _field(self, size):
        return fem.Function(_dolfinx.functionspace(self.mesh, "DG", 0, size))

    def __call__(self, E, sigma0):
        """Energy counted from e = 0, state, stress and tangent."""
        stored = tensor(sigma0[:, ROW, COLUMN] @ compliance(self.fabric), 0.5)
        if isinstance(self.fabric, OrthotropicFabric):
            e = E + stored
            self.angle.x.array[:] = wrinkling_direction.direction(e[:, ROW, COLUMN], self.fabric)[self.order]
        self.e.x.array[:] = E[self.order].ravel()
        self.s.x.array[:] = sigma0[self.order].ravel()
        values = np.empty((len(E), 22))
        values[self.order] = self.expression()
        energy = values[:, 0] + inner(sigma0, stored) / 2
        C = values[:, 6:].reshape(-1, 2, 2, 2, 2)
        C = (C + C.swapaxes(3, 4)) / 2  # for symmetric changes of strain
        return energy, values[:, 1].astype(int), values[:, 2:6].reshape(-1, 2, 2), C


def frequency_and_tangent(structure):
    """State at rest, its lowest frequency, and the entries of its tangent."""
    state = Analysis(structure, comm=MPI.COMM_SELF).run([Stage("rest")])["rest"]
    problem = Problem(structure, MPI.COMM_SELF).under()
    A = problem.discretization.create_matrix()
    problem.tangent(problem.discretization.to_petsc(np.zeros_like(structure.points)), A)
    return state, natural_frequencies(state, 1).frequencies, A.getValuesCSR()[2]
