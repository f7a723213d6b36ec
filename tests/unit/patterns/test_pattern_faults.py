"""Bad input of cutting patterns: one sentence with the place and the remedy, from the function that was called."""

import sys
from types import ModuleType

import numpy as np
import pytest

from cone_gores import cone_gores
from fx_membrane import (
    Allowances,
    Fabric,
    Membrane,
    Structure,
    Support,
    cut_pieces,
    cut_strips,
    cutting_pattern,
    flatten,
    geodesic,
    planar_cut,
    prove_pattern,
    reassembled,
    rectangle,
    with_copies,
    write_patterns,
)
from fx_membrane.patterns.cut_lines import load_shapely
from fx_membrane.patterns.strips import Edge, Strips

pytest.importorskip("potpourri3d")


def roof(bend=lambda points: points, prestress=2e3, without=()):
    points, triangles = rectangle(8.0, 6.0, 8, 6)
    cells = np.delete(triangles, without, axis=0)
    return Structure(bend(points), {"roof": Membrane(cells, Fabric(5e5, 0.3), prestress)}, [Support([0, 8, 54, 62])])


def folded(points):
    """Lay the left half on the right one, some millimetres above it."""
    x, y, z = points.T
    return np.column_stack([np.abs(x), y, np.where(x < 0, z - 1e-3 * x, z)])


def spire(points):
    high = points.copy()
    high[31, 2] = 6.0  # the node in the middle
    return high


def test_a_fold_is_refused_at_its_place():
    with pytest.raises(ValueError, match=r"Strip 'roof' is folded at \(0, .*, 0\): two cells .* lead a seam along"):
        cut_strips(roof(folded), [])


def test_strips_by_hand_are_refused_at_a_fold():
    flat = cut_strips(roof(), [])
    points = folded(flat.structure.points)
    structure = Structure(points, dict(flat.structure.parts), [Support([0, 8, 54, 62])])
    with pytest.raises(ValueError, match=r"Strip 'roof' is folded at \(0, .*, 0\)"):
        flatten(Strips(structure, flat.edges))


def test_a_fold_along_a_seam_is_laid_flat():
    shape = roof(folded)
    middle = shape.points[np.abs(shape.points[:, 0]) < 1e-12]
    flat = flatten(cut_strips(shape, [geodesic(shape, middle[0], middle[-1])]))
    assert [strip.area for strip in flat.values()] == pytest.approx([24, 24], rel=1e-5)


def test_a_ridge_is_no_fold():
    def ridge(points):
        return np.column_stack([points[:, 0] * 0.2, points[:, 1], -np.abs(points[:, 0])])

    assert flatten(cut_strips(roof(ridge), []))["roof"].area == pytest.approx(48 * np.hypot(1, 0.2))


ROOF = roof()
SEAMS = [geodesic(ROOF, (-4, 0, 0), (4, 0, 0))]


@pytest.mark.parametrize(
    ("made", "message"),
    [
        (lambda: geodesic(ROOF, (-4, 0, 1), (4, 0, 0)), r"start \(-4, 0, 1\) is not on the surface, but 1 from it"),
        (
            lambda: cut_strips(ROOF, [geodesic(ROOF, (-4, 0, 0), (1, 0, 0))]),
            r"ends within the surface, at \(1, 0, 0\); lead it on",
        ),
        (
            lambda: cut_strips(ROOF, SEAMS, roll_width=1.0),
            r"'strip 1' around \(.*\) is 3 wide .* more than the roll, 1; set seams closer",
        ),
        (
            lambda: cut_strips(roof(without=[40, 41]), []),
            r"'roof' around .* is no disc, .* one around \(0.5, -0.5, 0\); lead a seam",
        ),
        (
            lambda: flatten(cut_strips(roof(spire), [])),
            r"'roof' is too curved to be laid flat: a cell at \(.*\) .* or would fold; take narrower strips",
        ),
        (
            lambda: cutting_pattern(cut_strips(roof(prestress=0.0), [])),
            r"'roof' has no prestress to compensate; give its membrane a prestress around \(.*\), or",
        ),
    ],
)
def test_bad_input_has_a_place_and_a_remedy(made, message):
    with pytest.raises(ValueError, match=message):
        made()


