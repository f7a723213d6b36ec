"""Quantities of case files: units that engineers write, and the traps of the library."""

import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases import units
from fx_membrane.files.cases.units import Units


@pytest.mark.parametrize(
    ("value", "dimension", "expected"),
    [
        ("500 kN/m", "F/L", 500.0),
        ("500000 N/m", "F/L", 500.0),
        (500, "F/L", 500.0),
        ("7", "L", 7.0),
        ("0.6 kN/m2", "F/L^2", 0.6),
        ("0.6 kN/m²", "F/L^2", 0.6),
        ("0.6 kN/m^2", "F/L^2", 0.6),
        ("600 Pa", "F/L^2", 0.6),
        ("1 psf", "F/L^2", 0.04788025898033584),
        ("2 kip", "F", 8.896443230521),
        ("1 lbf/ft", "F/L", 0.014593902937206364),
        ("3 ft", "L", 0.9144),
        ("12 MN", "F", 12e3),
        ("1.2 kg/m2", "F T^2/L^3", 1.2e-3),
        ("2.5 kg/m", "F T^2/L^2", 2.5e-3),
        ("1e3 mm", "L", 1.0),
        ("-.5 m", "L", -0.5),
        ("0.3", "1", 0.3),
        ("1 daN/cm", "F/L", 1.0),
    ],
)
def test_quantity(value, dimension, expected):
    assert Units("kN", "m").number(value, dimension) == pytest.approx(expected, rel=1e-14)


def test_units_of_imperial_structures():
    assert Units("kip", "in").number("1 kip/ft", "F/L") == pytest.approx(1 / 12, rel=1e-14)


@pytest.mark.parametrize(
    ("value", "dimension", "words"),
    [
        ("1,5 kN/m", "F/L", "comma"),
        ("9**9**9**9 m", "L", "no unit"),
        ("100 daN/5cm", "F/L", "divide by 5"),
        ("nan m", "L", "number"),
        ("inf", "L", "number"),
        ("1e999 m", "L", "finite"),
        (float("nan"), "L", "finite"),
        ("5 m + 2 ft", "L", "no unit"),
        ("__import__('os').system('touch x') m", "L", "number"),
        ("3 ft", "F", "no unit of this quantity"),
        ("3 smoots per hour", "L", "unit"),
        ("3 " + "m" * 50, "L", "no unit"),
        ("0.3 %", "1", "no unit"),
        ("0.3 m", "1", "no unit"),
        (True, "L", "number"),
        (None, "L", "number"),
        ([1], "L", "number"),
        ("", "L", "number"),
        ("2 m/", "L", "no known unit"),
        ("2 m23", "L", "unit"),
        ("2 (((((((m", "L", "unit"),
    ],
)
def test_traps_are_refused_in_words(value, dimension, words):
    with pytest.raises(ValueError, match=words):
        Units("kN", "m").number(value, dimension)


@pytest.mark.parametrize(("force", "length"), [("m", "m"), ("kN", "s"), ("", "m"), ("kN/m", "m"), ("3 kN", "m")])
def test_units_of_a_file_are_of_force_and_length(force, length):
    with pytest.raises(ValueError, match="unit"):
        Units(force, length)


def test_pint_reads_a_unit_once_for_all_numbers_of_all_files(monkeypatch):
    registry, read = units._registry(), []
    parse = registry.parse_units
    monkeypatch.setattr(registry, "parse_units", lambda name: (read.append(name), parse(name))[1])
    numbers = [Units("kN", "mm").number(f"{n} MN/km2", "F/L^2") for n in (1, 2, 3)]
    assert numbers == pytest.approx([1e-9, 2e-9, 3e-9], rel=1e-12)
    assert read.count("MN/km2") == 1
