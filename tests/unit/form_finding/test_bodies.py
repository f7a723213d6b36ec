"""Balance of rings alone: a minimum of the energy, from any start."""

import numpy as np
import pytest

from constrained import cone
from fx_membrane import (
    Ring,
)
from fx_membrane.form_finding.constraints.bodies import settled
from fx_membrane.form_finding.constraints.motions import motions_of
from models import rotation


def body_of(structure, ring, radius=1.0):
    return motions_of(structure, [Ring(ring, radius)]).bodies


@pytest.mark.parametrize("seed", range(5))
def test_body_goes_to_the_least_energy_from_afar(seed):
    # Nearest circle to a turned and scaled one, in a metric without directions: the turn alone, whatever it is.
    bodies = body_of(*cone())
    random = np.random.default_rng(seed)
    goal = bodies[0].first @ rotation(seed).T
    goal[0] += [0.3, -2, 1]
    stretched = goal.copy()
    stretched[1:] *= 1.7
    loose = bodies[0].ways.T @ (stretched - bodies[0].first).ravel()
    start = random.normal(size=len(loose)) * 1e-3
    found, force = settled(bodies, 50.0 * np.eye(len(loose)), loose, start)
    frame = bodies[0].first + (bodies[0].ways @ found).reshape(3, 3)
    assert frame == pytest.approx(goal, abs=1e-10)
    assert 50.0 * (found - loose) == pytest.approx(force, abs=1e-10)


def test_balance_that_is_no_minimum_is_left():
    # Frame turned by half a turn from where the springs want it: in balance, of most energy.
    bodies = body_of(*cone())
    first = bodies[0].first
    wanted = first * np.array([[1], [-1], [-1]])
    loose = bodies[0].ways.T @ (wanted - first).ravel()
    found, _ = settled(bodies, np.eye(len(loose)), loose, np.zeros(len(loose)))
    assert first + (bodies[0].ways @ found).reshape(3, 3) == pytest.approx(wanted, abs=1e-9)


@pytest.mark.parametrize("radius", [1.0, None])
@pytest.mark.parametrize("seed", range(8))
def test_body_goes_down_in_energy(seed, radius):
    # Newton's method alone ends at a largest energy for some of them, as where a ring is pulled far around.
    structure, ring = cone()
    bodies = body_of(structure, ring, radius)
    random = np.random.default_rng(seed)
    size = bodies[0].ways.shape[1]
    root = random.normal(size=(size, size))
    stiffness = root @ root.T + np.eye(size)
    loose = 2 * random.normal(size=size)
    found, _ = settled(bodies, stiffness, loose, np.zeros(size))
    frame = bodies[0].first[1:] + (bodies[0].ways @ found).reshape(3, 3)[1:]
    product = frame @ frame.T
    assert product / product[0, 0] == pytest.approx(np.eye(2), abs=1e-11)
    assert radius is None or product[0, 0] == pytest.approx(1)
    assert (found - loose) @ stiffness @ (found - loose) <= loose @ stiffness @ loose
