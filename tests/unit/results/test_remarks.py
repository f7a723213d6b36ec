"""Remarks on states that hang on slack parts, have fallen, or have lost their prestress; and states without remarks."""

import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    LargeStrainWarning,
    LostPrestressWarning,
    Mast,
    Membrane,
    Newton,
    Outcome,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    UnstableStateWarning,
    boundary_edges,
    equilibrium_path,
    polyline,
    rectangle,
    report,
    stability,
)
from fx_membrane.results.slack_forces import pushes

POINTS = [[0.0, 0, 0], [0, 0, 4], [-3, 2, 0], [-3, -2, 0]]
CARRY = "slack or wrinkled parts carry the structure"
HELD_BY_SLACK = r"mast 'mast' \(cell 0, at node 1\), held by slack parts alone \('guys'\), falls: node 1 moved by"

pytestmark = pytest.mark.filterwarnings(
    "ignore::fx_membrane.UnstableStateWarning", "ignore::fx_membrane.LostPrestressWarning"
)


def guyed(kept=1e-4, prestress=0.0, head=(0.0, 0, 4)):
    """Mast on a hinge with guys on one side only."""
    points = np.array(POINTS)
    points[1] = head
    guys = Cable([[1, 2], [1, 3]], 12e6, prestress, compression_stiffness=kept)
    return Structure(points, {"mast": Mast([[0, 1]], 200e6), "guys": guys}, [Support([0, 2, 3])])


def three_guys(count=3, prestress=1e3):
    """Mast with guys all around, or with some of them forgotten."""
    angles = np.arange(count) * 2 * np.pi / 3
    feet = np.column_stack([3 * np.cos(angles), 3 * np.sin(angles), 0 * angles])
    guys = Cable([[1, 2 + i] for i in range(count)], 12e6, prestress)
    return Structure(
        np.vstack([[[0, 0, 0], [0, 0, 4.0]], feet]),
        {"mast": Mast([[0, 1]], 200e6), "guys": guys},
        [Support([0, *range(2, 2 + count)])],
    )


def push(*force, after=None):
    return Stage("push", [PointLoad(1, force)], after=after)


@pytest.mark.parametrize(
    ("kept", "load", "prestress"),
    [
        *(
            (*case, prestress)
            for case in [(1e-4, 30), (1e-4, 100), (1e-3, 10), (1e-3, 1000)]
            for prestress in (0.0, 100.0)
        ),
        (1e-4, 2e4, 0.0),  # the mast falls; guys on one side keep no prestress, so that with it it falls the same way
    ],
)
def test_mast_that_is_pushed_towards_its_only_guys_is_reported(kept, load, prestress):
    structure = guyed(kept, prestress)
    with pytest.warns(UnstableStateWarning, match="mast 'mast'"):
        result = Analysis(structure).run([Stage("rest"), push(-load, 0, 0, after="rest")])["push"]
    words = " ".join(result.remarks)
    assert "guys" in words
    assert "load factors" not in words  # no load is safe: a reported buckling load would be wrong
    if not any(increment.outcome is Outcome.FALLEN for increment in result.increments):
        assert CARRY in words
        assert f"'guys' is compressed by {-result.cable('guys').force.min():.3g} in cell" in words
        assert not stability(result).stable
    else:
        assert "no load is safe" in words
    assert report(result).startswith("WARNING: ")
    assert [line[9:] for line in report(result).splitlines()[: len(result.remarks)]] == list(result.remarks)


def test_mast_that_falls_is_said_to_fall():
    with pytest.warns(UnstableStateWarning, match=HELD_BY_SLACK):
        result = Analysis(guyed(1e-6)).run([push(-3000, 0, 0)])["push"]
    assert any(increment.outcome is Outcome.FALLEN for increment in result.increments)


def test_mast_that_leans_towards_its_guys_falls():
    with pytest.warns(UnstableStateWarning, match=HELD_BY_SLACK):
        Analysis(guyed(head=(-1.0, 0, 4))).run([push(0, 0, -20_000)])


def test_motion_is_that_of_the_stage():
    """Each of its increments moves the mast by less than half its height; a far node that nothing uses hides none."""
    structure = guyed()
    wide = Structure([*POINTS, [1e3, 0, 0]], structure.parts, structure.supports)
    assert wide.size == structure.size == 4
    result = Analysis(wide).run([push(-400, 0, 0)])["push"]
    assert len(result.increments) > 1
    far = np.linalg.norm(result.displacement[1])
    assert any(f"node 1 moved by {far:.3g}, more than half" in remark for remark in result.remarks)


