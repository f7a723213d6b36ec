"""Refusals and tables say what is meant: plural, truth values, dimensions of laws, parts without stiffness."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Law, Mast, Membrane, Newton, PointLoad, Stage, Structure, Support
from fx_membrane.checks.values import counted
from fx_membrane.model.stages import check_stages


@pytest.mark.parametrize(("count", "words"), [(0, "0 nodes"), (1, "1 node"), (2, "2 nodes"), (-1, "-1 nodes")])
def test_plural(count, words):
    assert counted(count, "node") == words


def test_table_of_a_structure_has_a_plural():
    one = Structure([[0.0, 0, 0], [1, 0, 0]], {"rope": Cable([[0, 1]], 1e6)}, [Support([0, 1])])
    assert repr(one) == "Structure(2 points, {'rope': 1 x Cable}, 1 support)"


def test_truth_value():
    with pytest.raises(ValueError, match=r"^Newton line_search is 1; give True or False\.$"):
        Newton(line_search=1)


@dataclass(frozen=True)
class Bed:
    part: str
    k: float

    def energy(self, state, parameters):
        return parameters.k * state.u[2] ** 2 / 2


POINTS, PARTS = [[0.0, 0, 0], [1, 0, 0]], {"rope": Cable([[0, 1]], 1e6)}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (
            lambda: Structure(POINTS, PARTS, np.arange(2)),
            r"list of Support, not .*; give \[Support\(",
        ),
        (lambda: Structure(POINTS, PARTS, Support(0)), r"supports.*list of Support, .*; put it in brackets"),
        (lambda: Structure(POINTS, PARTS, terms=Bed("rope", 1.0)), r"terms.*energy terms, .*; put it in brackets"),
        (lambda: Structure(POINTS, PARTS, terms=3), r"terms.*energy terms, not 3; give one"),
        (lambda: Stage("a", "rope"), r"loads.*PointLoad.*, or of energy terms, not 'rope'; give \[PointLoad\("),
        (lambda: Stage("a", Bed("rope", 1.0)), r"loads.*, or of energy terms, not Bed.*; put it in brackets"),
        (lambda: Stage("a", PointLoad(1, (0, 0, 1.0))), r"loads.*energy terms, not a PointLoad; put it in brackets"),
        (lambda: check_stages(Structure(POINTS, PARTS), "a"), r"stages.*list of Stage, not 'a'; give \[Stage\("),
    ],
)
def test_brackets_are_the_remedy_for_one_object_alone(make, words):
    with pytest.raises(ValueError, match=words):
        make()


@pytest.mark.parametrize("kind", [Cable, Mast])
def test_part_without_stiffness(kind):
    with pytest.raises(ValueError, match=rf"^{kind.__name__} has neither.*axial_stiffness=.*material="):
        kind([[0, 1]])


@dataclass(frozen=True)
class Solid(Law):
    E: float
    dimension = 3

    def energy(self, E, sigma0, parameters):
        return parameters.E * E[0, 0] ** 2

    @property
    def stiffness(self):
        return self.E


@pytest.mark.parametrize("make", [lambda law: Membrane([[0, 1, 2]], law), lambda law: Cable([[0, 1]], material=law)])
@pytest.mark.parametrize("dimension", [3, 0, "2", None, [1]])
def test_law_of_no_dimension(make, dimension):
    members = {"dimension": dimension, "energy": Solid.energy, "__annotations__": {"E": float}}
    law: Any = dataclass(frozen=True)(type("Solid", (Solid,), members))
    with pytest.raises(ValueError, match=r"whose dimension is .*; give 2 for a law of membranes, 1 for one of cables"):
        make(law(1.0))


def test_law_of_the_other_dimension():
    with pytest.raises(ValueError, match=r"a law of membranes; give one of bars"):
        Cable([[0, 1]], material=Fabric(1e5, 0.3))
