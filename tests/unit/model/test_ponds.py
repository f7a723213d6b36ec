"""Ponds: refused input."""

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Fabric, Membrane, Pond, Stage, Structure, Support, polyline, rectangle


def bowl(slope=0.0, height=0.2):
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points[:, 2] = height * (points[:, 0] ** 2 + points[:, 1] ** 2) + slope * points[:, 0]
    parts = {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3), "edge": Cable(polyline([0, 1, 2]), 1e6)}
    return Structure(points, parts, [Support(range(25))])


def run(structure, *stages):
    return Analysis(structure, progress=False).run(stages)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({}, "no level, volume or rain"),
        ({"level": 0.1, "volume": 1.0}, "level and volume"),
        ({"volume": 0.0}, "volume"),
        ({"volume": -1.0}, "volume"),
        ({"rain": 0.0}, "rain"),
        ({"level": np.nan}, "level"),
        ({"volume": 1.0, "weight": 0.0}, "weight"),
        ({"volume": 1.0, "cells": [1, 1]}, "cell"),
    ],
)
def test_bad_pond_is_refused_in_a_sentence(data, words):
    with pytest.raises(ValueError, match=words) as error:
        Pond("roof", **data)
    assert str(error.value).endswith(".")


@pytest.mark.parametrize(
    ("pond", "words"),
    [
        (Pond("rof", volume=1.0), "does not exist"),
        (Pond("edge", volume=1.0), "a Cable; water stands on membranes"),
        (Pond("roof", level=0.3), "above its lowest rim or drain, node 2"),
        (Pond("roof", level=0.15, drains=[12]), "node 12"),
        (Pond("roof", volume=1.0, cells=[99]), "cell 99"),
        (Pond("roof", volume=1.0, drains=[40]), "node 40"),
        (Pond("roof", volume=1.0, walls=[12]), "node 12"),
    ],
)
def test_pond_that_does_not_fit_is_refused(pond, words):
    with pytest.raises(ValueError, match=words):
        run(bowl(), Stage("water", [pond]))


def test_water_on_a_vertical_or_folded_surface_is_refused():
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    up = points[:, [0, 2, 1]]
    made = Structure(up, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(range(9))])
    with pytest.raises(ValueError, match="cell 0 is vertical"):
        run(made, Stage("water", [Pond("roof", volume=1.0)]))
    folded = points.copy()
    folded[[2, 5, 8], 0] = -0.5
    folded[[2, 5, 8], 2] = 0.5
    made = Structure(folded, {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(range(9))])
    with pytest.raises(ValueError, match="is folded"):
        run(made, Stage("water", [Pond("roof", volume=1.0)]))


@pytest.mark.parametrize(
    ("first", "second", "words"),
    [
        (Pond("roof", volume=0.1), Pond("roof", volume=0.1, cells=[0, 1]), "same cells"),
        (Pond("roof", level=0.1), Pond("roof", volume=0.1), "given level"),
        (Pond("roof", volume=0.1), Pond("roof", volume=0.1, weight=1e4), "weight 10000"),
    ],
)
def test_water_on_water_is_one_pond_or_refused(first, second, words):
    with pytest.raises(ValueError, match=words):
        run(bowl(), Stage("first", [first]), Stage("second", [second], after="first"))


def test_drain_caps_the_level():
    made = bowl()
    drain = int(np.argmin(np.abs(made.points[:, :2] - (0.5, 0.0)).sum(axis=1)))
    pond = run(made, Stage("rain", [Pond("roof", rain=0.5, drains=[drain])]))["rain"].ponds[0]
    assert pond.level == pytest.approx(made.points[drain, 2])
    assert pond.lost + pond.volume == pytest.approx(2.0)


@pytest.mark.parametrize("kind", ["volume", "rain"])
@pytest.mark.parametrize("at_once", [True, False], ids=["at once", "later"])
def test_drains_of_all_ponds_on_the_same_cells_count(kind, at_once):
    """A drain at the lowest node empties the bowl, whichever of the ponds has it."""
    made, amount = bowl(), {kind: 0.05}
    first, second = Pond("roof", **amount), Pond("roof", **amount, drains=[12])
    loads = ([first, second], []) if at_once else ([first], [second])
    results = run(made, Stage("first", loads[0]), Stage("second", loads[1], after="first"))
    pond = results["second"].ponds[0]
    came = 2 * 0.05 * (4 if kind == "rain" else 1)
    assert pond.volume == pytest.approx(0, abs=1e-12)
    assert pond.lost == pytest.approx(came)
