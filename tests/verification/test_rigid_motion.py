"""Rigid motion of a whole structure, by large turns and translations of its supports.

Reference: the principle of material frame indifference; with x = Q X + c, F^T F and so E, S and the energy do not
change. The flat sail with scalloped edges is in equilibrium as it is drawn: an isotropic stress s pulls an edge node
with s/2 times the chord between its neighbours, turned by a right angle; on a circle of radius R with the angle t for
each segment that is s R sin(t), and a cable of the force T resists with 2 T sin(t/2), so T = s R cos(t/2), exactly.
Claim: nodes follow the supports, strains and energy stay zero, stresses stay the prestress. For a curved structure with
a mast and ties, which first finds its equilibrium, nothing changes in the frame of the structure.
Tolerance: Newton stops below 1e-11 of the forces (about 60), the least stiffness of the nodes is the prestress (10):
1e-10 of size and stress. It cannot be had much finer: coordinates of size 8 are rounded to 1e-15, strains of segments
of length 0.25 to 1e-14, cable forces (EA 2e4) to 1e-10. The energy is stationary, its error is the square of the error
of the nodes, or rounding: 1e-13 of the elastic stiffness times area.
"""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Mast,
    Membrane,
    Newton,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    boundary_edges,
    rectangle,
)

SOURCE = "material frame indifference"

ET, PRESTRESS = 1000.0, 10.0
N = 8
AXES = [(1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.6, -0.5, 0.4)]
CORNERS = np.array([0, N, (N + 1) * N, (N + 1) * (N + 1) - 1])
SHIFT = np.array([3.0, -5.0, 2.0])


def moved(points, turn, share=1.0):
    return points @ turn.as_matrix().T + share * SHIFT


def motion_stage(name, points, target, nodes, after=None):
    """Stage that moves nodes to their place in a target."""
    return Stage(name, displacements=[PrescribedDisplacement(nodes, (target - points)[nodes])], after=after)


def motion(points, nodes, axis, first):
    """Stages: the first holds nodes at their place, the others turn by 15 degrees each up to 150 degrees.

    The motion is short enough for Newton; none of the stages compresses much.
    """
    axis = np.array(axis) / np.linalg.norm(axis)
    turns = [Rotation.from_rotvec(np.radians(angle) * axis) for angle in range(15, 151, 15)]
    names = [first, *(f"turn {i}" for i in range(1, len(turns) + 1))]
    stages = [Stage(first, displacements=[PrescribedDisplacement(nodes, np.zeros(3))])]
    stages += [
        motion_stage(names[i + 1], points, moved(points, turn, (i + 1) / len(turns)), nodes, names[i])
        for i, turn in enumerate(turns)
    ]
    return stages, turns[-1]


def edges_of(grid):
    sides = [grid[0], grid[-1], grid[:, 0], grid[:, -1]]
    return np.concatenate([np.stack([side[:-1], side[1:]], axis=-1) for side in sides])


def scalloped_sail():
    """Sail over the square |x|, |y| <= 1 whose edges are circular arcs, and the force of its edge cables."""
    half = 0.3  # half the opening angle of each arc
    radius = 1 / np.sin(half)
    angle = np.linspace(-half, half, N + 1)
    s = radius * np.sin(angle)
    rise = radius * (np.cos(angle) - np.cos(half))
    # Coons patch: the arcs at the edges, anything in between (uniform isotropic stress is in equilibrium on any mesh).
    a = np.linspace(-1, 1, N + 1)
    x = s[None, :] - a[None, :] * rise[:, None]
    y = s[:, None] - a[:, None] * rise[None, :]
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    _, triangles = rectangle(2.0, 2.0, N, N)
    grid = np.arange((N + 1) ** 2).reshape(N + 1, N + 1)
    return points, triangles, edges_of(grid), PRESTRESS * radius * np.cos(half / N)


def sail_structure():
    points, triangles, edges, force = scalloped_sail()
    parts = {
        "sail": Membrane(triangles, Fabric(ET, 0.3), PRESTRESS),
        "edges": Cable(edges, axial_stiffness=2e4, prestress=force),
    }
    return Structure(points, parts)


def test_scalloped_sail_is_in_equilibrium_as_drawn():
    hold = PrescribedDisplacement(CORNERS, np.zeros(3))
    state = Analysis(sail_structure()).run([Stage("as drawn", displacements=[hold])])["as drawn"]
    assert len(state.increments[0].iterations) == 1
    assert state.equilibrium.residual < 1e-13 * state.structure.parts["edges"].prestress
    assert state.energy == 0


