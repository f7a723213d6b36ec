"""Line search on functions of one variable: the length found, and the number of calls."""

import math

import numpy as np
import pytest

from fx_membrane.solvers.line_search import SEARCH, Point, search


def watched(energy, slope):
    """Make a function of one variable for `search`, and the list of lengths at which it is called."""
    called = []

    def along(length):
        called.append(length)
        return Point(length, energy(length), slope(length))

    return along, called


def quadratic(curvature, scale=1.0):
    """Quadratic with slope -scale at zero and its minimum at 1 / curvature."""
    return watched(lambda t: scale * (curvature * t**2 / 2 - t), lambda t: scale * (curvature * t - 1))


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
@pytest.mark.parametrize(("curvature", "calls"), [(1.2, 3), (2.0, 3), (19.0, 3), (100.0, 4), (1e6, 7)])
def test_quadratic_is_searched_exactly(curvature, calls, scale):
    # Each trial is at least a twentieth of the previous one; a minimum within reach is found exactly.
    along, called = quadratic(curvature, scale)
    assert search(along, 0.0) == pytest.approx(1 / curvature, rel=1e-9)
    assert len(called) == calls


@pytest.mark.parametrize("curvature", [-3.0, 0.0, 0.5, 0.95, 1.0, 1.05])
def test_full_step_is_kept_where_it_is_good(curvature):
    along, called = quadratic(curvature)
    assert search(along, 0.0) == 1.0
    assert called == [0.0, 1.0]


def test_full_step_that_lowers_the_energy_but_ends_on_a_steep_rise_is_shortened():
    along, _ = quadratic(1.8)
    assert along(1.0).energy < SEARCH.decrease * along(0.0).slope
    assert search(along, 0.0) == pytest.approx(1 / 1.8, rel=1e-9)


@pytest.mark.parametrize("flatness", [0.5, 0.1, 1e-3, 1e-6])
@pytest.mark.parametrize("stiffening", [1.0, 10.0, 1e3, 1e6])
def test_quartic_is_searched_until_it_is_flat(stiffening, flatness):
    # A cable pulled across is soft at first, then it stiffens.
    along, called = watched(lambda t: stiffening * t**4 / 4 - t, lambda t: stiffening * t**3 - 1)
    found = along(search(along, 0.0, flatness))
    assert abs(found.slope) <= flatness
    assert found.energy < 0
    assert len(called) < 20


@pytest.mark.parametrize("stiffness", [2.0, 1e3, 1e6])
@pytest.mark.parametrize("kink", [0.001, 0.2, 0.9])
def test_stiffness_that_sets_in_within_the_step(kink, stiffness):
    # A cable that is slack at first: the slope has a kink.
    along, called = watched(
        lambda t: stiffness * max(t - kink, 0) ** 2 / 2 - t, lambda t: stiffness * max(t - kink, 0) - 1
    )
    length = search(along, 0.0)
    assert length == (1.0 if kink + 1 / stiffness > 1 else pytest.approx(kink + 1 / stiffness, abs=0.1 / stiffness))
    assert len(called) < 60


@pytest.mark.parametrize("kink", [0.01, 0.3, 0.95])
def test_energy_with_a_kink_is_followed_down_to_it(kink):
    # There is no flat point: the slope jumps from -1 to 3.
    along, called = watched(lambda t: 4 * max(t - kink, 0) - t, lambda t: 3.0 if t > kink else -1.0)
    length = search(along, 0.0)
    assert 0 < length <= 1
    assert along(length).energy == pytest.approx(-kink, abs=1e-9)
    assert len(called) < 600


@pytest.mark.parametrize("seed", range(50))
def test_energy_is_lower_in_proportion_to_slope_and_length(seed):
    rng = np.random.default_rng(seed)
    a, w = rng.normal(size=8) * 10.0 ** rng.uniform(-1, 3), rng.uniform(0.1, 40, 8)
    a *= -np.sign(a @ w)  # downhill at zero
    along, called = watched(lambda t: float(a @ np.sin(w * t)), lambda t: float((a * w) @ np.cos(w * t)))
    length = search(along, 0.0)
    start, end = along(0.0), along(length)
    assert 0 < length <= 1
    assert end.energy <= start.energy + SEARCH.decrease * length * start.slope
    assert abs(end.slope) <= 0.1 * abs(start.slope) or (length == 1 and end.slope < 0)
    assert len(called) < 40


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e200, 1e308])
@pytest.mark.parametrize("limit", [1e-6, 0.1, 0.7])
def test_energy_that_is_no_number_is_too_high(limit, bad):
    along, _ = watched(lambda t: -t if t < limit else bad, lambda t: -1.0 if t < limit else bad)
    length = search(along, 0.0)
    assert 0 < length < limit
    assert length == pytest.approx(limit, abs=1e-9)


@pytest.mark.parametrize(
    "energy", [lambda t: t, lambda t: 1e200 * t, lambda t: math.nan if t else 0.0, lambda t: math.inf if t else 0.0]
)
def test_none_where_no_length_lowers_the_energy(energy):
    along, called = watched(energy, lambda t: -1.0)
    assert search(along, 0.0) is None
    assert len(called) < 600


@pytest.mark.parametrize("seed", range(5))
def test_slopes_decide_where_energies_are_rounding(seed):
    noise = iter(1e-12 * np.random.default_rng(seed).uniform(-1, 1, 1000))
    along, _ = watched(lambda t: -40.0 + next(noise), lambda t: 1e-15 * (2 * t - 1))
    assert search(along, 1e-11) == pytest.approx(0.5, abs=0.05)


def test_full_step_is_kept_where_its_energy_is_higher_by_rounding():
    along, called = watched(lambda t: 1e-12 * t, lambda t: 1e-9 * (0.99 * t - 1))
    assert search(along, 0.0) != 1.0
    called.clear()
    assert search(along, 1e-11) == 1.0
    assert called == [0.0, 1.0]
