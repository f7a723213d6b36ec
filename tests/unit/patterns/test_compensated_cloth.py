"""Cutting patterns: compensation by law, factors and tests; decompensated borders; refusals."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import Fabric, NeoHooke, OrthotropicFabric
from fx_membrane.patterns.biaxial_tests import BiaxialTests
from fx_membrane.patterns.compensated_cloth import cutting_pattern
from fx_membrane.patterns.compensations import stretch_of_stress
from fx_membrane.patterns.flat_shapes import flattened_strips
from gores import catenoid, cone

WOVEN = OrthotropicFabric(6e5, 4e5, 0.3, 2e4)


def seam_gap(strips, flat):
    """Largest difference of both sides of a segment of a seam over its length."""
    lengths = {}
    for one in flat.values():
        for side in one.sides:
            (edge,) = [edge for edge in strips.edges if edge.name == side.edge]
            forward = one.nodes[side.rows[0]] == edge.nodes[0]
            lengths.setdefault(side.edge, []).append(one.side_lengths(side)[:: 1 if forward else -1])
    pairs = [both for both in lengths.values() if len(both) == 2]
    assert pairs
    return max(np.abs(one / other - 1).max() for one, other in pairs)


@pytest.mark.parametrize("law", [Fabric(5e5, 0.3), WOVEN, NeoHooke(1e5)], ids=lambda law: type(law).__name__)
def test_cells_stretched_from_the_cloth_have_their_prestress(law):
    flat = flattened_strips(cone(6, 2, 3, law=law))
    stress = np.tile([[3e3, 200.0], [200.0, 1e3]], (len(flat.pieces.triangles), 1, 1))
    stretch = stretch_of_stress(flat.cloth, stress)
    np.testing.assert_allclose(flat.cloth.stress(stretch), stress, atol=1e-8)
    if law is not WOVEN:
        return
    along, across = stretch[0, 0, 0], stretch[0, 1, 1]
    E = (stretch[0] @ stretch[0] - np.eye(2)) / 2
    S = np.linalg.inv([[1 / 6e5, -0.3 / 6e5], [-0.3 / 6e5, 1 / 4e5]]) @ np.diag(E)
    assert along / across * S[0] == pytest.approx(3e3, rel=1e-2)  # the shear counts to second order


def test_prestress_of_equal_size_shrinks_all_lengths_alike():
    pattern = cutting_pattern(catenoid(8, 4, 8, quarter=True))
    ratio = 1 / np.sqrt(1 + 2 * 4e3 * 0.7 / 5e5)
    for name, cloth in pattern.cloth.items():
        assert pattern.compensation[name] == pytest.approx([ratio, ratio], abs=1e-12)
        np.testing.assert_allclose(cloth.points, ratio * pattern.flat[name].points, atol=1e-11)


@pytest.mark.parametrize("compensation", ["prestress", (0.99, 0.98), 0.995])
def test_seams_stay_equal_after_compensation(compensation):
    strips = catenoid(8, 4, 8, law=WOVEN, prestress=(4e3, 3e3), alternating=False)
    pattern = cutting_pattern(strips, compensation)
    assert seam_gap(strips, pattern.flat) < 1e-11
    assert seam_gap(strips, pattern.cloth) < 1e-11


def test_unequal_factors_of_strips_meet_at_their_seam():
    strips = cone(6, 3, 6)
    factors = {name: (0.99 - 0.002 * number, 0.98) for number, name in enumerate(strips.names)}
    pattern = cutting_pattern(strips, factors)
    assert seam_gap(strips, pattern.cloth) < 1e-11
    assert pattern.compensation["gore 2"] == pytest.approx([0.988, 0.98])


def test_biaxial_tests_give_factors_by_interpolation():
    tests = BiaxialTests([(0, 0), (4e3, 4e3), (2e3, 4e3), (4e3, 2e3)], [(0, 0), (0.004, 0.012), (0.0, 0.02), (0.01, 0)])
    pattern = cutting_pattern(cone(6, 2, 3, law=WOVEN, prestress=(2e3, 2e3)), tests)
    assert pattern.compensation["gore 1"] == pytest.approx([1 / (1 + 0.01 / 3), 1 / (1 + 0.02 / 3)])
    assert tests.at((3e3, 4e3)) == pytest.approx([0.002, 0.016])
    with pytest.raises(ValueError, match=r"\(5000, 4000\) is outside the biaxial tests.* add a test beyond it"):
        tests.at((5e3, 4e3))


def test_tests_at_one_load_ratio_are_interpolated_along_it():
    tests = BiaxialTests([(4e3, 4e3), (2e3, 2e3), (3e3, 3e3)], [(0.004, 0.012), (0.002, 0.004), (0.003, 0.006)])
    assert tests.at((3.5e3, 3.5e3)) == pytest.approx([0.0035, 0.009])
    for outside in ((3e3, 2e3), (5e3, 5e3), (1e3, 1e3)):
        with pytest.raises(ValueError, match="outside the biaxial tests"):
            tests.at(outside)


@pytest.mark.parametrize("third", [[], [((1e3, 2e3), (0.001, 0.008))]])
@pytest.mark.parametrize("beyond", [3e-13, 1e-6, 5e-3])
def test_pair_beyond_tests_within_their_accuracy_counts_as_tested(third, beyond):
    pairs = [((1e3, 1e3), (0.003, 0.006)), ((2e3, 2e3), (0.004, 0.007)), *third]
    tests = BiaxialTests(*zip(*pairs, strict=True))
    for factors in ((1, 1), (1, -1), (0, -1), (1, 0)):
        pair = 2e3 * (1 + beyond * np.array(factors))
        assert tests.at(pair) == pytest.approx([0.004, 0.007], abs=2.5 * beyond * 0.003 + 1e-8)
    with pytest.raises(ValueError, match="outside the biaxial tests"):
        tests.at((2.05e3, 2e3))


@pytest.mark.parametrize(
    ("stress", "elongation", "message"),
    [
        ([(1, 1)], [(0.01, 0.01)], "at least two tests"),
        ([(1, 1), (1, 1)], [(0.01, 0.01)] * 2, "a pair twice"),
        ([(1, 1), (2, 2)], [(0.4, 1.2), (0.5, 1.4)], "as 0.012 for 1.2 %"),
    ],
)
def test_refusals_of_biaxial_tests(stress, elongation, message):
    with pytest.raises(ValueError, match=message):
        BiaxialTests(stress, elongation)


def test_decompensated_borders_keep_their_length():
    strips = catenoid(8, 4, 16, quarter=True)
    borders = ["bottom 1", "bottom 2"]
    pattern = cutting_pattern(strips, decompensate=borders, transition=1.5)
    for name, cloth in pattern.cloth.items():
        shares = {}
        for side in cloth.sides:
            nodes = cloth.nodes[side.rows]
            true = np.linalg.norm(np.diff(strips.structure.points[nodes], axis=0), axis=1)
            shares[side.edge.split()[0]] = cloth.side_lengths(side) / true
        assert shares["bottom"] == pytest.approx(1.0, abs=1e-11)
        ratio = 1 / np.sqrt(1 + 2 * 4e3 * 0.7 / 5e5)
        flat = pattern.flat[name]
        top = next(side for side in flat.sides if side.edge.startswith("top"))
        assert cloth.side_lengths(top) == pytest.approx(ratio * flat.side_lengths(top), rel=5e-4)
    assert seam_gap(strips, pattern.cloth) < 1e-11
    assert pattern.decompensated == tuple(borders)


def test_edges_are_decompensated_by_the_name_of_their_line():
    """A cable along several edges stands for all of them; an edge of the same name goes first."""
    strips = cone(6, 2, 4)
    ring = [edge.name for edge in strips.edges if edge.name.startswith("bottom")]
    roped = replace(strips, edges=tuple(replace(e, line="rope" if e.name in ring else None) for e in strips.edges))
    pattern = cutting_pattern(roped, 0.99, decompensate="rope", transition=1.0)
    by_edges = cutting_pattern(strips, 0.99, decompensate=ring, transition=1.0)
    assert pattern.decompensated == by_edges.decompensated == tuple(ring)
    for name, cloth in by_edges.cloth.items():
        assert np.array_equal(pattern.cloth[name].points, cloth.points)
    named = replace(strips, edges=tuple(replace(edge, line=ring[0]) for edge in strips.edges))
    assert cutting_pattern(named, 0.99, decompensate=ring[0], transition=1.0).decompensated == (ring[0],)
    with pytest.raises(ValueError, match=r"no edge is named 'rop'; .*, and lines along them \['rope'\]"):
        cutting_pattern(roped, 0.99, decompensate="rop", transition=1.0)


def test_cloth_is_not_compensated_around_a_node():
    strips = catenoid(8, 8, 16, quarter=True)
    corner = int(next(edge for edge in strips.edges if edge.name == "bottom 1").nodes[0])
    pattern = cutting_pattern(strips, decompensate=corner, transition=2.0)
    ratio = np.sqrt(pattern.cloth["gore 1"].areas / pattern.flat["gore 1"].areas)
    row = np.flatnonzero(pattern.cloth["gore 1"].nodes == corner)[0]
    near = (pattern.cloth["gore 1"].triangles == row).any(axis=1)
    assert ratio[near].max() > 0.998
    assert ratio.min() == pytest.approx(1 / np.sqrt(1 + 2 * 4e3 * 0.7 / 5e5), rel=1e-3)


REFUSED = [
    ({"prestress": 0.0}, {}, r"Strip 'gore 1' has no prestress to compensate; give .* around \(.*, 2.5\)"),
    ({"prestress": 4e5}, {}, r"Strip 'gore .': the prestress stretches a cell by a factor of .* at \(.*\); check"),
    ({}, {"compensation": -0.99}, r"compensation of strip 'gore 1' is \[-0.99, -0.99\]; give ratios"),
    ({}, {"compensation": (0.99, 0.01)}, r"between 0.8 and 1.25"),
    ({}, {"compensation": (1.2, 0.8)}, r"is \[1.2, 0.8\]: cloth 20 % longer .*not percentages, as 0.988"),
    ({}, {"compensation": "law"}, r"compensation is 'law'; give 'prestress', factors, or BiaxialTests"),
    (
        {},
        {"compensation": dict.fromkeys((f"gore {k}" for k in range(1, 7)), "law")},
        r"compensation of strip 'gore 1' is 'law'; .*prestress",
    ),
    ({}, {"compensation": (0.99, 0.99, 1)}, r"has shape \(3,\); give one ratio"),
    ({}, {"compensation": "law"}, "compensation"),
    ({}, {"compensation": {"gore 1": 0.99, "x": 1}}, r"'x' is no strip; the strips are"),
    ({}, {"decompensate": "rim", "transition": 1}, r"no edge is named 'rim'; the edges are \['bottom 1'"),
    ({}, {"decompensate": 10**6, "transition": 1}, r"node 1000000 is on no strip"),
    ({}, {"decompensate": "bottom 1"}, r"give transition="),
    ({}, {"transition": 0.5}, r"transition is 0.5, but nothing is decompensated; give decompensate="),
    ({}, {"decompensate": "bottom 1", "transition": -1}, "transition"),
    ({}, {"decompensate": None}, r"decompensate is None; give names of edges"),
    ({}, {"decompensate": [1.5], "transition": 1}, "decompensate node"),
    ({}, {"compensation": None}, "compensation of strip 'gore 1'"),
    ({}, {"seam_difference": -1}, "seam_difference"),
]


@pytest.mark.parametrize(("strips", "given", "message"), REFUSED)
def test_refusals(strips, given, message):
    made = cone(6, 1, 2, **strips)
    with pytest.raises(ValueError, match=message):
        cutting_pattern(made, **given)
