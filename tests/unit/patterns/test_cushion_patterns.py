"""Cutting pattern of a cushion: two films that share their rim, cut at once, with gas between them."""

import numpy as np
import pytest

from fx_membrane import (
    Chamber,
    Fabric,
    GasPressure,
    Membrane,
    Pond,
    Pressure,
    Structure,
    Support,
    boundary_edges,
    cut_strips,
    cutting_pattern,
    nearest_stress_pattern,
    planar_cut,
    prove_pattern,
    rectangle,
    updated_reference,
)

GAS = [GasPressure(300.0, "air")]


@pytest.fixture(scope="module")
def strips():
    """Cut both films of a cushion of 3 m; an edge at two of its corners is within both films."""
    points, triangles = rectangle(3.0, 3.0, 8, 8)
    rim = np.unique(boundary_edges(triangles))
    inner = np.setdiff1d(np.arange(len(points)), rim)
    below = np.arange(len(points))
    below[inner] = len(points) + np.arange(len(inner))
    parts = {
        "top": Membrane(triangles, Fabric(1.6e5, 0.43), 1500.0),
        "bottom": Membrane(below[triangles], Fabric(1.6e5, 0.43), 1200.0),
    }
    flat = Structure(
        np.concatenate([points, points[inner]]), parts, [Support(rim)], [("top", "bottom")],
        chambers={"air": Chamber({"top": 1, "bottom": -1})},
    )  # fmt: skip
    form = updated_reference(flat, [Pressure(300.0, "top"), Pressure(-300.0, "bottom")])
    return cut_strips(form, planar_cut(form, (0, 0, 0), (0, 1, 0)))


@pytest.fixture(scope="module")
def pattern(strips):
    return cutting_pattern(strips, {"top": "prestress", "bottom": 0.99, "bottom 2": "prestress"})


def test_edges_within_both_films_are_no_seams(strips):
    assert strips.names == ("top 1", "top 2", "bottom 1", "bottom 2")
    assert [edge.strips for edge in strips.edges] == [
        ("top 1", "top 2"), ("top 1", "bottom 1"), ("top 2", "bottom 2"), ("bottom 1", "bottom 2"),
    ]  # fmt: skip
    assert strips.cut_from("top") == ("top 1", "top 2")
    assert strips.cut_from("roof") == ()


def test_membranes_name_their_strips(pattern):
    law = 1 / (1 + 1500 * 0.57 / 1.6e5)
    np.testing.assert_allclose(pattern.compensation["top 1"], law, atol=1e-4)
    np.testing.assert_allclose(pattern.compensation["bottom 1"], 0.99, rtol=1e-9)
    np.testing.assert_allclose(pattern.compensation["bottom 2"], 1 / (1 + 1200 * 0.57 / 1.6e5), atol=1e-4)


def test_gas_and_pressures_hold_the_same_shape(strips):
    pattern = cutting_pattern(strips)
    limits = {"top": 3e3, "bottom 2": 2e3}
    by_gas = prove_pattern(pattern, changes=GAS, strength=limits, progress=False)
    pressures = [Pressure(300.0, "top"), Pressure(-300.0, "bottom")]
    by_loads = prove_pattern(pattern, pressures, progress=False)
    assert [load.part for load in by_loads.loads] == ["top 1", "top 2", "bottom 1", "bottom 2"]
    np.testing.assert_allclose(by_gas.state.displacement, by_loads.state.displacement, atol=1e-6)
    assert by_gas.shift.max() < 0.02 * np.ptp(strips.structure.points[:, 2])
    used = {name: strip.largest_utilisation for name, strip in by_gas.strips.items()}
    assert used["top 1"] == pytest.approx(by_gas.state.membrane("top 1").principal.max() / 3e3)
    assert used["bottom 1"] is None
    assert by_gas.utilisation == max(one for one in used.values() if one is not None)


def test_films_are_curved_on_their_own(strips):
    """The angle between both films at the rim is no curvature of either, whose middle is curved as a sphere."""
    proof = prove_pattern(cutting_pattern(strips), changes=GAS, progress=False)
    for name, stress in (("top 1", 1500.0), ("bottom 2", 1200.0)):
        sphere = (300 / (2 * stress)) ** 2
        strip = proof.strips[name]
        assert 0.5 * sphere < np.abs(strip.curvature).max() < 1.2 * sphere
        widest = 2 * np.sqrt(3 * 0.1 * stress * 0.57 / 1.6e5 / sphere)
        assert widest < strip.widest < 1.5 * widest


@pytest.mark.parametrize(
    ("load", "words"),
    [
        (Pressure(300.0, "top", cells=[0]), r"a Pressure is on cells of 'top', .* \['top 1', 'top 2'\]"),
        (Pond("top", level=0.1), r"a Pond is on 'top', which is cut; name the strip"),
    ],
)
def test_loads_that_no_strip_can_take_are_refused(pattern, load, words):
    for prove in (prove_pattern, nearest_stress_pattern):
        with pytest.raises(ValueError, match=f"{prove.__name__} loads: {words}"):
            prove(pattern, [load], progress=False)