@pytest.mark.parametrize("axis", AXES)
def test_scalloped_sail_follows_its_corners(axis, verified):
    structure = sail_structure()
    stages, turn = motion(structure.points, CORNERS, axis, "as drawn")
    results = Analysis(structure, Newton(rtol=1e-11)).run(stages)
    state = results[stages[-1].name]
    sail, edges = state.membrane("sail"), state.cable("edges")
    force = structure.parts["edges"].prestress

    assert max(abs(result.energy) for result in results.values()) < 1e-13 * ET
    np.testing.assert_allclose(state.position, moved(structure.points, turn), rtol=0, atol=1e-10)
    np.testing.assert_allclose(sail.strain, 0, rtol=0, atol=1e-10 * PRESTRESS / ET)
    np.testing.assert_allclose(sail.principal, PRESTRESS, rtol=1e-10)
    verified("stress after a turn [N/m]", PRESTRESS, sail.principal.max())
    np.testing.assert_allclose(edges.force, force, rtol=1e-10)
    expected = results["as drawn"].reactions @ turn.as_matrix().T
    np.testing.assert_allclose(state.reactions, expected, rtol=0, atol=1e-10 * force)


@pytest.mark.mpi_once
@pytest.mark.parametrize("axis", AXES)
def test_edge_moved_at_once(axis):
    """All edges of a woven membrane with a sheared prestress and cables across, turned by 170 degrees in one step.

    The motion is affine and the state uniform: the first Newton step, from the resting start, reaches it.
    """
    points, triangles = rectangle(2.0, 2.0, N, N)
    grid = np.arange(len(points)).reshape(N + 1, N + 1)
    across = np.concatenate([np.stack([line[:-1], line[1:]], axis=-1) for line in (grid[3], grid[:, 5])])
    woven = OrthotropicFabric(ET, 0.4 * ET, nu=0.3, Gt=0.1 * ET)
    sigma0 = PRESTRESS * np.array([[1.2, 0.3], [0.3, 0.7]])
    parts = {"woven": Membrane(triangles, woven, sigma0, warp=(0.8, 0.6, 0.0)), "across": Cable(across, 2e4, 40.0)}
    turn = Rotation.from_rotvec(np.radians(170) * np.array(axis) / np.linalg.norm(axis))
    stage = motion_stage("turned", points, moved(points, turn), np.unique(boundary_edges(triangles)))
    state = Analysis(Structure(points, parts)).run([stage])["turned"]

    np.testing.assert_allclose(state.position, moved(points, turn), rtol=0, atol=1e-10)
    stress = state.membrane("woven").second_piola_kirchhoff
    np.testing.assert_allclose(stress, np.tile(sigma0, (len(stress), 1, 1)), rtol=0, atol=1e-10 * PRESTRESS)
    np.testing.assert_allclose(state.cable("across").force, 40.0, rtol=1e-10)
    assert abs(state.energy) < 1e-13 * ET * 4.0


def tent():
    """Saddle with edge cables; one high corner stands on a mast and is tied back to two anchors."""
    points, triangles = rectangle(2.0, 2.0, N, N)
    points[:, 2] = 0.8 * points[:, 0] * points[:, 1]
    top = CORNERS[3]
    foot, anchors = len(points), [len(points) + 1, len(points) + 2]
    points = np.vstack([points, [[0.8, 0.8, -1.0], [2.2, 1.1, -1.0], [1.1, 2.2, -1.0]]])
    edges = edges_of(np.arange(foot).reshape(N + 1, N + 1))
    parts = {
        "sail": Membrane(triangles, Fabric(ET, 0.3), PRESTRESS),
        "edges": Cable(edges, 2e4, 60.0),
        "ties": Cable(np.array([[top, anchors[0]], [top, anchors[1]]]), 2e4, 50.0),
        "mast": Mast(np.array([[foot, top]]), 2e5, -60.0),
    }
    held = np.array([*CORNERS[:3], foot, *anchors])
    return Structure(points, parts), held


@pytest.mark.mpi
def test_tent_with_mast_and_ties():
    structure, held = tent()
    stages, turn = motion(structure.points, held, AXES[2], "at rest")
    results = Analysis(structure, Newton(rtol=1e-11)).run(stages)
    rest, state = results["at rest"], results[stages[-1].name]

    assert np.abs(rest.displacement).max() > 0.01  # it was not in equilibrium as drawn
    np.testing.assert_allclose(state.position, moved(rest.position, turn), rtol=0, atol=1e-10)
    expected = rest.membrane("sail").second_piola_kirchhoff
    actual = state.membrane("sail").second_piola_kirchhoff
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-10 * np.abs(expected).max())
    for name in ("edges", "ties", "mast"):
        np.testing.assert_allclose(state.parts[name].force, rest.parts[name].force, rtol=1e-10)
    assert state.energy == pytest.approx(rest.energy, rel=1e-10)
    assert rest.mast("mast").force[0] < 0
