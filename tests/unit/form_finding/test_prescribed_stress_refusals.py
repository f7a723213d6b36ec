"""Prescribed stress as a wish: input that is refused."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Fabric,
    Membrane,
    Pressure,
    RadialDirection,
    Structure,
    Support,
    boundary_edges,
    prescribed_stress,
    rectangle,
)
from own_terms import ElasticBed
from wished_films import canopy

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


def without_edge():
    structure = canopy()
    return replace(structure, parts={"film": structure.parts["film"]})


def on_axis():
    points, triangles = rectangle(2.0, 2.0, 3, 3)
    points[:, :2] += 0.01
    film = Membrane(triangles, Fabric(1e5, 0.3), (2e3, 1e3), warp=(1, 0, 0))
    return Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))])


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("structure", "given", "words"),
    [
        (canopy(prestress=(3e3, 0.0)), {}, r"'film', cell 0 at \(.*\): its stress is not positive"),
        (canopy(), {"stress": {"film": lambda x: -(x[0] ** 2)}}, "its stress is not positive"),
        (canopy(), {"stress": {"film": lambda x: np.zeros((3, 3, 3))}}, r"gives shape \(3, 3, 3\)"),
        (canopy(), {"stress": {"film": lambda x: [[3e3, 500.0], [0.0, 2e3]]}}, "is not symmetric"),
        (canopy(), {"stress": {"roof": len}}, "stress names 'roof', which is no membrane"),
        (canopy(), {"stress": {"film": 3e3}}, "give a function of place"),
        (canopy(), {"warp": {"film": lambda x: np.zeros(3)}}, r"'film', cell 0 at \(.*\): its warp .* vanishes there"),
        (on_axis(), {"warp": {"film": lambda x: np.array([0, 0, 1.0])}}, r"cell 0 at \(.*is normal to the cell"),
        (on_axis(), {"warp": {"film": RadialDirection()}}, r"cell \d+ at \(.*axis of its warp goes through the cell"),
        (without_edge(), {}, r"'film' has an edge at \(.*with neither cable nor support"),
        (canopy(force=-1.0), {}, "'edge', cell 0 at .* is in compression"),
        (replace(canopy(), supports=[]), {}, "tied by no stress to a held node"),
        (replace(canopy(), terms=[ElasticBed("film", 1e3)]), {}, "energy terms"),
        (canopy(), {"loads": [Pressure(1.0, "roof")]}, "roof"),
    ],
)
def test_bad_input_is_refused(structure, given, words):
    with pytest.raises(ValueError, match=words):
        prescribed_stress(structure, **given)
