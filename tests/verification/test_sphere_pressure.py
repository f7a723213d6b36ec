"""Balloon: a prestressed sphere under inner pressure.

Reference: closed form. A sphere of the radius R that stretches by lambda carries, per current length in all
directions, S = N0 + Eh (lambda^2 - 1) / (2 (1 - nu)), which holds the pressure on the area within an equator of the
radius lambda R: p = 2 S / (lambda R).
Claim: the volume and the area of one eighth, with supports in its planes of symmetry, converge with second order to
those of lambda; the reactions in these planes are the forces of the other parts, p times the area within. A whole
sphere, supported by three nodes so that it cannot move as a rigid body, gives the same and needs no reactions.
Tolerance: orders: the next term is of the size of the error on 8 divisions, 3e-2, times a constant: 0.05. The
extrapolation leaves it, 3e-2 squared over 4^4 on the finest mesh and four times that: 2e-5. Reactions: Newton stops
below 1e-12 of the forces, divided by the ratio of prestress and stiffness: 1e-9. Stress in single cells
is of first order at least.
"""

import numpy as np
import pytest

from balloons import eighth_of_a_balloon
from fx_membrane import Analysis, Fabric, Membrane, Newton, Pressure, Stage, Structure, Support
from surfaces import octant

SOURCE = "closed form, p = 2 S / (lambda R)"

R, EH, NU, N0 = 2.0, 1e5, 0.3, 4e3
MESHES = (8, 16, 32)
STRETCHES = (1.0, 1.02, 1.3)


def pressure(stretch):
    return 2 * (N0 + EH * (stretch**2 - 1) / (2 * (1 - NU))) / (stretch * R)


def sphere(n):
    """Whole sphere, its eight parts joined."""
    points, cells = octant(n, R)
    signs = np.array(list(np.ndindex(2, 2, 2))) * -2 + 1
    all_points = np.concatenate([points * sign for sign in signs])
    mirrored = np.concatenate([cells[:, :: int(np.prod(sign))] + k * len(points) for k, sign in enumerate(signs)])
    _, first, number = np.unique(np.round(all_points / R, 9), axis=0, return_index=True, return_inverse=True)
    return all_points[first], number.ravel()[mirrored]


def inflate(structure, stretch):
    """Apply the pressure and its prestress together: the prestress alone would collapse the sphere."""
    stages = [Stage("fill", loads=[Pressure(pressure(1.0), "balloon")])]
    more = Pressure(pressure(stretch) - pressure(1.0), "balloon")
    stages.append(Stage("inflate", loads=[more], increments=3, after="fill"))
    return Analysis(structure, Newton(rtol=1e-12)).run(stages)["inflate"]


def eighth(n, stretch):
    return inflate(eighth_of_a_balloon(n, Fabric(EH, NU), N0, R), stretch)


def volume_and_area(state):
    a, b, c = state.position[state.structure.parts["balloon"].cells].swapaxes(0, 1)
    normal = np.cross(b - a, c - a)
    return np.array([np.sum(normal * a) / 6, np.linalg.norm(normal, axis=1).sum() / 2])


@pytest.mark.parametrize("stretch", STRETCHES)
def test_second_order(stretch, verified):
    reference = np.pi * (stretch * R) ** 2 * np.array([stretch * R / 6, 1 / 2])
    values = np.array([volume_and_area(eighth(n, stretch)) for n in MESHES])
    error = np.abs(values - reference)
    np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.05)
    np.testing.assert_allclose((4 * values[-1] - values[-2]) / 3, reference, rtol=2e-5)
    verified("volume of an eighth [m3]", reference[0], values[-1, 0], np.log2(error[-2, 0] / error[-1, 0]))


def test_stress_is_the_same_everywhere():
    stretch, mean, worst = 1.3, [], []
    S = pressure(stretch) * stretch * R / 2
    for n in MESHES:
        result = eighth(n, stretch).membrane("balloon")
        assert set(result.state) == {"taut"}
        mean.append(abs(result.principal.mean() / S - 1))
        worst.append(np.abs(result.principal / S - 1).max())
    np.testing.assert_allclose(np.log2(np.divide(mean[:-1], mean[1:])), 2, rtol=0, atol=0.05)
    assert (np.divide(worst[:-1], worst[1:]) > 2).all()
    assert worst[-1] < 0.005


@pytest.mark.mpi_once
@pytest.mark.parametrize("stretch", STRETCHES)
def test_reactions_in_the_planes_of_symmetry(stretch):
    state = eighth(8, stretch)
    for i in range(3):
        edge = np.flatnonzero(state.structure.points[:, i] == 0)
        x, y = np.delete(state.position[edge], i, axis=1).T
        order = np.argsort(np.arctan2(y, x))
        x, y = np.append(x[order], 0), np.append(y[order], 0)
        within = abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))) / 2
        assert state.reactions[:, i].sum() == pytest.approx(-pressure(stretch) * within, rel=1e-9)


def test_whole_sphere_needs_no_reactions():
    points, cells = sphere(8)
    at = {sign * axis: int(np.argmax(points @ (sign * np.eye(3)[axis - 1]))) for axis in (1, 2, 3) for sign in (1, -1)}
    supports = [Support([at[1], at[-1]], "yz"), Support(at[2], "xz")]
    structure = Structure(points, {"balloon": Membrane(cells, Fabric(EH, NU), N0)}, supports)
    assert (np.sum(structure.normals("balloon") * points[cells].mean(axis=1), axis=1) > 0).all()
    state = inflate(structure, 1.3)
    part = eighth(8, 1.3)
    assert np.abs(state.reactions).max() < 1e-9 * N0 * R
    np.testing.assert_allclose(state.equilibrium.loads, 0, atol=1e-9 * N0 * R)
    np.testing.assert_allclose(volume_and_area(state), 8 * volume_and_area(part), rtol=1e-9)
