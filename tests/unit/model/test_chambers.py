"""Chambers of a structure: closed, turned outwards, or refused with the place of the fault."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

from cushions import cushion, double_cushion
from fx_membrane import (
    Ambient,
    Chamber,
    GasAmount,
    GasPressure,
    GasVolume,
    Seal,
    Stage,
    Structure,
    Support,
)
from fx_membrane.geometry.closed_surfaces import volume
from fx_membrane.model.chamber_surfaces import surface
from fx_membrane.model.stages import check_stages


def closed(parts, structure=None, **chamber):
    return replace(structure or cushion(), chambers={"gas": Chamber(parts, **chamber)})


def within(structure, name="gas"):
    """Volume of the surface of a chamber, walls included."""
    found = surface(structure, name)
    points = np.vstack([structure.points, found.centers])
    fans = np.column_stack([found.rims, len(structure.points) + np.arange(len(found.rims))])
    return volume(points, np.vstack([found.triangles, fans]))


@pytest.mark.parametrize("parts", [["top", "bottom"], ["bottom", "top"], {"top": 1, "bottom": -1}])
def test_is_turned_outwards(parts):
    assert within(closed(parts)) == pytest.approx(within(closed({"bottom": -1, "top": 1})))
    assert within(closed(parts)) > 0.6


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (["top"], "Chamber 'gas' is not closed: it has a hole of 16 edges about (0, 0, 0), between the nodes 0, 1, 2"),
        (["top", "lid"], "Chamber 'gas' has the part 'lid', which is no membrane; those are ['top', 'bottom']"),
        ({"top": -1, "bottom": 1}, "Chamber 'gas' is inside out: with the senses given its volume is -0.6"),
        ({"top": 1, "bottom": 1}, "normals point to different sides where they meet, at the edge between nodes"),
        ({"top": 2, "bottom": 1}, "Chamber part 'top' has the sense 2; give 1"),
        ([], "Chamber parts is []; give names"),
        (None, "Chamber parts is None; give names"),
        ({"top", "bottom"}, "give names of membranes"),
        ([1, 2], "Chamber parts is 1"),
        ({"top": True, "bottom": -1}, "Chamber part 'top' has the sense True; give 1"),
        ({"top": "up", "bottom": -1}, "Chamber part 'top' has the sense 'up'; give 1"),
        ({"top": np.ones(2), "bottom": -1}, "Chamber part 'top' has the sense"),
        (["top", "top"], "top"),
    ],
)
def test_refusals(parts, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        closed(parts)


def test_flat_films_need_senses():
    flat = cushion(height=0.0, separate=[("top", "bottom")])
    with pytest.raises(ValueError, match=re.escape('say where the normals point, as parts={"top": 1, "bottom": -1}')):
        closed(["top", "bottom"], flat)
    assert within(closed({"top": 1, "bottom": -1}, flat)) == 0


def test_rigid_walls():
    """Half and quarter of a cushion between planes of symmetry; an air hall on the ground."""
    whole = within(closed(["top", "bottom"]))
    points, parts = cushion().points, cushion().parts
    for axes, share in (([0], 2), ([0, 1], 4)):
        kept = {
            name: replace(part, cells=part.cells[(points[part.cells][:, :, axes].mean(axis=1) > 0).all(axis=1)])
            for name, part in parts.items()
        }
        used = np.unique(np.concatenate([part.cells.ravel() for part in kept.values()]))
        planes = [Support(used[np.isclose(points[used, axis], 0)], "xyz"[axis]) for axis in axes]
        piece = Structure(points, kept, [*planes])
        with pytest.raises(ValueError, match="is not closed"):
            closed(["top", "bottom"], piece)
        assert within(closed(["top", "bottom"], piece, rigid_walls=True)) == pytest.approx(whole / share, rel=1e-12)
    rim = np.flatnonzero(np.isclose(np.abs(points[:, :2]).max(axis=1), 1))
    hall = Structure(points, {"top": parts["top"]}, [Support(rim)])
    assert within(closed("top", hall, rigid_walls=True)) == pytest.approx(whole / 2, rel=1e-12)
    loose = replace(hall, supports=[Support(rim[1:])])
    with pytest.raises(ValueError, match="has a hole whose rim is not held between nodes"):
        closed("top", loose, rigid_walls=True)


def test_shared_wall():
    """A wall between two chambers belongs to both, with its two sides."""
    chambers = {"upper": Chamber(["top", "wall"]), "lower": Chamber(["wall", "low"]), "both": Chamber(["low", "top"])}
    structure = double_cushion(chambers)
    upper, lower, both = (within(structure, name) for name in chambers)
    assert upper == pytest.approx(2 * lower)
    assert lower > 0.1
    assert upper + lower == pytest.approx(both)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: GasVolume(0.0, "gas"), "GasVolume volume is 0"),
        (lambda: GasAmount(1e5, -1.0, "gas"), "GasAmount volume is -1"),
        (lambda: GasAmount(0.0, 1.0, "gas"), "GasAmount pressure is 0"),
        (lambda: GasPressure(np.nan, "gas"), "GasPressure pressure"),
        (Ambient, "Ambient has neither pressure nor temperature"),
        (lambda: Ambient(0.0), "Ambient pressure is 0"),
        (lambda: Ambient(temperature=-5.0), "Ambient temperature is -5"),
        (lambda: Ambient(temperature=20.0), "Ambient temperature is 20, at which air is no gas; give kelvins"),
        (lambda: Stage("s", [GasPressure(9.0, "gas")]), "loads has GasPressure(pressure=9.0, chamber='gas'), which"),
        (
            lambda: Stage("s", changes=[GasPressure(9.0, "gas"), Seal("gas")]),
            "Stage 's': changes has GasPressure and Seal of chamber 'gas'; give one of them",
        ),
        (lambda: Chamber("top", exponent=0.5), "Chamber exponent is 0.5"),
    ],
)
def test_values(make, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        make()


def test_stage_names_a_chamber():
    with pytest.raises(ValueError, match=re.escape("of chamber 'gsa', which does not exist; the chambers are ['gas']")):
        check_stages(closed(["top", "bottom"]), [Stage("close", changes=[Seal("gsa")])])


@pytest.mark.parametrize("pressure", [300.0, 600.0, 5e3, 25.0])
def test_gauge_pressure_of_the_air_is_told(pressure):
    with pytest.warns(
        UserWarning, match=f"Ambient pressure is {pressure:g}, .*give absolute pressures.*101325"
    ) as told:
        Ambient(pressure)
    assert told[0].filename == __file__


@pytest.mark.parametrize("pressure", [101_325.0, 70e3, 101.325, 0.101325, 14.7, 2116.0, 1e9])
def test_pressure_of_the_air_in_other_units(pressure):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Ambient(pressure)
