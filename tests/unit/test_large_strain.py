"""The warning of strains that the material law is not meant for."""

import warnings

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    LargeStrainWarning,
    Mast,
    Membrane,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    rectangle,
)

POINTS, TRIANGLES = rectangle(1.0, 1.0, 2, 2)
LINE = [[0.0, 0, 0], [1, 0, 0]]


def stretched(points, part, x, y=0.0):
    """Everything moved in the plane, by relative changes of length along x and y."""
    points = np.asarray(points)
    structure = Structure(points, {"part": part}, [Support(range(len(points)), "z")])
    moves = PrescribedDisplacement(range(len(points)), points * [x, y, 0], "xy")
    return Analysis(structure).run([Stage("stretch", displacements=[moves])])


def membrane(**data):
    return Membrane(TRIANGLES, Fabric(Et=1e5, nu=0.3), **data)


@pytest.mark.parametrize(
    ("points", "part", "x", "y"),
    [
        (POINTS, membrane(), 0.06, 0.0),
        (POINTS, membrane(), 0.06, -0.2),  # wrinkled
        (POINTS, membrane(compression_stiffness=1), -0.06, -0.06),
        (LINE, Cable([[0, 1]], 1e6), 0.06, 0.0),
        (LINE, Mast([[0, 1]], 1e6), -0.06, 0.0),
    ],
    ids=["taut", "wrinkled", "in compression", "cable", "mast"],
)
def test_large_strain(points, part, x, y):
    if MPI.COMM_WORLD.rank:  # the first process warns for all
        stretched(points, part, x, y)
        return
    strain = abs(100 * (x + x**2 / 2))
    with pytest.warns(
        LargeStrainWarning, match=rf"^Stage 'stretch': cell \d of part 'part' is strained by {strain:.3g} %"
    ):
        stretched(points, part, x, y)


@pytest.mark.parametrize(
    ("points", "part", "x", "y"),
    [
        (POINTS, membrane(), 0.04, 0.04),
        (POINTS, membrane(), 0.04, -0.2),
        (POINTS, membrane(), -0.2, -0.2),
        (LINE, Cable([[0, 1]], 1e6), 0.04, 0.0),
        (LINE, Cable([[0, 1]], 1e6), -0.2, 0.0),
    ],
    ids=["taut", "wrinkled", "slack", "cable", "slack cable"],
)
def test_moderate_strain_and_what_is_not_resisted(points, part, x, y):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        stretched(points, part, x, y)


@pytest.mark.parametrize(("stretch", "absurd"), [(0.7, False), (0.8, True), (50.0, True)])
def test_strain_above_one_points_to_the_units(stretch, absurd):
    """The strain e + e^2 / 2 is 0.945 and 1.12 in the first two."""
    if MPI.COMM_WORLD.rank:
        stretched(LINE, Cable([[0, 1]], 1e6), stretch)
        return
    with pytest.warns(LargeStrainWarning) as found:
        stretched(LINE, Cable([[0, 1]], 1e6), stretch)
    words = str(found[0].message)
    assert ("Units are probably mixed" in words) == absurd
    assert ("rough values" in words) != absurd


def test_most_strained_part_and_the_number_of_others_are_named():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 3, 0]])
    parts = {"short": Cable([[0, 1]], 1e6), "long": Cable([[0, 2], [2, 3]], 1e6)}
    moves = PrescribedDisplacement(range(4), [[0.0, 0, 0], [0.06, 0, 0], [0, 0.1, 0], [0, 0.3, 0]])
    analysis = Analysis(Structure(points, parts), comm=MPI.COMM_SELF)
    with pytest.warns(
        LargeStrainWarning, match=r"cell 0 of part 'long' is strained by 10\.5 % \(2 more cells"
    ) as found:
        analysis.run([Stage("stretch", displacements=[moves])])
    assert len(found) == 1
    assert found[0].filename == __file__  # where the user called
