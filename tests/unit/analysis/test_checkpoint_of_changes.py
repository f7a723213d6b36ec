"""Checkpoints of stages that change natural shapes: they resume, and know the changes."""

import numpy as np
import pytest

from fx_membrane import Analysis, LengthChange, PointLoad, PrestressFactor, Stage, TemperatureChange
from interrupted import Killed, counted
from models import CENTRE, masted_roof, same_state


def stages(difference=-40.0, change=0.05):
    return [
        Stage("jack", changes=[LengthChange(change, "mast")], increments=2),
        Stage("cold", [PointLoad(CENTRE, (0, 0, -100.0))], after="jack", increments=3,
              changes=[TemperatureChange(difference, "roof", 2e-5), PrestressFactor(0.8, "edge")]),
    ]  # fmt: skip


@pytest.mark.mpi
@pytest.mark.parametrize("most", [1, 3])
def test_run_goes_on_from_a_checkpoint(path, most):
    expected = Analysis(masted_roof()).run(stages())
    cut = Analysis(masted_roof())
    counted(cut, most)
    with pytest.raises(Killed):
        cut.run(stages(), path)
    resumed = Analysis(masted_roof())
    calls = counted(resumed)
    found = resumed.run(stages(), path)
    assert len(calls) == 5 - most
    assert same_state(found["cold"], expected["cold"])
    assert np.abs(expected["cold"].displacement).max() > 1e-4


@pytest.mark.parametrize(
    ("structure", "changed", "subject"),
    [
        ({}, {"difference": -41.0}, "stage 'cold', which differs in: changes"),
        ({}, {"change": 0.04}, "stage 'jack', which differs in: changes"),
        ({"natural_stretch": 0.999}, {}, "structure, which differs in: natural_stretch of part 'roof'"),
    ],
)
def test_checkpoint_of_other_changes_is_refused(path, structure, changed, subject):
    Analysis(masted_roof()).run(stages(), path)
    with pytest.raises(ValueError, match=subject):
        Analysis(masted_roof(**structure)).run(stages(**changed), path)
