"""Results: order, consistency of stresses and forces, balance, names."""

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
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.geometry.sizes import normals

FABRIC = Fabric(Et=1e5, nu=0.3)
N0, EA = np.linspace(800.0, 1200.0, 8), 2e6  # prestress of each of the edge cables, their axial stiffness
UNUSED = 0


@pytest.fixture(scope="module")
def result():
    """Sheet with cables around it on four corners, a mast under its centre, under all kinds of loads."""
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    points[:, 2] = 0.2 * points[:, 0] * points[:, 1]
    points = np.vstack([[[9.0, 9, 9]], points, [[0.1, 0, -1]]])
    triangles = triangles + 1
    structure = Structure(
        points,
        {
            "fabric": Membrane(triangles, FABRIC, prestress=(900.0, 1100.0), warp=(1, 1, 0)),
            "edge": Cable(boundary_edges(triangles), EA, N0),
            "mast": Mast([[10, 5]], 1e7),
        },
        [Support([1, 3, 7, 9]), Support(10, "x")],
    )
    loads = [
        DistributedLoad((10, 20, -200), "fabric"),
        DistributedLoad((0, 5, 0), "edge", [1, 2]),
        PointLoad([2, 7], (0, 30, 40)),
    ]
    lift = PrescribedDisplacement(10, (0, 0.02, 0.05), "yz")
    return Analysis(structure).run([Stage("all", loads, [lift], increments=2)])["all"]


@pytest.mark.mpi
def test_values_belong_to_the_users_nodes_and_cells():
    count = 12
    rng = np.random.default_rng(5)
    place = rng.permutation(2 * count)
    top, bottom = place[:count], place[count:]
    points = np.zeros((2 * count, 3))
    points[top] = rng.uniform(-3, 3, size=(count, 3))
    points[bottom] = points[top] - [0, 0, 2.0]
    weights = np.linspace(100.0, 1300.0, count)
    structure = Structure(
        points, {"hangers": Cable(np.stack([bottom, top], axis=1), EA)}, [Support(top), Support(bottom, "xy")]
    )
    loads = [PointLoad(node, (0, 0, -weight)) for node, weight in zip(bottom, weights, strict=True)]
    result = Analysis(structure).run([Stage("weights", loads)])["weights"]
    assert result.cable("hangers").force == pytest.approx(weights, rel=1e-9)
    assert result.reactions[top, 2] == pytest.approx(weights, rel=1e-9)
    stretch = 1 - result.displacement[bottom, 2] / 2.0
    assert stretch == pytest.approx(np.sqrt(1 + 2 * result.cable("hangers").strain), rel=1e-12)
    assert not result.displacement[top].any()


def test_axial_force_is_that_of_the_current_length(result):
    for part, prestress, stiffness in [("edge", N0, EA), ("mast", 0.0, 1e7)]:
        cells = result.structure.parts[part].cells
        before, after = (np.linalg.norm(np.diff(x[cells], axis=1)[:, 0], axis=1) for x in points_of(result))
        stretch = after / before
        E = (stretch**2 - 1) / 2
        values = result.parts[part]
        assert values.strain == pytest.approx(E, abs=1e-14)
        assert values.force == pytest.approx((prestress + stiffness * E) * stretch, rel=1e-9)
        assert np.abs(E).min() > 1e-6


def points_of(result):
    return result.structure.points, result.position


def test_membrane_stress_follows_from_its_strain(result):
    fabric, eta = result.membrane("fabric"), result.structure.parts["fabric"].compression_stiffness
    Et, nu, sigma0 = FABRIC.Et, FABRIC.nu, np.diag([900.0, 1100.0])
    e = fabric.strain + ((1 + nu) * sigma0 - nu * np.trace(sigma0) * np.eye(2)) / Et
    full = Et / (1 - nu**2) * ((1 - nu) * e + nu * np.trace(e, axis1=1, axis2=2)[:, None, None] * np.eye(2))
    values, vectors = np.linalg.eigh(e)
    tension = Et * values[:, 1, None, None] * np.einsum("ci,cj->cij", vectors[:, :, 1], vectors[:, :, 1])
    taut = values[:, 0] + nu * values[:, 1] >= 0
    assert 0 < np.count_nonzero(taut) < len(taut)
    assert values[:, 1].min() > 0
    assert fabric.state.tolist() == np.where(taut, "taut", "wrinkled").tolist()
    expected = np.where(taut[:, None, None], full, (1 - eta) * tension + eta * full)
    assert fabric.second_piola_kirchhoff == pytest.approx(expected, rel=1e-12, abs=1e-9)


