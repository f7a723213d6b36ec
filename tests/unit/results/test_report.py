"""The table of a stage agrees with the result."""

import re
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    StageResults,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
    report,
)


@pytest.fixture(scope="module")
def result():
    """Sheet that is stretched one way and shortened the other, a slack cable on it, a mast under it."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    points = np.vstack([points, [[0, 0, -1]]])
    rim = np.unique(boundary_edges(triangles))
    parts = {
        "fabric": Membrane(triangles, Fabric(Et=1e5, nu=0.3), prestress=50.0),
        "ridge": Cable(polyline(range(10, 15)), 1e6),
        "mast": Mast([[25, 12]], 1e7),
    }
    structure = Structure(points, parts, [Support(25), Support(rim, "z")])
    moves = PrescribedDisplacement(rim, points[rim] * [-0.01, 0.02, 0], "xy")
    return Analysis(structure).run([Stage("fold", [DistributedLoad((0, 0, -100), "fabric")], [moves], increments=2)])[
        "fold"
    ]


def numbers(line):
    return [float(text) for text in re.findall(r"-?\d+\.?\d*(?:e[+-]\d+)?", line)]


def test_table(result):
    lines = report(result, [0, 25], first=1, force_unit="kN", length_unit="cm").splitlines()
    fabric, ridge = result.membrane("fabric"), result.cable("ridge")
    counts = [len(increment.iterations) - 1 for increment in result.increments]
    assert lines[0] == f"Stage 'fold', iterations per increment: {counts}; units as given: kN, cm"
    labels = ["fabric", "", "", "", "ridge", "", "mast", ""]
    assert [line[2:10].strip() for line in lines[1:9]] == labels
    for line, values in zip(lines[1:3], fabric.principal.T, strict=True):
        assert "kN/cm, principal stress" in line
        assert numbers(line)[:2] == pytest.approx([values.min(), values.max()], rel=1e-5)
    states = [np.count_nonzero(fabric.state == state) for state in ("taut", "wrinkled", "slack")]
    assert states[1] > 0
    strain = np.linalg.eigvalsh(fabric.strain).max()
    assert [numbers(lines[3])[i] for i in (0, -3, -2, -1)] == pytest.approx([strain, *states], abs=1e-5)
    slack = np.count_nonzero(ridge.slack)
    assert slack > 0
    found = numbers(lines[5])
    assert found[:2] + found[-2:] == pytest.approx([ridge.force.min(), ridge.force.max(), slack, 4], rel=1e-5)
    force = result.mast("mast").force[0]
    assert numbers(lines[7])[:2] == pytest.approx([force, force], rel=1e-5)
    assert "slack" not in lines[7]
    size = np.linalg.norm(result.displacement, axis=1)
    first = np.flatnonzero(size > (1 - 1e-7) * size.max())[0]  # the fold is symmetric
    assert numbers(lines[9]) == pytest.approx([size.max(), first + 1], rel=1e-5)
    assert size.max() > 1.01 * np.abs(result.displacement).max()
    assert result.largest_displacement == size.max()
    assert f"largest displacement {size.max():.4g})" in repr(result)
    for line, node in zip(lines[10:12], (0, 25), strict=True):
        assert numbers(line)[0] == node + 1
        assert numbers(line)[1:] == pytest.approx(result.reactions[node], rel=1e-5, abs=1e-9)
    assert numbers(lines[12]) == pytest.approx([0, 0, -400, 0, 0, 400], rel=1e-5)
    assert "moments to" in lines[13]
    assert max(numbers(lines[13])) < 1e-6
    assert len(lines) == 14


@pytest.mark.mpi
def test_largest_values_are_given_with_their_cell(result):
    points, parts = result.structure.points, result.structure.parts
    fabric = result.membrane("fabric")
    largest = {
        1: ("fabric", fabric.principal[:, 0]),
        3: ("fabric", np.linalg.eigvalsh(fabric.strain)[:, 1]),
        5: ("ridge", result.cable("ridge").force),
        6: ("ridge", result.cable("ridge").strain),
        7: ("mast", np.abs(result.mast("mast").force)),
        8: ("mast", np.abs(result.mast("mast").strain)),
    }
    lines = report(result, first=1).splitlines()
    for row, (name, values) in largest.items():
        cell, x, y, z = re.search(r"in cell (\d+) at \((.*?), (.*?), (.*?)\)", lines[row]).groups()
        assert values[int(cell)] == pytest.approx(values.max(), rel=1e-12)
        centroid = points[parts[name].cells[int(cell)]].mean(axis=0)
        assert [float(x), float(y), float(z)] == pytest.approx(centroid, rel=1e-3)


def test_strain_of_the_prestress_and_stress_along_warp_and_weft():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    woven = OrthotropicFabric(Et_warp=1e5, Et_weft=5e4, nu=0.2, Gt=5e3)
    stress = np.array([[3e3, 400], [400, 1e3]])
    parts = {
        "woven": Membrane(triangles, woven, stress, warp=(1, 0, 0)),
        "plain": Membrane(triangles, Fabric(1e5, 0.3), 1e3),
        "tie": Cable([[0, 1]], 1e5, 2e3),
        "strut": Mast([[1, 2]], 1e5, -3e3),
    }
    result = Analysis(Structure(points, parts, [Support(range(25))])).run([Stage("rest")])["rest"]
    lines = [line[9:].strip() for line in report(result).splitlines()]
    found = result.membrane("woven").warp_weft_stress
    assert found == pytest.approx(np.tile([3e3, 1e3], (32, 1)), rel=1e-12)
    for line, direction, force in zip(lines[3:5], ("warp", "weft"), (3e3, 1e3), strict=True):
        assert f" N/m, along {direction}, largest in cell" in line
        assert numbers(line)[:2] == pytest.approx([force, force], rel=1e-5)
    before = np.linalg.eigvalsh(woven.strain(stress[None]))[0, 1]
    assert lines[6].startswith(f"largest principal strain with that of the prestress {before:.5f} in cell")
    assert sum("along w" in line for line in lines) == 2  # a plain fabric without a warp has none
    assert "largest strain with that of the prestress 0.02000 in cell 0 at" in lines[12]
    assert "largest strain with that of the prestress -0.03000 in cell 0 at" in lines[14]


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_first_of_equal_cells_is_named(seed):
    """Sums are rounded in another order on other processes: that must not show in the table."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    ties = boundary_edges(triangles)
    parts = {"sheet": Membrane(triangles, Fabric(1e5, 0.3), 1e3), "ties": Cable(ties, 1e5, 2e3)}
    structure = Structure(points, parts, [Support(np.unique(ties))])
    state = Analysis(structure).run([Stage("snow", [DistributedLoad((0, 0, -100.0), "sheet")])])["snow"]

    def rounded(values):
        return values * (1 + 1e-14 * np.random.default_rng(seed).normal(size=values.shape))

    sheet, cable = state.membrane("sheet"), state.cable("ties")
    other = replace(
        state,
        displacement=rounded(state.displacement),
        parts={
            "sheet": replace(sheet, principal=rounded(sheet.principal), strain=sheet.strain * (1 + 1e-14)),
            "ties": replace(cable, force=rounded(cable.force), strain=cable.strain + 1e-16),
        },
    )
    table = report(state).splitlines()
    assert report(other).splitlines()[:-2] == table[:-2]  # the last two tell how far rounding goes
    assert re.search("ties .*largest in cell 0 at", "\n".join(table))


