"""Patch test: an affine displacement of the edge deforms an irregular membrane mesh uniformly.

Reference: closed form. With u = A X + b the deformation gradient F = (I + A) T is the same everywhere (T: warp and weft
as columns), so E = (F^T F - I) / 2, S = sigma0 + C : E and the Cauchy stress F S F^T / sqrt(det F^T F) are uniform, and
nodes inside are in equilibrium: the nodal forces of a uniform stress on a closed fan of triangles cancel.
Claim: nodes inside follow, strain, stress and energy are those of the closed form, for any orientation in space; in the
warp/weft frame they do not depend on the orientation at all.
Tolerance: linear triangles contain the solution, so the error is rounding: 1e-16 times the condition of the tangent
(below 1e3) and, for stresses, times stiffness over stress (10): 1e-12.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    boundary_edges,
    rectangle,
)

SOURCE = "uniform deformation, Gil 2006, section 3"

ISOTROPIC = Fabric(Et=1000.0, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=1000.0, Et_weft=400.0, nu=0.35, Gt=90.0)
SHEARED = np.array([[120.0, 25.0], [25.0, 70.0]])
GRADIENT = np.array([[0.08, 0.03, 0.0], [-0.02, 0.05, 0.0], [0.12, -0.07, 0.0]])  # stretch, shear and tilt
TURNS = [Rotation.identity(), *Rotation.random(3, random_state=1)]


def irregular_mesh():
    points, triangles = rectangle(3.0, 2.0, 5, 4, "right")
    edge = np.unique(boundary_edges(triangles))
    inside = np.setdiff1d(np.arange(len(points)), edge)
    points[inside, :2] += np.random.default_rng(0).uniform(-0.15, 0.15, (len(inside), 2))
    return points, triangles, edge, inside


def stretch_edge(material, prestress, turn):
    """Patch with its data in a turned frame, its edge displaced; also the expected displacement."""
    flat, triangles, edge, inside = irregular_mesh()
    Q = turn.as_matrix()
    points = flat @ Q.T + [4.0, -3.0, 2.0]
    u = points @ (Q @ GRADIENT @ Q.T).T + [0.3, -0.2, 0.1]
    warp = Q @ [np.cos(0.4), np.sin(0.4), 0.7]  # at an angle to the grid, and to be projected on the plane
    structure = Structure(points, {"patch": Membrane(triangles, material, prestress, warp)})
    moved = [PrescribedDisplacement(node, u[node]) for node in edge]
    return Analysis(structure).run([Stage("stretch", displacements=moved)])["stretch"], u, inside


def closed_form(material, prestress):
    """Deformation gradient (not turned), strain and stress in the warp/weft frame, energy per area."""
    T = np.array([[np.cos(0.4), -np.sin(0.4)], [np.sin(0.4), np.cos(0.4)], [0, 0]])
    F = (np.eye(3) + GRADIENT) @ T
    E = (F.T @ F - np.eye(2)) / 2
    if isinstance(material, Fabric):
        stiffness, nu = material.Et / (1 - material.nu**2), material.nu
        CE = stiffness * ((1 - nu) * E + nu * np.trace(E) * np.eye(2))
    else:
        coupling = -material.nu / material.Et_warp
        compliance = [[1 / material.Et_warp, coupling, 0], [coupling, 1 / material.Et_weft, 0], [0, 0, 1 / material.Gt]]
        s11, s22, s12 = np.linalg.solve(compliance, [E[0, 0], E[1, 1], 2 * E[0, 1]])
        CE = np.array([[s11, s12], [s12, s22]])
    sigma0 = prestress * np.eye(2) if np.ndim(prestress) < 2 else prestress
    return F, E, sigma0 + CE, np.sum(sigma0 * E) + np.sum(CE * E) / 2


@pytest.mark.mpi_once
@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize(
    ("material", "prestress"), [(ISOTROPIC, 100.0), (ISOTROPIC, SHEARED), (WOVEN, (120.0, 70.0)), (WOVEN, SHEARED)]
)
def test_affine_displacement_of_the_edge_gives_the_uniform_state(material, prestress, turn, verified):
    prestress = np.diag(prestress) if np.shape(prestress) == (2,) else prestress
    state, u, inside = stretch_edge(material, prestress, turn)
    F, E, S, energy = closed_form(material, prestress)
    cauchy = turn.as_matrix() @ (F @ S @ F.T / np.sqrt(np.linalg.det(F.T @ F))) @ turn.as_matrix().T

    np.testing.assert_allclose(state.displacement[inside], u[inside], rtol=0, atol=1e-12)
    patch = state.membrane("patch")
    cells = (len(patch.strain), 1, 1)
    np.testing.assert_allclose(patch.strain, np.tile(E, cells), rtol=0, atol=1e-12 * np.abs(E).max())
    np.testing.assert_allclose(patch.second_piola_kirchhoff, np.tile(S, cells), rtol=0, atol=1e-12 * np.abs(S).max())
    np.testing.assert_allclose(patch.cauchy, np.tile(cauchy, cells), rtol=0, atol=1e-12 * np.abs(cauchy).max())
    principal = np.linalg.eigvalsh(cauchy)[:0:-1]  # the smallest of the three is the stress normal to the plane, zero
    np.testing.assert_allclose(patch.principal, np.tile(principal, cells[:2]), rtol=1e-12)
    assert state.energy == pytest.approx(6.0 * energy, rel=1e-12)
    verified("energy [J]", 6.0 * energy, state.energy)
    verified("largest stress [N/m]", principal[0], patch.principal[:, 0].max())


@pytest.mark.mpi_once
@pytest.mark.parametrize("turn", TURNS[1:])
@pytest.mark.parametrize("material", [ISOTROPIC, WOVEN])
def test_warp_and_weft_do_not_depend_on_the_orientation_in_space(material, turn):
    flat, _, _ = stretch_edge(material, SHEARED, Rotation.identity())
    turned, _, _ = stretch_edge(material, SHEARED, turn)
    assert turned.energy == pytest.approx(flat.energy, rel=1e-12)
    for name in ("strain", "second_piola_kirchhoff", "principal"):
        expected = getattr(flat.membrane("patch"), name)
        actual = getattr(turned.membrane("patch"), name)
        np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
