"""Square of bars with two diagonal cables, pushed sideways: one diagonal goes slack.

Reference: equilibrium of the joints. code_aster's validation case SSNL105 has a unit square with 1000 N sideways at an
upper corner: 1000 sqrt(2) = 1414.2 N in the cable that the load pulls, nothing in the other, -1000 N in the strut that
carries the load across. The upright on the far side carries -1000 N too, the near one and the base nothing.
Claim: these forces, in the limit of stiff bars; which cable is slack follows the load when it turns round.
Tolerance: the square leans by angles of the order of the strain P/EA, so forces differ by P times that, with factors up
to 20: the error falls with the first power of 1/EA. The slack cable keeps `compression_stiffness` times the force that
its shortening would give a strut, which is compared to rounding.
"""

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Mast, Newton, PointLoad, Stage, Structure, Support

SOURCE = "statics of joints; code_aster SSNL105"

P = 1000.0
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
BARS = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])  # base, right upright, top, left upright
DIAGONALS = np.array([[0, 2], [1, 3]])


def solve(EA, node, force, before=None, share=1e-4):
    parts = {"bars": Mast(BARS, EA), "diagonals": Cable(DIAGONALS, EA, compression_stiffness=share)}
    structure = Structure(POINTS, parts, [Support([0, 1]), Support([2, 3], "z")])
    stages = [Stage("load", loads=[PointLoad(node, (force, 0.0, 0.0))])]
    if before is not None:
        stages = [
            Stage("before", loads=[PointLoad(node, (before, 0.0, 0.0))]),
            Stage("load", loads=[PointLoad(node, (force - before, 0.0, 0.0))], after="before"),
        ]
    return Analysis(structure, Newton(rtol=1e-13)).run(stages)["load"]


# Load to the right on the upper left corner; its mirror image; pull instead of push on either corner.
CASES = [
    (3, P, [0, -1, -1, 0], [np.sqrt(2), 0]),
    (2, -P, [0, 0, -1, -1], [0, np.sqrt(2)]),
    (2, P, [0, -1, 0, 0], [np.sqrt(2), 0]),
    (3, -P, [0, 0, 0, -1], [0, np.sqrt(2)]),
]


@pytest.mark.mpi_once
@pytest.mark.parametrize(("node", "force", "bars", "diagonals"), CASES)
def test_forces_of_stiff_bars(node, force, bars, diagonals, verified):
    error = []
    for EA in (1e6, 1e7, 1e8):
        state = solve(EA, node, force, share=1e-9)
        np.testing.assert_array_equal(state.cable("diagonals").slack, np.array(diagonals) == 0)
        forces = np.concatenate([state.mast("bars").force, state.cable("diagonals").force])
        error.append(np.abs(forces / P - [*bars, *diagonals]).max())
    assert error[0] < 20 * P / 1e6
    np.testing.assert_allclose(np.log10(np.divide(error[:-1], error[1:])), 1, rtol=0, atol=0.01)
    verified("force of the taut diagonal [N]", np.sqrt(2) * P, state.cable("diagonals").force.max())


@pytest.mark.parametrize(("node", "force", "bars", "diagonals"), CASES)
def test_share_of_the_slack_cable(node, force, bars, diagonals):
    """The slack cable carries its fraction of the force in a bar; the other forces change in proportion."""
    EA = 1e6
    none = solve(EA, node, force, share=1e-9)
    for share in (1e-4, 1e-3):
        state = solve(EA, node, force, share=share)
        slack = state.cable("diagonals").slack
        strain = state.cable("diagonals").strain[slack]
        expected = share * EA * strain * np.sqrt(1 + 2 * strain)
        np.testing.assert_allclose(state.cable("diagonals").force[slack], expected, rtol=1e-9)
        change = state.mast("bars").force - none.mast("bars").force
        assert 0 < np.abs(change).max() < 1.01 * np.abs(expected).max() / np.sqrt(2)


@pytest.mark.mpi
def test_load_turns_round():
    """The state is independent of the load history."""
    direct, after = solve(1e6, 3, -P), solve(1e6, 3, -P, before=P)
    np.testing.assert_allclose(after.displacement, direct.displacement, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(after.cable("diagonals").slack, [True, False])
