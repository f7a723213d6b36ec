"""Flat prestressed sheet with fixed edges, warmed until it is slack.

Reference: closed form. The edges do not move, so that the stress falls by Eh alpha dT / (1 - nu) in all directions, and
the sheet is slack where alpha dT = N0 (1 - nu) / Eh. A fixed cable loses EA alpha dT.
Claim: the stress on any mesh, in one stage or several, and the temperature at which the sheet goes slack.
Tolerance: the discrete sheet has this state exactly; rounding, and Newton's tolerance.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    LostPrestressWarning,
    Membrane,
    Stage,
    Structure,
    Support,
    TemperatureChange,
    boundary_edges,
    rectangle,
)

SOURCE = "closed form, N0 - Eh alpha dT / (1 - nu)"

EH, NU, N0, ALPHA = 1e6, 0.3, 4e3, 3e-5
SLACK = N0 * (1 - NU) / (EH * ALPHA)
POINTS, TRIANGLES = rectangle(3.0, 2.0, 6, 4)


def warmed(*differences, compression_stiffness=1e-4):
    """Results of stages that follow each other, the last first."""
    fabric = Membrane(TRIANGLES, Fabric(EH, NU), N0, compression_stiffness=compression_stiffness)
    structure = Structure(POINTS, {"sheet": fabric}, [Support(np.unique(boundary_edges(TRIANGLES)))])
    stages = [
        Stage(str(k), changes=[TemperatureChange(difference, "sheet", ALPHA)], after=str(k - 1) if k else None)
        for k, difference in enumerate(differences)
    ]
    return list(Analysis(structure).run(stages).values())[-1]


@pytest.mark.mpi_once
@pytest.mark.parametrize("differences", [(30.0,), (50.0, -20.0), (10.0, 10.0, 10.0)], ids=len)
def test_stress_after_warming(differences, verified):
    state = warmed(*differences)
    exact = N0 - EH * ALPHA * 30.0 / (1 - NU)
    assert exact == pytest.approx(2714.28571, abs=1e-5)
    np.testing.assert_allclose(state.membrane("sheet").principal, exact, rtol=1e-11)
    assert np.abs(state.displacement).max() < 1e-12
    verified("stress at 30 K", exact, state.membrane("sheet").principal.max())


@pytest.mark.mpi_once
def test_temperature_at_which_the_sheet_goes_slack(verified):
    """Taut below, by the stress that is left; slack just above."""
    assert abs(SLACK - 93.3333) < 1e-4
    below = warmed(SLACK - 5.0).membrane("sheet")
    assert (below.state == "taut").all()
    found = SLACK - 5.0 + below.principal.mean() * (1 - NU) / (EH * ALPHA)
    verified("temperature of slackness", SLACK, found)
    with pytest.warns(LostPrestressWarning, match="'sheet'"):
        above = warmed(SLACK + 0.01).membrane("sheet")
    assert (above.state == "slack").all()


@pytest.mark.mpi_once
def test_force_of_a_fixed_cable(verified):
    cable = Cable([[0, 1], [1, 2]], 1e6, prestress=500.0)
    structure = Structure([[0, 0, 0], [1, 0, 0], [3, 0, 0]], {"cable": cable}, [Support([0, 2])])
    change = TemperatureChange(25.0, "cable", 1.2e-5)
    state = Analysis(structure).run([Stage("warm", changes=[change])])["warm"]
    # The force per natural length, and the natural length per reference length, differ by the strain of warming.
    stretch = np.sqrt(1 - 2 * 1.2e-5 * 25.0)
    np.testing.assert_allclose(state.cable("cable").force, (500.0 - 1e6 * 1.2e-5 * 25.0) * stretch, rtol=1e-10)
    verified("force of a cable", (500.0 - 300.0) * stretch, state.cable("cable").force.max())
