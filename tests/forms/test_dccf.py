"""The UFL forms against the hand-derived kernel, on many random single elements at once and on a whole mesh.

Source: Gil (40), (46), (51)-(57) on one side, (58)-(67) on the other. Both evaluate the same numbers in different
orders, so they agree to rounding: 1e-12 of the largest entry.
"""

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fx_membrane import Cable, Fabric, Mast, Membrane, OrthotropicFabric, Structure, _dolfinx, dccf, rectangle
from fx_membrane.assembly.problem import Problem
from fx_membrane.forms import kinematics, loads

COUNT = 40


def relative_error(a, b):
    return np.abs(a - b).max() / np.abs(b).max()


def random_elements(rng, nodes):
    """Elements that share no node: sizes over four decades, any orientation, anywhere.

    Angles stay above 20 degrees: rounding grows with the condition of the shape, in both codes.
    """
    size = 10.0 ** rng.uniform(-2, 2, (COUNT, 1, 1))
    angle = np.radians(rng.uniform(20, 140, COUNT))
    corners = np.zeros((COUNT, 3, 3))
    corners[:, 1, 0] = 1.0
    corners[:, 2, 0], corners[:, 2, 1] = np.cos(angle), np.sin(angle)
    turned = corners @ np.linalg.qr(rng.normal(size=(COUNT, 3, 3)))[0]
    normal = np.cross(turned[:, 1], turned[:, 2])
    other = normal @ normal[0] < 0  # a structure would turn these cells to the side of the first
    turned[other] = turned[other][:, [0, 2, 1]]
    return size * (rng.normal(size=(COUNT, 1, 3)) + turned[:, :nodes]), size


def symmetric(rng, scale):
    tensors = rng.normal(size=(COUNT, 2, 2)) * scale
    return tensors + tensors.swapaxes(1, 2)


def case(name, rng):
    """Structure of disconnected elements, and the input of the kernel: positions, sizes, prestress, moduli, warp."""
    nodes = 3 if name in ("isotropic", "orthotropic") else 2
    X, size = random_elements(rng, nodes)
    cells = np.arange(COUNT * nodes).reshape(COUNT, nodes)
    warp = None
    if nodes == 3:
        warp = rng.normal(size=(COUNT, 3))
        tensors = symmetric(rng, 300.0)
        s0 = np.stack([tensors[:, 0, 0], tensors[:, 1, 1], tensors[:, 0, 1]], axis=1)
        isotropic, woven = (5000.0, 0.3), (8000.0, 3000.0, 0.4, 700.0)
        material = Fabric(*isotropic) if name == "isotropic" else OrthotropicFabric(*woven)
        C = dccf.isotropic(*isotropic) if name == "isotropic" else dccf.orthotropic(*woven)
        part: Membrane | Cable | Mast = Membrane(cells, material, tensors, warp, compression_stiffness=1.0)
    else:
        s0 = rng.normal(size=(COUNT, 1)) * 300.0
        C = dccf.axial(7000.0)
        cable = Cable(cells, 7000.0, s0[:, 0], compression_stiffness=1.0)
        part = cable if name == "cable" else Mast(cells, 7000.0, s0[:, 0])
    return Structure(X.reshape(-1, 3), {"part": part}), X, size, s0, C, warp


def dense(A, number):
    """Matrix in the user's numbering."""
    dofs = (3 * number[:, None] + np.arange(3)).ravel().astype(np.int32)
    return A.getValues(dofs, dofs)


@pytest.mark.parametrize("amplitude", [0.0, 1e-3, 0.5])
@pytest.mark.parametrize("name", ["isotropic", "orthotropic", "cable", "mast"])
def test_single_elements(name, amplitude):
    rng = np.random.default_rng([len(name), int(1e3 * amplitude)])
    structure, X, size, s0, C, warp = case(name, rng)
    u = amplitude * size * rng.normal(size=X.shape)
    element = dccf.elements(X, warp)

    problem = Problem(structure, MPI.COMM_SELF).under()
    number = problem.discretization.block_of_node
    x = problem.discretization.to_petsc(u.reshape(-1, 3))
    b, A = problem.discretization.create_vector(), problem.discretization.create_matrix()
    problem.residual(x, b)
    problem.tangent(x, A)
    K = dense(A, number)

    energies = dccf.energy(element, u, s0, C)
    assert abs(problem.energy(x) - energies.sum()) <= 1e-12 * np.abs(energies).sum()
    forces = problem.discretization.to_numpy(b).reshape(X.shape)
    expected = dccf.internal_force(element, u, s0, C)
    tangents = dccf.tangent(element, u, s0, C)
    width = 3 * X.shape[1]
    for i in range(COUNT):  # element by element: sizes differ by decades
        assert relative_error(forces[i], expected[i]) < 1e-12
        here = slice(width * i, width * (i + 1))
        assert relative_error(K[here, here], tangents[i]) < 1e-12
        K[here, here] = 0.0
    assert not K.any()


