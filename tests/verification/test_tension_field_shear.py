"""Membrane without prestress whose edges are sheared: a complete tension field.

Reference: closed form. With all edges moved by x + gamma y the strain E12 = gamma / 2, E22 = gamma^2 / 2 is uniform and
in equilibrium on any mesh. Its principal values are gamma/2 (gamma/2 +- sqrt(1 + gamma^2/4)): an extension e1 along t
and a shortening that is more than nu times as large. So the tension is S = Et e1 t t^T. In a woven fabric t is not the
principal direction, but where warp and weft lie alike to the shear the energy e_tt^2 / (2 t t^T : C^-1 : t t^T) is
largest at 45 degrees to both for small gamma. There a shear force of E gamma / 4 per length results for any nu, with
the modulus E of that direction; the full law has G gamma (H. Wagner, Ebene Blechwandtraeger mit sehr duennem Stegblech,
Zeitschrift fuer Flugtechnik und Motorluftschiffahrt 20 (1929): the complete tension field).
Claim: state, stress, energy and reactions, with the share of the full law that `compression_stiffness` adds; Wagner's
stiffness in the limit.
Tolerance: linear triangles contain the solution, nothing holds inner nodes across but the tension, Newton stops below
1e-12 of the forces: 1e-9. Wagner: stress and direction depend on gamma to first order; the second one spoils the
observed order by gamma times 5 at 1e-3: 0.01.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Newton,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

SOURCE = "uniform tension field; H. Wagner 1929"

ET, WIDTH, HEIGHT = 2e5, 2.0, 1.0


def shear(fabric, gamma, share=1e-4):
    points, triangles = rectangle(WIDTH, HEIGHT, 6, 4, "to centre")
    edge = np.unique(boundary_edges(triangles))
    membrane = Membrane(triangles, fabric, warp=(1.0, 0.0, 0.0), compression_stiffness=share)
    structure = Structure(points, {"sheet": membrane}, [Support(np.arange(len(points)), "z")])
    moved = np.zeros((len(edge), 3))
    moved[:, 0] = gamma * points[edge, 1]
    stage = Stage("shear", displacements=[PrescribedDisplacement(edge, moved, "xy")])
    return Analysis(structure, Newton(rtol=1e-12)).run([stage])["shear"]


@pytest.mark.mpi_once
@pytest.mark.parametrize("nu", [0.0, 0.3, 0.5])
@pytest.mark.parametrize("gamma", [1e-4, 0.02, 0.3])
def test_isotropic(nu, gamma, verified):
    share = 1e-4
    state = shear(Fabric(ET, nu), gamma, share)
    E = np.array([[0, gamma / 2], [gamma / 2, gamma**2 / 2]])
    values, directions = np.linalg.eigh(E)
    t = directions[:, 1]
    relaxed = ET * values[1] * np.outer(t, t)
    full = ET / (1 - nu**2) * ((1 - nu) * E + nu * np.trace(E) * np.eye(2))
    S = (1 - share) * relaxed + share * full
    sheet = state.membrane("sheet")

    assert set(sheet.state) == {"wrinkled"}
    np.testing.assert_allclose(sheet.strain, np.tile(E, (len(sheet.state), 1, 1)), rtol=0, atol=1e-9 * gamma)
    scale = ET * gamma
    np.testing.assert_allclose(sheet.second_piola_kirchhoff, np.tile(S, (48, 1, 1)), rtol=0, atol=1e-9 * scale)
    energy = (1 - share) * ET * values[1] ** 2 / 2 + share * np.sum(full * E) / 2
    assert state.energy == pytest.approx(WIDTH * HEIGHT * energy, rel=1e-9)
    verified("energy [J]", WIDTH * HEIGHT * energy, state.energy)
    F = np.array([[1, gamma], [0, 1]])
    # Corners belong to the upper edge and to a side, whose force they take for half a cell.
    inner = np.abs(state.structure.points[:, 0]) < WIDTH / 2 - 1e-9
    upper = inner & (state.structure.points[:, 1] == HEIGHT / 2)
    force = state.reactions[upper, :2].sum(axis=0) / (WIDTH * 5 / 6)
    np.testing.assert_allclose(force, F @ S[:, 1], rtol=0, atol=1e-9 * scale)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("fabric", "modulus", "G"),
    [
        (Fabric(ET, 0.3), ET, ET / 2.6),
        # 1/E at 45 degrees is a quarter of 2/E - 2 nu/E + 1/G.
        (OrthotropicFabric(ET, ET, 0.2, ET / 20), 4 / (1.6 + 20) * ET, ET / 20),
    ],
)
def test_wagner(fabric, modulus, G):
    off = []
    for gamma in (1e-3, 1e-4):
        S = shear(fabric, gamma, share=1e-8).membrane("sheet").second_piola_kirchhoff
        off.append(np.abs(S / (modulus * gamma / 4) - 1).max())
        full = shear(fabric, gamma, share=1.0).membrane("sheet").second_piola_kirchhoff
        np.testing.assert_allclose(full[:, 0, 1], G * gamma, rtol=1e-9)
    assert np.log10(off[0] / off[1]) == pytest.approx(1, abs=0.01)
    assert off[1] < 1e-3
