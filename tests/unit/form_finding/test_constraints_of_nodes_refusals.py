"""Slides, rings and bodies that contradict their nodes or supports are refused in words."""

from dataclasses import replace

import pytest

from constrained import cone, with_supports
from fx_membrane import (
    RigidBody,
    Ring,
    Slide,
    natural_force_density,
    projected_stress,
)

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


def off_the_circle():
    structure, ring = cone()
    points = structure.points.copy()
    points[3] *= 1.001
    return replace(structure, points=points), [Ring(ring)]


REFUSED = [
    (off_the_circle, r"node 3 at \(.*\) is 0\.00.* from the circle of radius 1.* move the nodes onto a circle"),
    (lambda: (cone()[0], [Ring([0, 16, 32])]), "nodes on a line, which is no circle"),
    (lambda: (cone()[0], [Ring(range(16)), Slide([3, 40], normal=(0, 0, 1))]), r"Node 3 at .* has two constraints"),
    (lambda: (cone()[0], [Slide([3], normal=(0, 0, 1)), Slide([3], normal=(0, 1, 0))]), "the second a Slide"),
    (lambda: (with_supports("xyz"), [Ring(range(16))]), "held by supports in all its motions"),
    (lambda: (with_supports("xyz", [0, 4, 8]), [Ring(range(16))]), "held by supports in all its motions"),
    (lambda: (with_supports("xyz"), [Slide([3], normal=(0, 0, 1))]), r"Node 3 at .* its support in 'xyz' leaves it no"),
    (lambda: (with_supports("z"), [Slide([3], direction=(1, 0, 1))]), r"Node 3 at .* its support in 'z' leaves it no"),
    (lambda: (cone()[0], [Slide([999], normal=(0, 0, 1))]), "Slide names node 999"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
def test_refusals(method, number):
    make, words = REFUSED[number]
    structure, constraints = make()
    with pytest.raises(ValueError, match=words):
        method(structure, constraints=constraints)


@pytest.mark.mpi
def test_radius_that_supports_forbid_is_named():
    structure = with_supports("xyz", [0, 8])  # two ends of a diameter
    with pytest.raises(RuntimeError, match=r"The Ring with node 0 at .* finds no balance .* give another radius"):
        natural_force_density(structure, constraints=[Ring(range(16), 0.5)])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Slide([0]), "give one of direction"),
        (lambda: Slide([0], (0, 0, 1), (0, 0, 1)), "give one of direction"),
        (lambda: Slide([0], direction=(0, 0, 0)), "Slide direction is zero"),
        (lambda: Slide([0, 7], normal=[(0, 0, 1), (0, 0, 0)]), "Slide normal of node 7 is zero"),
        (lambda: Slide([0, 7], normal=[(0, 0, 1)]), r"shape \(1, 3\); give \(3,\), or \(2, 3\)"),
        (lambda: Ring([0, 1]), "at least three"),
        (lambda: Ring([0, 1, 2], 0.0), "positive"),
        (lambda: RigidBody([0]), "at least two"),
        (lambda: RigidBody([0, 0]), "node 0 twice"),
    ],
)
def test_unfit_data_are_refused(make, words):
    with pytest.raises(ValueError, match=words):
        make()
