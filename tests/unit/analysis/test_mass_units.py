"""Units of mass: consistent ones give the same frequencies without a warning, mixed ones with one."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    MassUnitWarning,
    Mast,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    natural_frequencies,
    rectangle,
)
from fx_membrane.analysis.wave_speed import warn_of_mass_units

# Newtons and metres over the unit of force and of length, and kilograms over that of mass.
CONSISTENT = {
    "N m kg": (1.0, 1.0, 1.0),
    "kN m t": (1e3, 1.0, 1e3),
    "N mm t": (1.0, 1e-3, 1e3),
    "kN mm kt": (1e3, 1e-3, 1e6),
    "lbf in": (4.448222, 0.0254, 4.448222 / 0.0254),
    "kip in": (4448.222, 0.0254, 4448.222 / 0.0254),
    "lbf ft slug": (4.448222, 0.3048, 4.448222 / 0.3048),
}
MIXED = {
    "kN m kg": (1e3, 1.0, 1.0),
    "N mm kg": (1.0, 1e-3, 1.0),
    "kN mm kg": (1e3, 1e-3, 1.0),
    "kip ft lb": (4448.222, 0.3048, 0.4536),
}


def roof(force, length, mass, size=8.0, kind=Membrane):
    """Roof of a usual fabric with a steel cable across it, in given units; mass on one or both."""
    points, triangles = rectangle(size / length, 0.75 * size / length, 8, 6)
    fabric = Fabric(Et=500e3 / force * length, nu=0.3)
    parts = {
        "fabric": Membrane(triangles, fabric, 2e3 / force * length, mass=1.05 / mass * length**2 * (kind != Cable)),
        "cable": Cable(
            np.column_stack([np.arange(27, 35), np.arange(28, 36)]),
            12e6 / force,
            20e3 / force,
            mass=0.5 / mass * length * (kind != Membrane),
        ),
    }
    return Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])


def first(structure):
    return natural_frequencies(Analysis(structure).run([Stage("rest")])["rest"], 1).frequencies[0]


@pytest.mark.mpi_once
@pytest.mark.parametrize("units", CONSISTENT)
def test_consistent_units_give_one_frequency_without_a_word(units, recwarn):
    expected = first(roof(1.0, 1.0, 1.0))
    assert 3 < expected < 12
    assert first(roof(*CONSISTENT[units])) == pytest.approx(expected, rel=1e-6)
    assert not [entry for entry in recwarn.list if entry.category is MassUnitWarning]


@pytest.mark.parametrize("size", [2.0, 8.0, 20.0, 100.0])
@pytest.mark.parametrize("kind", [Membrane, Cable, None])
@pytest.mark.parametrize("units", CONSISTENT)
def test_consistent_units_are_taken_at_any_size(units, kind, size, recwarn):
    length = CONSISTENT[units][1]
    warn_of_mass_units(roof(*CONSISTENT[units], size, kind), stacklevel=2)
    assert bool(recwarn.list) == (size / length >= 1000 and length > 0.001)  # more than 1000 in are taken for mm


@pytest.mark.parametrize("size", [3.0, 8.0, 50.0])
@pytest.mark.parametrize("kind", [Membrane, Cable])
@pytest.mark.parametrize("units", MIXED)
def test_mixed_units_are_remarked_on(units, kind, size):
    name = "fabric" if kind is Membrane else "cable"
    words = rf"^Part '{name}', with the mass .*, is too heavy for its .* t with N and mm"
    with pytest.warns(MassUnitWarning, match=words):
        warn_of_mass_units(roof(*MIXED[units], size, kind), stacklevel=2)


def test_frequencies_are_remarked_on_where_they_are_asked_for():
    with pytest.warns(MassUnitWarning) as found:
        frequency = first(roof(*MIXED["kN m kg"]))
    assert [entry.filename for entry in found if entry.category is MassUnitWarning] == [__file__]
    assert frequency == pytest.approx(first(roof(1.0, 1.0, 1.0)) / np.sqrt(1000), rel=1e-6)


@pytest.mark.parametrize(
    ("part", "words"),
    [
        (Membrane([[0, 1, 2]], Fabric(5e5, 0.3), mass=1.05e-3), "'part', with the mass 0.00105, is too light"),
        (Cable([[0, 1], [1, 2]], 1e7, mass=5e-4), "too light"),
        (Cable.from_modulus([[0, 1], [1, 2]], 160e6, 1e-4, density=7850.0), "too heavy"),  # kPa
        (Mast.from_modulus([[0, 1], [1, 2]], 210e6, 1e-3, density=7850.0), "too heavy"),
        (Mast([[0, 1], [1, 2]], 1e12, mass=1.0), None),  # rigid
        (Mast.from_modulus([[0, 1], [1, 2]], 210e9, 1e-3, density=7850.0), None),
        (Cable([[0, 1], [1, 2]], 1e7), None),
    ],
)
def test_bounds(part, words, recwarn):
    points = [[0.0, 0, 0], [8, 0, 0], [0, 8, 0]]
    warn_of_mass_units(Structure(points, {"part": part}, [Support([0, 1, 2])]), stacklevel=2)
    assert [words in str(entry.message) for entry in recwarn.list] == [True] * bool(words)
