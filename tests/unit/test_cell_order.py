"""Results are independent of the order of nodes in a cell: random rotations and reversals against one mesh."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from cell_orders import assert_same, shuffled
from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PlanLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    equilibrium_path,
    natural_frequencies,
    plot,
    rectangle,
    report,
    stability,
    stress_trajectories,
    structure_from_gmsh,
    updated_reference,
    wrinkle_lines,
)
from fx_membrane.geometry.sizes import normals
from fx_membrane.model.digests import fingerprints

SEEDS = [1, 2]
FABRIC = Fabric(Et=1e5, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=1e5, Et_weft=6e4, nu=0.2, Gt=5e3)
FLAT, TRIANGLES = rectangle(2.0, 2.0, 6, 6)
POINTS = FLAT + np.array([[0, 0, 0.2 * x * y + 0.1 * x**2] for x, y, _ in FLAT])
LEFT = FLAT[TRIANGLES].mean(axis=1)[:, 0] < 0
TENSORS = np.array([[[900.0, 150 + 3 * k], [150 + 3 * k, 700]] for k in range(np.count_nonzero(LEFT))])
STAGES = [
    Stage("air", [Pressure(300.0, "plain"), Pressure(150.0, "woven", range(5, 20))]),
    Stage("snow", [PlanLoad((400.0, 0, -4000.0), "woven")], after="air", increments=2),
]


def roof(seed=None):
    """Plain and woven fabric side by side, with shear in the prestress of both, a cable, a mast below."""

    def order(cells):
        return cells if seed is None else shuffled(cells, seed)

    parts = {
        "plain": Membrane(order(TRIANGLES[LEFT]), FABRIC, TENSORS, warp=(1, 0.2, 0), mass=1.0),
        "woven": Membrane(order(TRIANGLES[~LEFT]), WOVEN, [[1000, -200], [-200, 600]], warp=(1, 1, 0), mass=1.0),
        "ridge": Cable(order(np.column_stack([np.arange(21, 27), np.arange(22, 28)])), 1e6, 3e3, mass=1.0),
        "mast": Mast(order(np.array([[49, 24], [49, 10]])), 1e6, mass=1.0),
    }
    return Structure(np.vstack([POINTS, [[0, 0, -1]]]), parts, [Support([*np.unique(boundary_edges(TRIANGLES)), 49])])


@cache
def solved(seed):
    """Return the results of both stages, for tests that only read them."""
    return Analysis(roof(seed)).run(STAGES)


@pytest.fixture(scope="module")
def expected():
    return solved(None)


def test_two_triangles_have_one_shear():
    cells = [[0, 1, 2], [0, 3, 2]]  # the second seen from below
    square = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    fabric = Membrane(cells, FABRIC, [[10, 4], [4, 10]], warp=(1, 0, 0))
    result = Analysis(Structure(square, {"fabric": fabric}, [Support(range(4))])).run([Stage("rest")])["rest"]
    state = result.membrane("fabric")
    assert state.cauchy[:, 0, 1] == pytest.approx([4, 4], rel=1e-12)
    assert state.second_piola_kirchhoff[:, 0, 1] == pytest.approx([4, 4], rel=1e-12)
    assert fabric.cells.tolist() == cells  # the user's own data are unchanged


@pytest.mark.parametrize("seed", SEEDS)
def test_turned_cells_keep_their_rows_and_data(seed):
    mixed, ordered = roof(seed), roof()
    for name in ("plain", "woven"):
        cells = mixed.parts[name].cells
        assert np.sort(cells).tolist() == np.sort(ordered.parts[name].cells).tolist()
        assert mixed.normals(name) == pytest.approx(ordered.normals(name), abs=1e-14)
        assert normals(mixed.points, cells) == pytest.approx(mixed.normals(name), abs=0)
        assert mixed.warp(name) == pytest.approx(ordered.warp(name), abs=1e-14)
        assert np.array_equal(mixed.parts[name].prestress, ordered.parts[name].prestress)
        assert not cells.flags.writeable


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", SEEDS)
def test_results_of_stages(seed, expected):
    states = np.concatenate([part.state for part in expected["snow"].parts.values() if hasattr(part, "state")])
    assert set(states) >= {"taut", "wrinkled"}
    assert np.abs(expected["snow"].membrane("woven").strain[:, 0, 1]).max() > 1e-3
    found = solved(seed)
    for name in expected:
        assert_same(found[name], expected[name])


@pytest.mark.parametrize("seed", SEEDS)
def test_report(seed, expected):
    def table(result):  # without the balance, which is rounding
        return [line for line in report(result, nodes=[0, 49]).splitlines() if "balance" not in line]

    assert table(solved(seed)["snow"]) == table(expected["snow"])


@cache
def uneven(seed):
    """State of a woven sheet on an uneven mesh, wrinkled in some regions."""
    points, cells = rectangle(4.0, 3.0, 10, 8)
    rim = np.unique(boundary_edges(cells))
    inside = np.setdiff1d(np.arange(len(points)), rim)
    points[inside, :2] += np.random.default_rng(9).uniform(-0.05, 0.05, (len(inside), 2))
    x, y = points[:, 0], points[:, 1]
    points[:, 2] = 0.15 * x * y - 0.05 * x**2 + 0.03 * np.sin(1.7 * x + y)
    woven = OrthotropicFabric(6e5, 4e5, 0.3, 2e4)
    mixed = cells if seed is None else shuffled(cells, seed)
    sheet = Structure(points, {"sheet": Membrane(mixed, woven, (2e3, 500.0), warp=(1, 0.3, 0))}, [Support(rim[5:])])
    return Analysis(sheet).run([Stage("snow", [DistributedLoad((200.0, 0, -1600.0), "sheet")])])["snow"]


@pytest.mark.study("seed")
@pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")
@pytest.mark.parametrize("lines", [wrinkle_lines, stress_trajectories])
@pytest.mark.parametrize("seed", SEEDS)
def test_lines_on_surfaces(seed, lines):
    wanted, found = lines(uneven(None), spacing=0.1), lines(uneven(seed), spacing=0.1)
    assert [len(line.points) for line in found] == [len(line.points) for line in wanted]
    for ours, theirs in zip(found, wanted, strict=True):
        assert ours.points == pytest.approx(theirs.points, abs=1e-9)


@pytest.mark.mpi
def test_modes_and_stability(expected):
    found = solved(1)["air"]
    wanted = natural_frequencies(expected["air"], 3).frequencies
    assert natural_frequencies(found, 3).frequencies == pytest.approx(wanted, rel=1e-9)
    assert stability(found).stiffnesses == pytest.approx(stability(expected["air"]).stiffnesses, rel=1e-8)


def test_path(expected):
    stage = Stage("more air", [Pressure(200.0, "plain")], after="air")
    found = equilibrium_path(solved(1)["air"], stage, load_factor=1.0)
    wanted = equilibrium_path(expected["air"], stage, load_factor=1.0)
    assert found.load_factors == pytest.approx(wanted.load_factors, rel=1e-8)
    assert_same(found.displacements[-1], wanted.displacements[-1])


@pytest.mark.parametrize("seed", SEEDS)
def test_form_finding(seed):
    def form(order):
        cells = TRIANGLES if order is None else shuffled(TRIANGLES, order)
        fabric = Membrane(cells, WOVEN, (2e3, 1e3), warp=(1, 0.3, 0))
        rim = Structure(
            POINTS + FLAT**2 * [0, 0, 0.3], {"fabric": fabric}, [Support(np.unique(boundary_edges(TRIANGLES)))]
        )
        return updated_reference(rim, [Pressure(300.0, "fabric")])

    found, wanted = form(seed), form(None)
    assert found.structure.points == pytest.approx(wanted.structure.points, abs=1e-10)
    assert_same(found.structure.parts["fabric"].prestress, wanted.structure.parts["fabric"].prestress)
    assert np.array(found.steps) == pytest.approx(np.array(wanted.steps), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("seed", SEEDS)
def test_checkpoint_is_of_the_same_structure(seed):
    assert fingerprints(roof(seed)) == fingerprints(roof())
    other = roof(seed)
    turned = dataclasses.replace(other.parts["plain"], cells=other.parts["plain"].cells[:, ::-1])
    assert fingerprints(Structure(other.points, {**other.parts, "plain": turned}, other.supports)) != fingerprints(
        other
    )


def test_pictures(tmp_path, expected):
    pytest.importorskip("pyvista")
    image = pytest.importorskip("matplotlib.image")

    def drawn(result, name):
        fabric = {part: result.membrane(part).principal[:, 0] for part in ("plain", "woven")}
        plot.contours(result, {"stress": fabric}, tmp_path / name)
        return image.imread(tmp_path / name)

    a, b = drawn(solved(1)["snow"], "mixed.png"), drawn(expected["snow"], "ordered.png")
    assert a.shape == b.shape
    assert np.abs(a - b).max() < 0.02  # lighting is rounded


SHEETS = {
    "apart": (3.0, 0, 0),
    "sharing a node": (2.0, 2, 0),
    "one above the other": (0.0, 0, 1),
}


def sheets(offset, seed=None, side=1.0):
    """Two sheets of one membrane, welded where they meet."""
    count = len(FLAT)
    both = np.vstack([FLAT, FLAT + offset])
    points, number = np.unique(both.round(9), axis=0, return_inverse=True)
    cells = number.ravel()[np.vstack([TRIANGLES, TRIANGLES + count])]
    cells = cells if side > 0 else cells[:, ::-1]
    cells = cells if seed is None else shuffled(cells, seed)
    rim = np.unique(boundary_edges(cells))
    part = Membrane(cells, FABRIC, [[900, 200], [200, 700]], warp=(1, 0, 0))
    return Structure(points, {"fabric": part}, [Support(rim)])


@pytest.mark.parametrize("offset", SHEETS.values(), ids=SHEETS)
@pytest.mark.parametrize("seed", SEEDS)
def test_pieces_of_one_membrane(offset, seed):
    air = [Stage("air", [Pressure(300.0, "fabric")])]
    ordered = sheets(offset)
    assert ordered.normals("fabric") == pytest.approx(np.tile([0.0, 0, 1], (len(ordered.parts["fabric"].cells), 1)))
    wanted, found = (Analysis(made).run(air)["air"] for made in (ordered, sheets(offset, seed)))
    assert (wanted.membrane("fabric").cauchy[:, 0, 1] > 0).all()  # one sign in both sheets
    assert_same(found, wanted)
    assert sheets(offset, seed, -1.0).normals("fabric") == pytest.approx(-ordered.normals("fabric"))


def test_closed_and_upright_pieces_keep_the_sense_of_their_first_cell():
    tetrahedron, faces = np.vstack([np.zeros(3), np.eye(3)]), np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    sheet, wall = np.array([[5.0, 0, 0], [6, 0, 0], [5, 1, 0]]), np.array([[5.0, 0, 3], [6, 0, 3], [5, 0, 4]])
    points = np.vstack([tetrahedron, sheet, wall])

    def made(sense):
        closed, upright = (cells if sense > 0 else cells[:, ::-1] for cells in (faces, np.array([[7, 8, 9]])))
        cells = np.vstack([closed, [[4, 5, 6]], upright])
        return Structure(points, {"fabric": Membrane(cells, FABRIC)}).normals("fabric")

    ahead, back = made(1), made(-1)
    assert ahead[4] == pytest.approx(back[4])
    for kept in ([0, 1, 2, 3], [5]):
        assert ahead[kept] == pytest.approx(-back[kept])


def test_gmsh_model():
    gmsh = pytest.importorskip("gmsh")

    def structure(cells):
        gmsh.model.add("sheet")
        gmsh.model.addDiscreteEntity(2, 1)
        gmsh.model.mesh.addNodes(2, 1, np.arange(1, len(POINTS) + 1), POINTS.ravel())
        gmsh.model.mesh.addElementsByType(1, 2, [], cells.ravel() + 1)
        gmsh.model.setPhysicalName(2, gmsh.model.addPhysicalGroup(2, [1]), "fabric")
        parts = {"fabric": lambda cells: Membrane(cells, FABRIC, [[900, 200], [200, 700]], warp=(1, 0, 0))}
        made = structure_from_gmsh(None, parts)
        gmsh.model.remove()
        return dataclasses.replace(made, supports=[Support(np.unique(boundary_edges(TRIANGLES)))])

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        mixed, ordered = structure(shuffled(TRIANGLES, 1)), structure(TRIANGLES)
    finally:
        gmsh.finalize()
    stages = [Stage("air", [Pressure(300.0, "fabric")])]
    assert_same(Analysis(mixed).run(stages)["air"], Analysis(ordered).run(stages)["air"])
