"""README's numbers for the difference between a prestress and a natural shape, against closed forms and the program."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from fx_membrane import Analysis, Fabric, Membrane, Pressure, Stage, Structure, Support, rectangle

ET, PRESSURE, HALF = 1e6, 600.0, 5.0  # [N/m], [N/m2], [m]
ROW = re.compile(r"^\| (\d+) \| ([\d.]+) % \| ([\d.]+) \| ([\d.]+) \| \+ ([\d.]+) % \|$", re.MULTILINE)
ROWS = ROW.findall((Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8"))


def law(stretch):
    """Force per width of a strip over its natural width."""
    return ET * stretch * (stretch**2 - 1) / 2


def under_pressure(force):
    """Force per width of an arc whose force follows from its stretch."""
    angle = brentq(
        lambda angle: force(angle / np.sin(angle)) * np.sin(angle) - PRESSURE * HALF, 1e-6, 1.0, xtol=1e-15, rtol=1e-14
    )
    return force(angle / np.sin(angle))


def natural_stretch(before):
    """Natural over reference length of a strip with a force in the reference shape."""
    return 1 / brentq(lambda stretch: law(stretch) - before, 1.0, 1.2, xtol=1e-15)


def computed(**stress):
    points, triangles = rectangle(2 * HALF, 0.25, 80, 1)
    ends = np.flatnonzero(np.isclose(np.abs(points[:, 0]), HALF))
    strip = Membrane(triangles, Fabric(ET, 0.0), warp=(1, 0, 0), **stress)
    structure = Structure(points, {"strip": strip}, [Support(ends), Support(np.arange(len(points)), "y")])
    blown = Stage("blown", [Pressure(PRESSURE, "strip")], increments=4)
    return Analysis(structure, progress=False).run([blown])["blown"].membrane("strip").principal[:, 0].mean()


@pytest.mark.parametrize("row", ROWS)
def test_closed_forms(row):
    before, strain, as_prestress, as_natural, rise = map(float, row)
    before *= 1e3
    assert round(100 * before / ET, 1) == strain
    stress = under_pressure(lambda stretch: stretch * before + law(stretch))
    other = under_pressure(lambda stretch: law(stretch / natural_stretch(before)))
    assert stress == pytest.approx(1e3 * as_prestress, abs=0.6)
    assert other == pytest.approx(1e3 * as_natural, abs=0.6)
    assert 100 * ((other - before) / (stress - before) - 1) == pytest.approx(rise, abs=0.1)


def test_program():
    assert len(ROWS) == 3
    before, _, as_prestress, as_natural, _ = map(float, ROWS[1])
    assert computed(prestress=1e3 * before) == pytest.approx(1e3 * as_prestress, rel=1e-4)
    stretch = natural_stretch(1e3 * before)
    assert computed(natural_stretch=(stretch, 1.0)) == pytest.approx(1e3 * as_natural, rel=1e-4)