RIGHT = {
    "away from the guys": (guyed(), [push(100, 0, 50)]),
    "leaning away from the guys": (guyed(head=(1.0, 0, 4)), [push(0, 0, -500)]),
    "three guys without prestress": (three_guys(prestress=0.0), [Stage("rest"), push(200, 0, 0, after="rest")]),
    "one of three guys slack": (three_guys(), [Stage("rest"), push(5000, 0, -100, after="rest")]),
}


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", RIGHT)
def test_structures_that_are_held_get_no_remark(name):
    structure, stages = RIGHT[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStateWarning)
        warnings.simplefilter("error", LostPrestressWarning)
        results = Analysis(structure).run(stages)
    assert [result.remarks for result in results.values()] == [()] * len(stages)
    assert all(stability(result).stable for result in results.values())
    assert report(results["push"]).startswith("Stage 'push', iterations")


def test_forgotten_guy_loses_the_prestress_and_lets_the_mast_go():
    stages = [Stage("rest"), push(200, 0, 0, after="rest"), Stage("back", [PointLoad(1, (-200, 0, 0))], after="rest")]
    with pytest.warns(LostPrestressWarning, match="'rest'.*prestress.*lost: no cell.*'guys'.*1 %"):
        results = Analysis(three_guys(2)).run(stages)
    assert CARRY in " ".join(results["push"].remarks)
    # The other guy holds the mast along itself; across it there is a slack guy.
    assert "mast 'mast' (cell 0, at node 1) is not held in the direction (0, " in results["back"].remarks[0]


def test_slack_leeward_guy_is_ordinary():
    four = [[0.0, 0, 0], [0, 0, 4], [3, 0, 0], [0, 3, 0], [-3, 0, 0], [0, -3, 0]]
    guys = {f"guy {side}": Cable([[1, i]], 12e6, 1e3) for i, side in enumerate(("E", "N", "W", "S"), 2)}
    structure = Structure(four, {"mast": Mast([[0, 1]], 200e6), **guys}, [Support([0, 2, 3, 4, 5])])
    with pytest.warns(LostPrestressWarning, match="no cell.*'guy E'.*1 %.*node 1"):
        result = Analysis(structure).run([Stage("rest"), push(2000, 0, 0, after="rest")])["push"]
    assert len(result.remarks) == 1
    assert "slack under this load" in result.remarks[0]
    assert "check" not in result.remarks[0]
    assert stability(result).stable


def test_slack_diagonal_of_a_roof_is_ordinary():
    points, triangles = rectangle(8.0, 6.0, 8, 8)
    points = np.column_stack([points[:, :2], points[:, 0] * points[:, 1] / 12])
    parts = {
        "fabric": Membrane(triangles, Fabric(5e5, 0.3), 2e3),
        "sagging": Cable(polyline(np.arange(9) * 10), 1e7, 5e3),
        "arching": Cable(polyline(8 + np.arange(9) * 8), 1e7, 5e3),
    }
    structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
    snow = Stage("snow", [DistributedLoad((0, 0, -600.0), "fabric")], after="rest")
    remarks = Analysis(structure).run([Stage("rest"), snow])["snow"].remarks
    assert len(remarks) == 1
    assert "'arching'" in remarks[0]
    assert "mast" not in remarks[0]


def test_small_mast_beside_a_large_one_is_seen():
    small = np.add(POINTS, [50.0, 0, 0])
    large = three_guys(prestress=1e5)
    parts = {
        **large.parts,
        "small": Mast([[5, 6]], 200e6),
        "ropes": Cable([[6, 7], [6, 8]], 12e6),
    }
    supports = [*large.supports, Support([5, 7, 8])]
    structure = Structure(np.vstack([large.points, small]), parts, supports)
    result = Analysis(structure).run([Stage("push", [PointLoad(6, (-20.0, 0, -50.0))])])["push"]
    assert any("mast 'small' (cell 0, at node 6)" in remark and "'ropes'" in remark for remark in result.remarks)


@pytest.mark.parametrize("tension", [1e3, 1e4, 1e6])
@pytest.mark.parametrize("feet", [[4, 5], [2, 4], [0, 4]])
def test_taut_cable_elsewhere_hides_no_mast_on_slack_guys(tension, feet):
    small, used = guyed(), max(feet) + 1
    points = np.vstack([small.points, [[10.0, 0, 0], [10, 0, 5]]])[:used]
    parts = {**small.parts, "heavy": Cable([feet], 1e9, tension)}
    structure = Structure(points, parts, [*small.supports, Support(range(4, used))])
    result = Analysis(structure).run([push(-6, 0, -10)])["push"]
    assert any(CARRY in remark and "mast 'mast'" in remark and "'heavy'" not in remark for remark in result.remarks)
    assert "held by slack parts alone ('guys')" in stability(result).held_by_slack


