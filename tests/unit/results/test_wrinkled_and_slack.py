"""Wrinkled and slack patches of membranes and slack cables: states, and forces in closed form."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

FABRIC = Fabric(Et=1e5, nu=0.3)


def patch(x, y, material=FABRIC, **data):
    """Square whose rim is strained by these values along its sides."""
    points, triangles = rectangle(1.0, 1.0, 2, 2)
    fabric = Membrane(triangles, material, warp=(1, 0, 0), **data)
    rim = np.unique(boundary_edges(triangles))
    move = PrescribedDisplacement(rim, points[rim] * [x, y, 0], "xy")
    structure = Structure(points, {"fabric": fabric}, [Support(range(9), "z")])
    return Analysis(structure).run([Stage("move", displacements=[move])])["move"].membrane("fabric")


WOVEN = OrthotropicFabric(Et_warp=2e5, Et_weft=1e5, nu=0.2, Gt=1e4)


@pytest.mark.mpi_once
@pytest.mark.parametrize("material", [FABRIC, WOVEN])
@pytest.mark.parametrize(
    ("x", "y", "state"),
    [(0.01, 0.01, "taut"), (0.01, -0.02, "wrinkled"), (-0.02, 0.01, "wrinkled"), (-0.01, -0.02, "slack")],
)
def test_state_of_a_patch(x, y, state, material):
    fabric = patch(x, y, material)
    assert fabric.state.tolist() == [state] * 8
    number = {"taut": 2, "wrinkled": 1, "slack": 0}[state]
    assert (fabric.principal > 100).sum(axis=1).tolist() == [number] * 8
    compression = 1e-4 * 2e5 * 0.02 * 2  # a fraction of the stiffness is kept
    assert fabric.principal.min() > -compression


def test_wrinkled_patch_has_tension_along_the_stretched_side():
    fabric = patch(0.01, -0.02)
    stretch, eta = 1.01, 1e-4
    E, E_across = (stretch**2 - 1) / 2, (0.98**2 - 1) / 2
    full = FABRIC.Et / (1 - FABRIC.nu**2) * (E + FABRIC.nu * E_across)
    S = (1 - eta) * FABRIC.Et * E + eta * full
    assert fabric.second_piola_kirchhoff[:, 0, 0] == pytest.approx(S, rel=1e-9)
    assert fabric.cauchy[:, 0, 0] == pytest.approx(S * stretch / 0.98, rel=1e-9)
    assert fabric.warp_weft_stress == pytest.approx(fabric.cauchy[:, [0, 1], [0, 1]], rel=1e-9)


def test_patch_with_all_its_stiffness_carries_compression():
    fabric = patch(-0.01, -0.02, compression_stiffness=1)
    E = (np.array([0.99, 0.98]) ** 2 - 1) / 2
    S = FABRIC.Et / (1 - FABRIC.nu**2) * (E + FABRIC.nu * E[::-1])
    assert fabric.second_piola_kirchhoff[:, [0, 1], [0, 1]] == pytest.approx(np.tile(S, (8, 1)), rel=1e-9)
    assert fabric.principal.max() < 0
    assert fabric.state.tolist() == ["taut"] * 8  # nothing wrinkles


@pytest.mark.parametrize(("move", "slack"), [(0.02, False), (-0.02, True)])
def test_cable_is_slack_where_its_ends_come_together(move, slack):
    cells = [[0, 1], [1, 2]]
    structure = Structure(
        [[0.0, 0, 0], [1, 0, 0], [2, 0, 0]],
        {"cable": Cable(cells, 1e6), "mast": Mast(cells, 1e-3)},
        [Support(0), Support([1, 2], "yz")],
    )
    ends = [PrescribedDisplacement(2, (move, 0, 0), "x")]
    result = Analysis(structure).run([Stage("move", displacements=ends)])["move"]
    assert result.cable("cable").slack.tolist() == [slack] * 2
    assert result.cable("cable").slack.dtype == bool
    stretch = 1 + move / 2
    full = 1e6 * (stretch**2 - 1) / 2 * stretch
    assert result.cable("cable").force == pytest.approx(full * (1e-4 if slack else 1), rel=1e-9)
    assert result.mast("mast").slack.tolist() == [False] * 2
