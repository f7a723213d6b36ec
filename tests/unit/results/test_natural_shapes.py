"""Results, remarks and reports of states with natural shapes and prestress factors."""

import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    LargeStrainWarning,
    LengthChange,
    LostPrestressWarning,
    Mast,
    Membrane,
    NaturalStretch,
    NeoHooke,
    OrthotropicFabric,
    PrescribedDisplacement,
    Pressure,
    PrestressFactor,
    Problem,
    Stage,
    Structure,
    Support,
    TemperatureChange,
    rectangle,
    report,
)
from fx_membrane.results.initial_stress import reference_stress
from fx_membrane.results.slackness import slack_parts
from models import POINTS, TRIANGLES
from own_laws import Foil, Stiffening

A = np.array([[0.99, 0.004], [0.002, 0.985]])


def held(**parts):
    used = np.unique(np.concatenate([np.ravel(part.cells) for part in parts.values()]))
    return Structure(POINTS, parts, [Support(used)])


@pytest.mark.parametrize("law", [Fabric(1e5, 0.3), OrthotropicFabric(1e5, 6e4, 0.2, 2e4), Foil(1e5)])
def test_stress_in_the_reference_shape_of_membranes(law):
    """That of the state in which no node moves, times the factor of the prestress."""
    data = {"prestress": (400.0, 300.0), "warp": (1, 0.3, 0), "natural_stretch": A, "compression_stiffness": 1.0}
    structure = held(roof=Membrane(TRIANGLES, law, **data))
    state = Analysis(structure).run([Stage("s", changes=[PrestressFactor(0.5, "roof", range(9))])])["s"]
    found = reference_stress(structure, "roof", state.actions)
    np.testing.assert_allclose(found, state.membrane("roof").second_piola_kirchhoff, rtol=0, atol=1e-4)
    assert np.abs(found).max() > 1e3


def test_stress_in_the_reference_shape_of_bars_and_foils():
    """Exact for linear laws; the error of others falls as the square of the natural strain."""
    bars = held(
        cable=Cable([[0, 1], [1, 2]], 1e6, prestress=500.0, natural_stretch=[0.99, 1.01], compression_stiffness=1.0),
        mast=Mast([[3, 4]], 1e6, natural_stretch=1.02),
    )
    state = Analysis(bars).run([Stage("s")])["s"]
    for name, part in state.parts.items():
        np.testing.assert_allclose(reference_stress(bars, name, state.actions)[:, 0, 0], part.force, rtol=1e-9)
    errors = []
    for strain in (0.02, 0.01):
        foil = Membrane(TRIANGLES, NeoHooke(8e4), natural_stretch=1 - strain)
        rope = Cable([[0, 1]], material=Stiffening(1e5, 1e8), natural_stretch=1 - strain)
        structure = held(foil=foil, rope=rope)
        state = Analysis(structure).run([Stage("s")])["s"]
        foil_error = reference_stress(structure, "foil", state.actions) - state.membrane("foil").second_piola_kirchhoff
        rope_error = reference_stress(structure, "rope", state.actions)[:, 0, 0] - state.cable("rope").force
        errors.append([np.abs(foil_error).max(), np.abs(rope_error).max()])
    assert np.all(np.log2(np.divide(errors[0], errors[1])) > 1.8)


def test_strain_is_that_from_the_natural_shape():
    structure = held(roof=Membrane(TRIANGLES, Fabric(1e5, 0.3), natural_stretch=0.98))
    strain = Analysis(structure).run([Stage("s")])["s"].membrane("roof").strain
    assert strain == pytest.approx(np.tile((0.98**-2 - 1) / 2 * np.eye(2), (len(TRIANGLES), 1, 1)), abs=1e-14)


LINE = [[0, 0, 0], [4, 0, 0]]


def line(**data):
    return Structure(LINE, {"stay": Cable([[0, 1]], 1e6, **data)}, [Support(0)])


CLOSER = [PrescribedDisplacement(1, (-0.02, 0, 0))]


@pytest.mark.parametrize(
    ("data", "changes"),
    [
        ({"natural_stretch": 0.999}, []),
        ({}, [NaturalStretch(0.999, "stay")]),
        ({"prestress": 1e3}, []),
        ({"prestress": 1e3}, [LengthChange(0.02, "stay")]),
    ],
    ids=["as built", "made shorter", "prestress", "made longer"],
)
def test_tension_by_a_natural_length_that_is_lost(data, changes):
    with pytest.warns(LostPrestressWarning, match="'stay'"):
        state = Analysis(line(**data)).run([Stage("s", displacements=CLOSER, changes=changes)])["s"]
    assert state.cable("stay").slack.all()