@pytest.mark.parametrize("line_search", [True, False])
def test_fabric_that_alone_holds_a_mast(line_search):
    points, triangles = rectangle(3.0, 4.0, 4, 4)
    points = np.column_stack([points[:, 0] - 1.5, 0 * points[:, 0], points[:, 1] + 2])
    count, top = len(points), int(np.flatnonzero((points[:, 0] > -1e-9) & (points[:, 2] > 3.9))[0])
    edge = np.flatnonzero((points[:, 2] < 1e-9) | (points[:, 0] < -2.999))
    parts = {"mast": Mast([[count, top]], 200e6), "cloth": Membrane(triangles, Fabric(5e5, 0.3))}
    supports = [Support([count, *edge]), Support(np.arange(count), "y")]
    structure = Structure(np.vstack([points, [[0.5, 0, 0]]]), parts, supports)
    result = Analysis(structure, Newton(line_search=line_search)).run([Stage("push", [PointLoad(top, (-3.0, 0, 0))])])[
        "push"
    ]
    assert any("mast 'mast'" in remark and "'cloth'" in remark for remark in result.remarks)


def test_wrinkles_of_a_sheared_sheet_carry_nothing():
    points, triangles = rectangle(2.0, 1.0, 12, 6)
    ends = (np.flatnonzero(np.abs(points[:, 0] - x) < 1e-9) for x in (-1.0, 1.0))
    structure = Structure(points, {"fabric": Membrane(triangles, Fabric(5e5, 0.3), 10.0)}, [Support(next(ends))])
    moved = PrescribedDisplacement(next(ends), (-0.02, 0.3, 0))
    result = Analysis(structure).run([Stage("pull", displacements=[moved])])["pull"]
    assert (result.membrane("fabric").state == "wrinkled").any()
    assert pushes(result) == []
    assert [remark.category for remark in result.remarks] == [LargeStrainWarning]
    assert stability(result).negative == 0


CLOTH = rectangle(8.0, 6.0, 8, 8)


def upright(prestress, height):
    """Cloth in a vertical plane that is held along one side: at this height of its middle, 3 m up or down."""
    points = CLOTH[0][:, [0, 2, 1]]
    held = np.flatnonzero(np.abs(points[:, 2] - height) < 1e-9)
    return Structure(points, {"cloth": Membrane(CLOTH[1], Fabric(8e5, 0.3), prestress)}, [Support(held)])


@pytest.mark.parametrize(("prestress", "weight"), [(-2e4, 1.0), (-2e4, 5.0), (-8e3, 5.0), (0.0, 5.0)])
def test_curtain_with_too_much_cloth_hangs(prestress, weight):
    stage = Stage("hang", [DistributedLoad((0, 0, -weight), "cloth")])
    result = Analysis(upright(prestress, 3.0)).run([stage])["hang"]
    assert prestress == 0 or (result.membrane("cloth").principal[:, 1] < -0.5).any()
    assert result.remarks == ()
    assert not stability(result).held_by_slack


def test_cloth_that_stands_on_its_lower_side_is_carried_by_compression():
    stage = Stage("stand", [DistributedLoad((0, 0, -0.01), "cloth")])
    structure = upright(0.0, -3.0)
    plane = Structure(structure.points, structure.parts, [*structure.supports, Support(range(81), "y")])
    result = Analysis(plane).run([stage])["stand"]
    assert any(CARRY in remark and "'cloth'" in remark for remark in result.remarks)


def test_sheet_that_is_let_in_has_lost_its_prestress():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    structure = Structure(points, {"fabric": Membrane(triangles, Fabric(1e5, 0.3), 100.0)}, [Support(0)])
    rim = np.unique(boundary_edges(triangles))[1:]
    let_in = PrescribedDisplacement(rim, -0.05 * (points[rim] - points[0]))
    with pytest.warns(LostPrestressWarning, match="no cell.*'fabric'.*1 %.*node"):
        Analysis(structure).run([Stage("let in", [DistributedLoad((0, 0, -0.01), "fabric")], [let_in])])


def test_remarks_are_the_same_from_a_checkpoint_and_on_a_path(tmp_path):
    stages = [push(-20_000, 0, 0)]
    whole = Analysis(guyed()).run(stages, tmp_path / "push")["push"]
    with pytest.warns(UnstableStateWarning, match=HELD_BY_SLACK):
        again = Analysis(guyed()).run(stages, tmp_path / "push")["push"]
    assert again.remarks == whole.remarks != ()
    assert any(increment.outcome is Outcome.FALLEN for increment in again.increments)
    path = equilibrium_path(guyed(), Stage("push", [PointLoad(1, (-100.0, 0, 0))], increments=4))
    with pytest.warns(UnstableStateWarning, match=CARRY):
        assert CARRY in path.state(-1).remarks[0]