def test_cable_with_a_free_end():
    points = [[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [1, 0, -1]]
    parts = {"line": Cable([[0, 1], [1, 2]], 1e6, 1e3), "rope": Cable([[1, 3]], 1e6)}
    structure = Structure(points, parts, [Support([0, 2])])
    weight = DistributedLoad((0, 0, -10.0), "rope")
    lines = report(Analysis(structure).run([Stage("hang", [weight])])["hang"], first=1).splitlines()
    assert re.search(r": 1, .*\bcell 0 at node 4$", lines[5])
    moves = PrescribedDisplacement(3, (0, 0, 0), "x")
    held = Analysis(structure).run([Stage("hang", [weight], [moves])])["hang"]
    assert not [line for line in report(held, first=1).splitlines() if line.endswith("cell 0 at node 4")]


def test_numbers_are_not_converted(result):
    first, other = report(result), report(result, force_unit="kN", length_unit="mm")
    assert other.replace("kN", "N").replace("mm", "m") == first


def test_without_nodes_there_are_no_reactions_of_nodes(result):
    assert "reaction at" not in report(result)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((5,), "^The first argument.*report is 5.*StageResult"),
        ((None, [26]), "^nodes names node 26, which does"),
    ],
)
def test_refusals(result, arguments, message):
    with pytest.raises(ValueError, match=message):
        report(arguments[0] or result, *arguments[1:])


def test_results_of_all_stages_in_the_place_of_one(result):
    with pytest.raises(ValueError, match=re.escape(f"give a StageResult, as its entry [{result.name!r}].")):
        report(StageResults({result.name: result}))