def test_membrane_strain_is_that_of_the_edges(result):
    """Change of the squared length of an edge d: |F d|^2 - |d|^2 = 2 d . E d, in the warp/weft frame."""
    fabric, structure = result.membrane("fabric"), result.structure
    cells = structure.parts["fabric"].cells
    warp, normal = structure.warp("fabric"), normals(structure.points, cells)
    frame = np.stack([warp, np.cross(normal, warp)], axis=2)
    for i, j in [(0, 1), (1, 2), (2, 0)]:
        before, after = (x[cells[:, j]] - x[cells[:, i]] for x in points_of(result))
        d = np.einsum("ck,ckd->cd", before, frame)
        change = np.sum(after**2, axis=1) - np.sum(before**2, axis=1)
        assert change == pytest.approx(2 * np.einsum("ci,cij,cj->c", d, fabric.strain, d), rel=1e-9, abs=1e-14)


def test_cauchy_stress_lies_in_the_current_plane_and_has_the_principal_values(result):
    fabric = result.membrane("fabric")
    cells, largest = result.structure.parts["fabric"].cells, np.abs(fabric.cauchy).max()
    normal = normals(result.position, cells)
    assert np.abs(np.einsum("cij,cj->ci", fabric.cauchy, normal)).max() <= 1e-12 * largest
    side = np.diff(result.position[cells], axis=1)[:, 0]
    first = side / np.linalg.norm(side, axis=1, keepdims=True)
    frame = np.stack([first, np.cross(normal, first)], axis=1)
    values = np.linalg.eigvalsh(np.einsum("cik,ckl,cjl->cij", frame, fabric.cauchy, frame))
    assert fabric.principal == pytest.approx(values[:, ::-1], abs=1e-12 * largest)
    assert (fabric.principal[:, 0] > fabric.principal[:, 1]).all()


def test_projected_cauchy_stress_differs_by_the_turn_of_the_cells(result):
    fabric, cells = result.membrane("fabric"), result.structure.parts["fabric"].cells
    cosine = np.sum(normals(result.structure.points, cells) * normals(result.position, cells), axis=1)
    assert cosine.min() < 0.999
    assert fabric.cauchy_projected * cosine[:, None, None] == pytest.approx(fabric.cauchy, rel=1e-9, abs=1e-7)


def test_prestress_acts_along_warp_and_weft():
    points, triangles = rectangle(1.0, 1.0, 1, 1)
    woven = OrthotropicFabric(Et_warp=2e5, Et_weft=1e5, nu=0.2, Gt=1e4)
    fabric = Membrane(triangles, woven, prestress=[[30.0, 5.0], [5.0, 10.0]], warp=(0.6, 0.8, 0))
    structure = Structure(points, {"fabric": fabric}, [Support(range(4))])
    warp, weft = np.array([0.6, 0.8, 0]), np.array([-0.8, 0.6, 0])
    shear = np.outer(warp, weft) + np.outer(weft, warp)
    expected = 30 * np.outer(warp, warp) + 10 * np.outer(weft, weft) + 5 * shear
    (result,) = Analysis(structure).run([Stage("rest")]).values()
    assert result.membrane("fabric").cauchy == pytest.approx(np.array([expected] * 2), abs=1e-12)


