"""Digests of structures and stages."""

from decimal import Decimal

import numpy as np
import pytest

from fx_membrane import (
    DistributedLoad,
    Membrane,
    OrthotropicFabric,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
)
from fx_membrane.model.digests import fingerprint, fingerprints, of_stages
from interrupted import stages, structure
from models import POINTS, TRIANGLES

WOVEN = {"nu": 0.0, "Gt": 5}


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (structure(), structure(points=POINTS * [1, 1.01, 1])),
        (structure(), structure(prestress=1001.0)),
        (structure(), structure(stiffness=1.1e6)),
        (
            Structure(POINTS, {"fabric": Membrane(TRIANGLES, OrthotropicFabric(1, 12, **WOVEN), warp=(1, 0, 0))}),
            Structure(POINTS, {"fabric": Membrane(TRIANGLES, OrthotropicFabric(11, 2, **WOVEN), warp=(1, 0, 0))}),
        ),
    ],
    ids=["points", "prestress", "stiffness", "digits of two moduli that follow each other"],
)
def test_another_structure_has_another_fingerprint(before, after):
    assert fingerprint(before) != fingerprint(after)


def test_fingerprints_name_what_differs():
    mine = fingerprints(structure())
    other = structure(points=POINTS * 2, prestress=5.0)
    changed = [name for name, digest in fingerprints(other).items() if digest != mine[name]]
    assert changed == ["points", "prestress of part 'fabric'"]


def test_fingerprint_does_not_change_between_equal_structures():
    assert fingerprint(structure()) == fingerprint(structure())
    assert fingerprint(stages()) == fingerprint(stages())


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (Pressure(20, "m"), Pressure(20.0, "m")),
        (Pressure(np.float32(20), "m"), Pressure(np.int8(20), "m")),
        (DistributedLoad((0, 0, -1), "m"), DistributedLoad(np.array([0.0, -0.0, -1]), "m")),
        (PointLoad([1, 2], (0, 0, 1)), PointLoad(np.array([1, 2], dtype=np.uint16), [0, 0, 1.0])),
        (PrescribedDisplacement(3, (0, 0, 1)), PrescribedDisplacement([3], np.array([0, 0, 1]))),
        (structure(prestress=1000), structure(prestress=1e3)),
        (structure(stiffness=1_000_000), structure(stiffness=np.float64(1e6))),
    ],
)
def test_number_has_one_fingerprint_however_it_is_written(one, other):
    assert fingerprint(one) == fingerprint(other)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1.0, 1.0 + 1e-15),
        (1, "1"),
        (True, 1),
        (None, 0),
        ([1, 2, 3, 4], [[1, 2], [3, 4]]),
        ([1, 2], [1, "2"]),
        (["a", "b"], ["ab"]),
        (np.zeros(5000, dtype=bool), np.arange(5000) == 2500),
        ([], [[]]),
        (Decimal(1), Decimal(2)),
    ],
)
def test_what_differs_has_other_fingerprints(one, other):
    assert fingerprint(one) != fingerprint(other)


def test_digests_of_stages_name_what_differs():
    one, other = of_stages(stages()), of_stages(stages(snow=-201.0, increments=4))
    assert [name for name in one if one[name] != other[name]] == ["loads of stage 'snow'", "increments of stage 'snow'"]
    assert of_stages([Stage("a"), Stage("b")]) != of_stages([Stage("b"), Stage("a")])