@pytest.mark.filterwarnings("error")
def test_no_prestress_is_lost_where_none_was_given():
    Analysis(line()).run([Stage("s", displacements=CLOSER)])
    Analysis(line(natural_stretch=1.001)).run([Stage("s", displacements=CLOSER)])
    Analysis(line(prestress=1e3)).run([Stage("s", displacements=CLOSER, changes=[PrestressFactor(0.0, "stay")])])


@pytest.mark.filterwarnings("error")
def test_masts_that_cool_or_are_short_lose_no_prestress():
    for data, changes in (({}, [TemperatureChange(-15.0, "mast", 1.1e-5)]), ({"natural_stretch": 0.9998}, [])):
        structure = Structure(LINE, {"mast": Mast([[0, 1]], 1e6, **data)}, [Support(0)])
        state = Analysis(structure).run([Stage("s", displacements=CLOSER, changes=changes)])["s"]
        assert state.mast("mast").force[0] < 0
        assert state.remarks == ()


def test_advice_on_slack_parts_knows_their_tension_by_a_natural_length():
    with pytest.warns(LostPrestressWarning):
        state = Analysis(line(natural_stretch=0.999)).run([Stage("s", displacements=CLOSER)])["s"]
    assert "The prestress of 'stay' is lost there" in slack_parts(state)
    other = Analysis(line(natural_stretch=1.001)).run([Stage("s", displacements=CLOSER)])["s"]
    assert "give it prestress, or a shorter length to begin with" in slack_parts(other)


def test_large_natural_stretch_is_told():
    with pytest.warns(LargeStrainWarning, match=r"Part 'stay' is prestressed by 7\.81 %"):
        Analysis(Structure(LINE, line(natural_stretch=0.93).parts, [Support([0, 1])])).run([Stage("s")])


@pytest.mark.parametrize(("stiffness", "words"), [(1e-4, ""), (1.0, "prestressed by -8.68 %")])
def test_large_natural_excess_is_told_of_parts_that_carry_compression(stiffness, words):
    """A slack cable is free of stress, however far its first shape is from its own length."""
    made = line(natural_stretch=1.1, compression_stiffness=stiffness)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        Analysis(Structure(LINE, made.parts, [Support([0, 1])])).run([Stage("s")])
    strains = [str(one.message) for one in told if one.category is LargeStrainWarning]
    assert bool(strains) == bool(words)
    assert words in "".join(strains)


def test_report_counts_what_is_left_of_the_prestress():
    structure = Structure(LINE, line(prestress=4e4).parts, [Support([0, 1])])
    half = Analysis(structure).run([Stage("s", changes=[PrestressFactor(0.5, "stay")])])["s"]
    assert "largest strain with that of the prestress 0.02000 in cell 0" in report(half)
    shorter = Analysis(structure).run([Stage("s", changes=[NaturalStretch(1.01, "stay")])])["s"]
    strain = 0.04 + (1.01**-2 - 1) / 2
    assert f"largest strain with that of the prestress {strain:.5f} in cell 0" in report(shorter)


def test_rounding_knows_the_stress_of_natural_shapes():
    """A structure that natural lengths alone put under tension is at rest to rounding, as one that prestress does."""
    natural = Problem(held(cable=Cable([[0, 1]], 1e6, natural_stretch=0.999))).under()
    assert natural.magnitudes.prestress_forces == pytest.approx(1e6 * (0.999**-2 - 1) / 2)


@pytest.mark.parametrize(
    ("before", "given", "natural"), [(4e3, 13101, 13146), (2e4, 22940, 23075), (5e4, 50615, 50699)]
)
def test_difference_to_a_prestress_is_that_of_the_readme(before, given, natural):
    """Strip under pressure with the same stress before it."""
    points, triangles = rectangle(10.0, 1.0, 40, 2)
    supports = [Support(np.flatnonzero(np.isclose(abs(points[:, 0]), 5))), Support(np.arange(len(points)), "y")]
    stretch = np.roots([5e5, 0, -5e5, -before]).real.max()  # Et / 2 (stretch^3 - stretch) = stress
    for data, expected in (({"prestress": (before, 0.0)}, given), ({"natural_stretch": (1 / stretch, 1.0)}, natural)):
        strip = Membrane(triangles, Fabric(1e6, 0.0), warp=(1, 0, 0), **data)
        stages = [Stage("rest"), Stage("pressed", [Pressure(600.0, "strip")], after="rest")]
        results = Analysis(Structure(points, {"strip": strip}, supports)).run(stages)
        assert results["rest"].membrane("strip").warp_weft_stress[:, 0] == pytest.approx(before, rel=1e-9)
        assert results["pressed"].membrane("strip").warp_weft_stress[:, 0].mean() == pytest.approx(expected, abs=0.6)