def test_pieces_of_a_strip_are_told_with_a_place():
    points, triangles = rectangle(2.0, 1.0, 4, 2)
    centres = points[triangles].mean(axis=1)
    apart = triangles[np.abs(centres[:, 0]) > 0.5]
    structure = Structure(points, {"a": Membrane(apart, Fabric(5e5, 0.3), 1e3)}, [Support([0])])
    left, right = ([0, 1, 6, 11, 10, 5, 0], [3, 4, 9, 14, 13, 8, 3])
    edges = tuple(Edge(name, np.array(nodes), ("a",)) for name, nodes in (("left", left), ("right", right)))
    with pytest.raises(ValueError, match=r"in 2 pieces, one around \((-|)0.75, 0, 0\); make each"):
        flatten(Strips(structure, edges))


@pytest.mark.parametrize("function", [flatten, cutting_pattern, with_copies])
def test_what_is_no_strips_is_refused_by_the_function_called(function):
    with pytest.raises(
        ValueError, match=rf"^{function.__name__} needs Strips, but strips is a Structure; give those of"
    ):
        function(ROOF)


@pytest.mark.parametrize(
    "function", [reassembled, prove_pattern, cut_pieces, lambda given: write_patterns(given, "a.csv")]
)
def test_what_is_no_pattern_is_refused_by_the_function_called(function):
    name = "write_patterns" if function.__name__ == "<lambda>" else function.__name__
    with pytest.raises(ValueError, match=rf"^{name} needs a CuttingPattern, but pattern is a Structure; give that of"):
        function(ROOF)


def test_prestress_of_single_strips_is_compensated():
    strips = cut_strips(ROOF, SEAMS)
    given = {"strip 1": (0.99, 0.98), "strip 2": "prestress"}
    found, whole = cutting_pattern(strips, given).compensation, cutting_pattern(strips).compensation
    np.testing.assert_allclose(found["strip 1"], (0.99, 0.98), rtol=1e-12)
    np.testing.assert_allclose(found["strip 2"], whole["strip 2"], rtol=1e-12)


def test_prestress_of_single_strips_must_be_there():
    strips = cut_strips(roof(prestress=0.0), SEAMS)
    assert cutting_pattern(strips, 0.99).compensation["strip 1"] == pytest.approx([0.99, 0.99])
    with pytest.raises(ValueError, match="Strip 'strip 2' has no prestress"):
        cutting_pattern(strips, {"strip 1": 0.99, "strip 2": "prestress"})


@pytest.mark.parametrize(
    ("given", "name"),
    [
        ({"seam": 20}, "seam"),
        ({"border": 50.0}, "border"),
        ({"pocket": 100.0}, "pocket"),
        ({"edges": {"base 2": 120}}, r"edges\['base 2'\]"),
        ({"seam": 2.0}, "seam"),
    ],
)
def test_allowances_in_another_unit_are_refused(given, name):
    pytest.importorskip("shapely.creation")  # of shapely 2
    width = max(strip.width for strip in cone_gores().cloth.values())
    with pytest.raises(
        ValueError, match=rf"^Allowances {name} is .*, more than half of .* 'gore .*' with {width:.4g}; "
    ):
        cut_pieces(cone_gores(), Allowances(**given))


def test_an_older_shapely_is_refused(monkeypatch):
    old = ModuleType("shapely")
    vars(old)["__version__"] = "1.8.5.post1"
    monkeypatch.setitem(sys.modules, "shapely", old)
    with pytest.raises(ImportError, match=r"need shapely 2 or later, and 1\.8\.5\.post1 is installed; renew it by pip"):
        load_shapely()


def test_planes_may_miss_the_surface():
    with pytest.raises(ValueError, match=r"does not cut the surface; the nearest node is at \(-4, -3, 0\)"):
        planar_cut(ROOF, (0, 0, 9), (0, 0, 1))
