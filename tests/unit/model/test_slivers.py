"""Slivers: refused without stiffness left, warned of if digits are lost, correct otherwise."""

import re
import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    SliverWarning,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.geometry.sizes import aspects
from models import rotation


def strip(aspect, move=0.0):
    """Sheet of 4 x 4 pairs of cells of an aspect, in any plane, held along its edge."""
    points, triangles = rectangle(2.0, 2.0 / aspect, 4, 4)
    fabric = Membrane(triangles, Fabric(Et=1e5, nu=0.3), prestress=1e3)
    return Structure(points @ rotation(1).T + move, {"strip": fabric}, [Support(np.unique(boundary_edges(triangles)))])


def deflection(structure):
    """Deflection of the middle under a small load, over the height of the strip: equal for all heights."""
    normal = structure.normals("strip")[0]
    state = Analysis(structure).run([Stage("load", [PointLoad(12, 1e-3 * normal)])])["load"]
    height = np.ptp(structure.points @ rotation(1), axis=0)[1]
    return normal @ state.displacement[12] / height


@pytest.mark.parametrize("aspect", [1e4, 1e5])
def test_slender_cells_are_right(aspect):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert deflection(strip(aspect)) == pytest.approx(deflection(strip(1e3)), rel=1e-4)


@pytest.mark.parametrize("aspect", [1e6, 9e6])
def test_lost_digits_are_told(aspect):
    with pytest.warns(SliverWarning, match=r"^Part 'strip', cell \d+.*sliver.*%.*forces") as told:
        structure = strip(aspect)
    assert told[0].filename == __file__
    share = float(re.search(r"up to (\S+) %", str(told[0].message)).group(1)) / 100
    assert deflection(structure) == pytest.approx(deflection(strip(1e3)), rel=share)


@pytest.mark.parametrize("aspect", [2e7, 1e8, 1e9])
@pytest.mark.parametrize("move", [0.0, 1e3])
def test_sliver_is_named(aspect, move):
    message = r"^Part 'strip', cell \d+ \(nodes \[\d+, \d+, \d+\]\) is a sliver, \S+ times .*, at \(.*\); .*remove"
    with pytest.raises(ValueError, match=message) as refusal:
        strip(aspect, move)
    assert float(re.search(r"sliver, (\S+) times", str(refusal.value)).group(1)) == pytest.approx(aspect, rel=0.1)


def test_unit_of_length_does_not_matter():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0.3, 1e-3, 0], [0.1, 0, 0]])
    cells = np.array([[0, 1, 2], [0, 1, 3]])
    for size in (1e-60, 1.0, 1e59):
        assert aspects(size * points, cells) == pytest.approx([1e3, np.inf])


@pytest.mark.parametrize("kind", [Cable, Mast])
def test_length_that_is_rounding_of_the_coordinates(kind):
    points = np.array([[0.0, 0, 0], [1e-12, 0, 0], [1, 0, 0]])
    Structure(points, {"bars": kind([[0, 1], [1, 2]], 1e6)}, [Support([0, 1])])
    with pytest.raises(ValueError, match=r"^Part 'bars', cell 0 \(nodes \[0, 1\]\).*no length.*\(1000, 0, 0\)"):
        Structure(points + np.array([1e3, 0, 0]), {"bars": kind([[0, 1], [1, 2]], 1e6)})