@pytest.mark.mpi
def test_loads_and_reactions_balance(result):
    balance = result.equilibrium
    size = np.abs(result.reactions).sum()
    assert np.abs(balance.loads).min() > 1
    assert balance.loads + balance.reactions == pytest.approx(np.zeros(3), abs=1e-10 * size)
    assert np.abs(balance.load_moment).max() > 1
    assert balance.load_moment + balance.reaction_moment == pytest.approx(np.zeros(3), abs=1e-10 * size)
    assert 0 <= balance.residual <= 1e-9 * np.abs(result.reactions).max()


def test_balance_is_that_of_the_arrays(result):
    balance, x = result.equilibrium, result.position
    assert balance.loads == pytest.approx(result.loads.sum(axis=0))
    assert balance.reactions == pytest.approx(result.reactions.sum(axis=0))
    assert balance.load_moment == pytest.approx(np.cross(x, result.loads).sum(axis=0))
    assert balance.reaction_moment == pytest.approx(np.cross(x, result.reactions).sum(axis=0))


@pytest.mark.mpi
def test_reactions_are_zero_where_free(result):
    held = np.zeros(result.structure.points.shape, dtype=bool)
    held[[1, 3, 7, 9, 10]] = True
    assert not result.reactions[~held].any()
    assert (np.abs(result.reactions[held]) > 1e-3).all()


@pytest.mark.mpi
def test_nodes_that_no_part_uses_stay_put(result):
    for values in (result.displacement, result.loads, result.reactions):
        assert values.shape == result.structure.points.shape
        assert values[UNUSED].tolist() == [0, 0, 0]
    assert result.position[UNUSED].tolist() == [9, 9, 9]


def test_shapes(result):
    fabric = result.membrane("fabric")
    assert fabric.strain.shape == fabric.second_piola_kirchhoff.shape == (8, 2, 2)
    assert fabric.cauchy.shape == fabric.cauchy_projected.shape == (8, 3, 3)
    assert fabric.principal.shape == (8, 2)
    assert result.cable("edge").force.shape == result.cable("edge").strain.shape == (8,)
    assert result.mast("mast").force.shape == (1,)


def test_history_runs_through_all_increments(result):
    assert [increment.load_factor for increment in result.increments] == [0.5, 1.0]
    assert [factor for factor, _ in result.history] == [
        increment.load_factor for increment in result.increments for _ in increment.iterations
    ]
    assert result.history[-1][1].energy == pytest.approx(result.energy, rel=1e-13)


@pytest.mark.parametrize(
    ("kind", "name", "message"),
    [
        (
            "membrane",
            "edge",
            r"^No Membrane.*'edge'.*Cable.*structure.*\['fabric'\]",
        ),
        ("membrane", "fabrik", r"^No Membrane.*'fabrik'.*structure.*\['fabric'\]"),
        ("cable", "mast", r"^No Cable.*'mast'.*Mast.*structure.*\['edge'\]"),
        ("mast", "edge", r"^No Mast.*'edge'.*Cable.*structure.*\['mast'\]"),
    ],
)
def test_wrong_name_is_refused_with_the_names_there_are(result, kind, name, message):
    with pytest.raises(ValueError, match=message):
        getattr(result, kind)(name)


def test_warp_weft_stress_is_that_along_warp_and_weft(result):
    fabric, structure = result.membrane("fabric"), result.structure
    cells = structure.parts["fabric"].cells
    warp, normal = structure.warp("fabric"), normals(structure.points, cells)
    for number, direction in enumerate([warp, np.cross(normal, warp)]):
        # A vector in the cell as a combination of two of its sides moves with them.
        sides, moved = (np.diff(x[cells], axis=1) for x in points_of(result))
        weights = [np.linalg.lstsq(side.T, along, rcond=None)[0] for side, along in zip(sides, direction, strict=True)]
        current = np.einsum("cs,csk->ck", weights, moved)
        current /= np.linalg.norm(current, axis=1, keepdims=True)
        force = np.einsum("ci,cij,cj->c", current, fabric.cauchy, current)
        assert fabric.warp_weft_stress[:, number] == pytest.approx(force, rel=1e-9, abs=1e-9)