@pytest.mark.parametrize("amplitude", [0.0, 0.5])
def test_follower_pressure(amplitude):
    rng = np.random.default_rng(7)
    X, size = random_elements(rng, 3)
    u = amplitude * size * rng.normal(size=X.shape)
    p = rng.normal(size=COUNT)
    mesh = _dolfinx.create_mesh(X.reshape(-1, 3), np.arange(3 * COUNT).reshape(-1, 3))
    V = _dolfinx.functionspace(mesh, "Lagrange", 1, 3)
    nodes = _dolfinx.node_order(V)
    displacement = fem.Function(V)
    displacement.x.array[:] = u.reshape(-1, 3)[nodes].ravel()
    pressure = fem.Function(_dolfinx.functionspace(mesh, "DG", 0, 1))
    pressure.x.array[:] = p[_dolfinx.cell_order(mesh)]

    T = kinematics.membrane_frame(ufl.Jacobian(mesh), ufl.Jacobian(mesh)[:, 0])
    F = kinematics.deformation_gradient(kinematics.displacement_gradient(displacement, T), T)
    dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 1})
    work = loads.follower_pressure(pressure[0], F, ufl.TestFunction(V)) * dx
    forces = np.zeros(9 * COUNT)
    fem.assemble_vector(forces, _dolfinx.form(work))
    A = fem.petsc.assemble_matrix(_dolfinx.form(ufl.derivative(work, displacement)))
    A.assemble()
    number = np.argsort(nodes)

    expected = dccf.pressure_force(X, u, p)
    tangents = dccf.pressure_tangent(X, u, p)
    K = dense(A, number)
    for i, force in enumerate(forces.reshape(-1, 3)[number].reshape(X.shape)):
        assert relative_error(force, expected[i]) < 1e-12
        assert relative_error(K[9 * i : 9 * i + 9, 9 * i : 9 * i + 9], tangents[i]) < 1e-12


def test_pressure_is_a_third_of_the_vector_area():
    """Gil (56) in words: each node takes p/6 (x2 - x1) x (x3 - x1)."""
    rng = np.random.default_rng(8)
    X, u, p = rng.normal(size=(5, 3, 3)), rng.normal(size=(5, 3, 3)), rng.normal(size=5)
    x = X + u
    area = p[:, None] / 6 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    assert relative_error(dccf.pressure_force(X, u, p), np.repeat(area[:, None], 3, axis=1)) < 1e-12


def test_whole_mesh():
    """Assembled residual and tangent of a curved sheet of 12 800 triangles and a cable across it."""
    rng = np.random.default_rng(9)
    points, triangles = rectangle(10, 8, 80, 80)
    points[:, 2] = 0.05 * (points[:, 0] ** 2 - points[:, 1] ** 2)
    line = np.stack([np.arange(80), np.arange(1, 81)], axis=1) + 40 * 81
    fabric, cable = (
        Membrane(triangles, Fabric(500.0, 0.3), prestress=5.0, compression_stiffness=1.0),
        Cable(line, 1e4, prestress=30.0, compression_stiffness=1.0),
    )
    u = 0.01 * rng.normal(size=points.shape)

    problem = Problem(Structure(points, {"fabric": fabric, "cable": cable})).under()
    x = problem.discretization.to_petsc(u)
    b, A = problem.discretization.create_vector(), problem.discretization.create_matrix()
    problem.residual(x, b)
    problem.tangent(x, A)

    force = np.zeros(points.shape)
    product = np.zeros(points.shape)
    direction = rng.normal(size=points.shape)
    moduli = [(triangles, dccf.isotropic(500.0, 0.3), [5.0, 5.0, 0.0]), (line, dccf.axial(1e4), [30.0])]
    for cells, C, stress in moduli:
        element = dccf.elements(points[cells])
        s0 = np.tile(stress, (len(cells), 1))
        np.add.at(force, cells, dccf.internal_force(element, u[cells], s0, C))
        K = dccf.tangent(element, u[cells], s0, C)
        along = np.einsum("nij,nj->ni", K, direction[cells].reshape(len(cells), -1))
        np.add.at(product, cells, along.reshape(*cells.shape, 3))
    assert relative_error(problem.discretization.to_numpy(b), force) < 1e-12
    A.mult(problem.discretization.to_petsc(direction), b)
    assert relative_error(problem.discretization.to_numpy(b), product) < 1e-12
