"""Rigid-body motions that supports leave free."""

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, Structure, Support, rectangle
from fx_membrane.model.restraint import check_supports, free_motions, loose_ends
from models import rotation

POINTS, TRIANGLES = rectangle(2.0, 1.0, 2, 2)
CORNERS = [0, 2, 6, 8]
LINE = np.linspace([0.0, 0, 0], [3, 2, 1], 4)


def mask(points, *supports):
    held = np.zeros(np.shape(points), dtype=bool)
    for nodes, components in supports:
        for letter in components:
            held[nodes, "xyz".index(letter)] = True
    return held


@pytest.mark.parametrize("size", [1e-3, 1, 1e5])
@pytest.mark.parametrize("offset", [0, 1e3])
@pytest.mark.parametrize(
    ("points", "supports", "count"),
    [
        (POINTS, [], 6),
        (POINTS, [(slice(None), "z")], 3),
        (POINTS, [(0, "xyz")], 3),
        (POINTS, [(0, "xyz"), (2, "xyz")], 1),
        (POINTS, [(0, "xyz"), (2, "yz"), (6, "z")], 0),
        (POINTS, [([0, 2], "xyz"), (1, "xyz")], 1),  # three nodes on one line
        (LINE, [], 5),  # a straight line has no turn about itself
        (LINE, [(0, "xyz")], 2),
        (LINE, [([0, 3], "xyz")], 0),
        (LINE, [(0, "xyz"), (3, "xy")], 0),
    ],
)
def test_number_of_free_motions(points, supports, count, size, offset):
    moved = size * (points + offset * np.array([1.0, -2, 3]))
    assert len(free_motions(moved, mask(points, *supports))) == count


def test_free_motion_about_two_pins_is_the_turn_about_their_line():
    (motion,) = free_motions(POINTS, mask(POINTS, ([0, 2], "xyz")))
    translation, turn = motion[:3], motion[3:]
    assert np.abs(turn) / np.linalg.norm(turn) == pytest.approx([1, 0, 0], abs=1e-9)
    assert translation[:2] == pytest.approx([0, 0], abs=1e-9)


def sheet(*supports, points=POINTS):
    return Structure(points, {"fabric": Membrane(TRIANGLES, Fabric(Et=1e5, nu=0.3))}, supports)


@pytest.mark.parametrize(
    ("supports", "motion"),
    [
        ([], "move along x"),
        ([Support(range(9), "z")], "(move along [xy]|turn about z)"),
        ([Support(CORNERS, "xy")], "move along z"),
        ([Support(4, "xyz")], "turn about [xyz]"),
        ([Support([0, 2], "yz"), Support(6, "z")], "move along x"),
    ],
)
def test_free_sheet_is_refused(supports, motion):
    structure = sheet(*supports)
    message = (
        rf"^The structure is not supported enough: the piece with node 0 \(9 nodes: Membrane 'fabric'\) can {motion} "
        r"as a rigid body\. Add supports or prescribed displacements there\.$"
    )
    with pytest.raises(ValueError, match=message):
        check_supports(structure, structure.supported)


@pytest.mark.parametrize("seed", [1, 2])
def test_one_pinned_node_is_refused_in_any_plane(seed):
    structure = sheet(Support(0), points=POINTS @ rotation(seed).T)
    with pytest.raises(ValueError, match=r"piece.*node 0 \(9 nodes: Membrane 'fabric'\).*turn about [xyz]"):
        check_supports(structure, structure.supported)


@pytest.mark.parametrize(
    "supports",
    [
        [Support(CORNERS)],
        [Support(0), Support(2, "yz"), Support(6, "z")],
        [Support([0, 2])],  # a banner: loads hold the turn about its line
    ],
)
def test_supported_sheet_is_accepted(supports):
    structure = sheet(*supports)
    check_supports(structure, structure.supported)


@pytest.mark.parametrize("kind", [Cable, Mast])
def test_straight_line_pinned_at_both_ends_is_accepted(kind):
    structure = Structure(LINE, {"line": kind([[0, 1], [1, 2], [2, 3]], 1e6)}, [Support([0, 3])])
    check_supports(structure, structure.supported)


def test_line_pinned_at_one_end_is_refused():
    structure = Structure(LINE, {"line": Cable([[0, 1], [1, 2], [2, 3]], 1e6)}, [Support(0)])
    with pytest.raises(ValueError, match=r"piece.*node 0 \(4 nodes: Cable 'line'\).*rigid body"):
        check_supports(structure, structure.supported)


def test_each_piece_needs_supports():
    points = np.vstack([POINTS, POINTS + np.array([0, 0, 5])])
    parts = {name: Membrane(TRIANGLES + i, Fabric(Et=1e5, nu=0.3)) for name, i in [("low", 0), ("high", 9)]}
    structure = Structure(points, parts, [Support(CORNERS)])
    with pytest.raises(ValueError, match=r"piece.*node 9 \(9 nodes: Membrane 'high'\).*move along .*join.*rest"):
        check_supports(structure, structure.supported)
    tied = Structure(points, {**parts, "mast": Mast([[4, 13], [0, 9], [2, 11], [6, 15]], 1e6)}, [Support(CORNERS)])
    check_supports(tied, tied.supported)  # connected: as one rigid body it is held


def test_floating_cable_is_named_with_its_cell():
    points = np.vstack([POINTS, [[5.0, 0, 0], [6, 0, 0], [7, 0, 0]]])
    parts = {
        "fabric": Membrane(TRIANGLES, Fabric(Et=1e5, nu=0.3)),
        "stays": Cable([[0, 4], [9, 10], [4, 8], [10, 11]], 1e6),
    }
    structure = Structure(points, parts, [Support(CORNERS)])
    message = r"the piece with node 9 \(3 nodes: Cable 'stays' \(cells 1, 3\)\) can move along x as a rigid body"
    with pytest.raises(ValueError, match=message):
        check_supports(structure, structure.supported)


def with_a_bar(kind, *supports):
    """Sheet and a bar from its middle down to node 9."""
    parts = {"fabric": Membrane(TRIANGLES, Fabric(Et=1e5, nu=0.3)), "bar": kind([[0, 8], [4, 9]], 1e6)}
    return Structure(np.vstack([POINTS, [[0.0, 0, -1]]]), parts, [Support(CORNERS), *supports])


def test_mast_that_ends_nowhere_is_refused():
    structure = with_a_bar(Mast)
    with pytest.raises(ValueError, match=r"^Mast 1.*'bar' ends nowhere.*node 9\. Support.*node.*join"):
        check_supports(structure, structure.supported)


@pytest.mark.parametrize(("kind", "supports"), [(Mast, [Support(9)]), (Cable, []), (Cable, [Support(9, "x")])])
def test_mast_on_a_support_and_cable_that_hangs_are_accepted(kind, supports):
    structure = with_a_bar(kind, *supports)
    check_supports(structure, structure.supported)
    assert loose_ends(structure, "bar", structure.supported) == ([] if supports else [(1, 9)])


def test_nodes_that_no_part_uses_need_no_supports():
    structure = Structure(
        np.vstack([[[7.0, 7, 7]], POINTS, [[8.0, 8, 8]]]),
        {"fabric": Membrane(TRIANGLES + 1, Fabric(Et=1e5, nu=0.3))},
        [Support(np.array(CORNERS) + 1)],
    )
    check_supports(structure, structure.supported)
