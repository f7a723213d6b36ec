"""Length of steps along an equilibrium path."""

from itertools import pairwise

import pytest

from fx_membrane.analysis.step_control import StepControl


@pytest.mark.parametrize(("corrections", "factor"), [(4, 1.0), (9, 2 / 3), (16, 0.5), (100, 0.5), (1, 2.0)])
def test_length_follows_the_root_of_the_desired_number_of_iterations(corrections, factor):
    assert StepControl().stretch(corrections) == pytest.approx(factor)


def test_length_never_grows_with_the_number_of_iterations():
    lengths = [StepControl().stretch(corrections) for corrections in range(1, 30)]
    assert all(after <= before for before, after in pairwise(lengths))
