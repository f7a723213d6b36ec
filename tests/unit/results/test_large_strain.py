"""Warning of strains outside the range of the material law."""

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
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    rectangle,
)

POINTS, TRIANGLES = rectangle(1.0, 1.0, 2, 2)
LINE = [[0.0, 0, 0], [1, 0, 0]]


def stretched(points, part, x, y=0.0):
    """Move all nodes in the plane, by relative changes of length along x and y."""
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
    assert found[0].filename == __file__  # the user's call


def at_rest(part, points=POINTS):
    """Structure with all nodes held, under the prestress alone."""
    return Analysis(Structure(points, {"part": part}, [Support(range(len(points)))]), comm=MPI.COMM_SELF).run(
        [Stage("first"), Stage("second", after="first")]
    )


WOVEN = OrthotropicFabric(Et_warp=2e5, Et_weft=1e5, nu=0.3, Gt=1e4)


@pytest.mark.parametrize(
    ("points", "part", "strain", "advice"),
    [
        (POINTS, Membrane(TRIANGLES, Fabric(5e5, 0.3), prestress=2e6), "280", "Units are probably mixed"),
        (POINTS, membrane(prestress=(1e4, 0.0), warp=(1, 1, 0)), "10", "rough value"),
        (POINTS, Membrane(TRIANGLES, WOVEN, prestress=(0.0, 1e4), warp=(0, 1, 0)), "10", "rough value"),
        (POINTS, Membrane(TRIANGLES, WOVEN, prestress=[[0, 2e3], [2e3, 0]], warp=(0, 1, 0)), "10", "rough value"),
        (LINE, Cable([[0, 1]], 1e6, prestress=6e4), "6", "rough value"),
        (LINE, Cable([[0, 1]], 1e6, prestress=-6e4), "-6", "too stiff"),
        (LINE, Mast([[0, 1]], 1e6, prestress=-6e4), "-6", "rough value"),
    ],
    ids=["isotropic", "one way", "weft", "shear", "cable", "excess", "mast"],
)
def test_large_prestress(points, part, strain, advice):
    with pytest.warns(LargeStrainWarning, match=rf"^Part 'part' is prestressed by {strain} %.*{advice}") as found:
        at_rest(part, points)
    assert len(found) == 1  # of two stages
    assert found[0].filename == __file__


@pytest.mark.parametrize("material", [Fabric(1e5, 0.3), WOVEN], ids=["isotropic", "woven"])
def test_strain_is_that_of_the_stress(material):
    """Inverse of the law of the forms, in a turned warp frame."""
    part = Membrane(TRIANGLES, material, warp=(1, 2, 0), compression_stiffness=1)
    state = stretched(POINTS, part, 0.03, -0.01)["stretch"].membrane("part")
    assert np.abs(state.strain[:, 0, 1]).min() > 0.01
    found = material.strain(state.second_piola_kirchhoff)
    np.testing.assert_allclose(found, state.strain, rtol=0, atol=1e-14)


@pytest.mark.parametrize(
    ("points", "part"),
    [(POINTS, membrane(prestress=7e3)), (LINE, Cable([[0, 1]], 1e6, [4e4])), (LINE, Mast([[0, 1]], 1e6, -4e4))],
    ids=["membrane", "cable", "mast"],
)
def test_moderate_prestress(points, part):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        at_rest(part, points)


@pytest.mark.parametrize(
    ("points", "excess"),
    [(LINE, lambda p: Cable([[0, 1]], 1e6, p * 1e6)), (POINTS, lambda p: membrane(prestress=p * 1e5 / 0.7))],
    ids=["cable", "membrane"],
)
@pytest.mark.parametrize(("stretch", "large"), [(0.08, False), (0.10, True)])
def test_what_takes_up_an_excess_is_no_strain(points, excess, stretch, large):
    """The excess is 4 %, strains are 8.3 % and 10.5 % from the reference shape."""
    if MPI.COMM_WORLD.rank:
        stretched(points, excess(-0.04), stretch, stretch)
        return
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", LargeStrainWarning)
        stretched(points, excess(-0.04), stretch, stretch)
    assert any("is strained by 6.5 %" in str(entry.message) for entry in found) == large
    assert len(found) == large


@pytest.mark.parametrize(("excess", "stiffer"), [(0.02, 1.06), (0.1, 1.31)])
def test_stiffness_of_a_cable_with_an_excess(excess, stiffer):
    """Docstring of `Cable`: the force at a strain of 1e-6 beyond its own length."""
    own = np.sqrt(1 + 2 * excess)
    cable = Cable([[0, 1]], 1e6, prestress=-excess * 1e6)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LargeStrainWarning)
        force = stretched(LINE, cable, own * (1 + 1e-6) - 1)["stretch"].cable("part").force[0]
    assert force == pytest.approx(stiffer, rel=5e-3)
    assert force == pytest.approx((1 + 2 * excess) ** 1.5, rel=1e-4)


def test_stiffness_of_a_membrane_with_an_excess():
    """Docstring of `Membrane`: the same in both directions."""
    own = np.sqrt(1 + 2 * 0.02) * (1 + 1e-6) - 1
    result = stretched(POINTS, membrane(prestress=-0.02 * 1e5 / 0.7), own, own)["stretch"]
    assert result.membrane("part").principal / (1e-6 * 1e5 / 0.7) == pytest.approx(1.04, rel=1e-4)
