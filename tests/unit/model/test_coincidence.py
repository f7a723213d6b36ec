"""Nodes at one place that no part joins: told, unless supports hold them or their parts are separate."""

import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import Cable, CoincidentNodesWarning, Fabric, Membrane, Structure, Support

FABRIC = Fabric(Et=1e5, nu=0.3)
POINTS = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]])  # no part uses the last one
TRIANGLES = [[0, 1, 2], [0, 2, 3]]

BESIDE = np.vstack([POINTS[:4], POINTS[:4] + np.array([1, 0, 0])])  # the second square begins where the first ends
SQUARES = {"west": Membrane(TRIANGLES, FABRIC), "east": Membrane(np.array(TRIANGLES) + 4, FABRIC)}


@pytest.mark.parametrize("scale", [1e-3, 1, 1e5])
@pytest.mark.parametrize("apart", [0, 1e-10])
def test_parts_that_meet_without_sharing_nodes(scale, apart):
    points = scale * (BESIDE + np.repeat([0, apart], 4)[:, None])
    message = (
        r"^Nodes 1 and 4 are at the same place, \([^)]*, 0, 0\), but nothing joins them \(2 pairs in all\): "
        "cell 0 of 'west' and cell 0 of 'east' can part there. To join them, give .* the same node number"
    )
    with pytest.warns(CoincidentNodesWarning, match=message) as found:
        Structure(points, SQUARES)
    assert len(found) == 1
    assert found[0].filename == __file__  # the user's line


def test_cells_of_one_part_that_do_not_share_nodes():
    with pytest.warns(
        CoincidentNodesWarning, match=r"^Nodes 1 and 2 are .*joins them: cell 0 of 'cable' and cell 1 of 'cable'"
    ):
        Structure([[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]], {"cable": Cable([[0, 1], [2, 3]], 1e6)})


@pytest.mark.parametrize(
    ("points", "supports"),
    [
        (BESIDE + np.repeat([0, 1e-8], 4)[:, None], []),  # a narrow gap
        (BESIDE, [Support([1, 2, 4]), Support([1, 7, 2])]),  # both held, as two anchors on one foundation
        (np.vstack([BESIDE, BESIDE]), [Support([1, 2, 4, 7])]),  # no part uses the second ones
    ],
)
def test_nodes_that_need_not_be_joined(points, supports):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        Structure(points, SQUARES, supports)


def test_one_held_node_of_two_is_not_enough():
    with pytest.warns(CoincidentNodesWarning, match="^Nodes 2 and 7 are"):
        Structure(BESIDE, SQUARES, [Support([1, 2, 4]), Support(7, "xy")])


@pytest.mark.parametrize("separate", [[("top", "bottom")], (["bottom", "top"],)])
def test_coincident_nodes_of_separate_parts_are_meant(separate, recwarn):
    skins = {"top": Membrane(TRIANGLES, FABRIC), "bottom": Membrane(np.asarray(TRIANGLES) + len(POINTS), FABRIC)}
    points = np.vstack([POINTS, POINTS])
    structure = Structure(points, skins, separate=separate)
    assert not recwarn.list
    assert replace(structure, points=2 * points).separate == (tuple(separate[0]),)  # kept by a copy
    assert not recwarn.list
    cable = Cable(np.array([[0, 1]]), 1e6)  # of the top, so that its crossings with the bottom are intended, too
    Structure(points, {**skins, "cable": cable}, separate=separate)
    assert not recwarn.list
    other = Structure(
        np.vstack([points, POINTS[:2]]),
        {**skins, "cable": Cable([[2 * len(POINTS), 2 * len(POINTS) + 1]], 1e6)},
        separate=[*separate, ("cable", "top")],
    )
    (found,) = recwarn.list  # the cable and the bottom
    assert re.search(
        r"cell \d+ of 'bottom' and cell 0 of 'cable' can .*separate=\[\('bottom', 'cable'\)\]", str(found.message)
    )
    assert isinstance(other, Structure)


def test_slit_is_a_part_separate_of_itself(recwarn):
    points = [[0.0, 0, 0], [1, 0, 0], [1, 0, 0], [2, 0, 0]]
    Structure(points, {"cable": Cable([[0, 1], [2, 3]], 1e6)}, separate=[("cable", "cable")])
    assert not recwarn.list


@pytest.mark.parametrize(
    ("separate", "message"),
    [
        ([("fabric", "roof")], r"^separate names part 'roof'.*not exist.*\['fabric'\]"),
        ([("fabric", 3)], "^separate names part 3, which"),
        (("fabric", "fabric"), r"^separate.*'fabric'.*pairs.*names"),
        ([("fabric",)], r"^separate has \('fabric',\); give pairs"),
        (None, "^separate has None; give pairs"),
    ],
)
def test_separate_parts_that_are_no_pairs_of_names(separate, message):
    with pytest.raises(ValueError, match=message):
        Structure(POINTS, {"fabric": Membrane(TRIANGLES, FABRIC)}, separate=separate)
