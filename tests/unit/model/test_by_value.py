"""Plain data are equal by their values, and have hashes that go with that."""

import copy
import pickle
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    CableForce,
    CableSag,
    DistributedLoad,
    Fabric,
    Iteration,
    Mast,
    Membrane,
    Outcome,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    RadialDirection,
    Ring,
    RoundHole,
    Slide,
    Solution,
    Stage,
    Structure,
    Support,
)
from models import EDGE, POINTS, TRIANGLES
from own_terms import ElasticBed


def structure(**changes):
    parts = {"roof": Membrane(TRIANGLES, Fabric(1e5, 0.3), 1e3), "edge": Cable([[0, 1]], 1e6)}
    return Structure(**{"points": POINTS.copy(), "parts": parts, "supports": [Support(EDGE)], **changes})


MAKE = [
    lambda z=-1.0: PointLoad([1, 2], (0, 0, z)),
    lambda z=-1.0: DistributedLoad((0, 0, z), "roof"),
    lambda z=-1.0: PlanLoad([0, 0, z], "roof", [1, 2]),
    lambda z=-1.0: Pressure(z, "roof", range(3)),
    lambda z=-1.0: PrescribedDisplacement(2, (0, 0, z), "z"),
    lambda z=-1.0: Stage(
        "snow", [DistributedLoad((0, 0, z), "roof"), ElasticBed("roof", [1.0, 2.0], [0, 1])], after="a"
    ),
    lambda z=1.0: Support(np.array([1, 2 + int(abs(z))])),
    lambda z=1.0: Membrane(TRIANGLES, Fabric(abs(z), 0.3), [1e3, 1e3], warp=(1, 0, 0)),
    lambda z=1.0: Cable([[0, 1], [1, 2]], abs(z), [1.0, 2.0]),
    lambda z=1.0: Mast([[0, 1]], abs(z)),
    lambda z=0.0: structure(points=np.add(POINTS, [0, 0, z])),
    lambda z=1.0: CableForce("edge", abs(z)),
    lambda z=1.0: CableSag("edge", abs(z), along=(1, 0, 0)),
    lambda z=1.0: Slide([1, 2], (1, 0, z)),
    lambda z=1.0: Ring([0, 1, 2, 3], abs(z)),
    lambda z=1.0: RoundHole((0, 0, z), 1.0),
    lambda z=1.0: Solution(Outcome.MECHANISM, "it moves", (Iteration(z, 1.0, 1.0),), motion=np.ones((2, 3))),
    lambda z=1.0: RadialDirection((0, 0, 0), (0, 1, z)),
]


@pytest.mark.parametrize("make", MAKE)
def test_equal_values_are_equal(make):
    one, again, other = make(), make(), make(-3.0)
    assert one == again
    assert hash(one) == hash(again)
    assert one != other
    assert len({one, again, other}) == 2
    assert [other, one].index(again) == 1
    assert copy.deepcopy(one) == pickle.loads(pickle.dumps(one)) == one
    assert one != "roof"
    assert one is not None


def test_kinds_differ():
    assert DistributedLoad((0, 0, 1), "roof") != PlanLoad((0, 0, 1), "roof")
    assert Cable([[0, 1]], 1.0) != Mast([[0, 1]], 1.0)
    assert PointLoad(1, (0, 0, 1)) != PointLoad([1, 2], (0, 0, 1))


def test_notation_of_numbers_does_not_count():
    assert PointLoad(1, (0, 0, 1)) == PointLoad(np.array([1]), [0.0, -0.0, 1.0])
    assert hash(PointLoad(1, (0, 0, 1))) == hash(PointLoad(np.array([1]), [0.0, -0.0, 1.0]))


def test_terms_of_a_user_in_stages_and_structures():
    """Arrays in a dataclass of a user, whose own comparison fails."""
    one, again, other = (Stage("a", [ElasticBed("roof", [k, 2.0], [0, 1])]) for k in (1.0, 1.0, 3.0))
    assert one == again
    assert one != other
    beds = [structure(terms=[ElasticBed("roof", k)]) for k in (1.0, 1.0, 2.0)]
    assert beds[0] == beds[1] != beds[2]

    @dataclass(frozen=True)
    class Another(ElasticBed):
        energy = ElasticBed.energy

    assert Stage("a", [Another("roof", 1.0)]) != Stage("a", [ElasticBed("roof", 1.0)])


def test_structures():
    assert structure() == structure()
    assert hash(structure()) == hash(structure())
    assert replace(structure(), supports=[]) != structure()
    assert structure(parts={"roof": Membrane(TRIANGLES, Fabric(1e5, 0.3), 1e3)}) != structure()
