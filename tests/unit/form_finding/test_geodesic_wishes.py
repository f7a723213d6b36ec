"""Warp of a wish along geodesics, traced anew on each shape: exact cases, settling, seams, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    GeodesicDirection,
    RadialDirection,
    Stage,
    Structure,
    geodesic,
    prescribed_stress,
    rectangle,
    warp_along,
)
from fx_membrane.geometry.sizes import normals
from unit.form_finding.test_seams import halves
from wished_films import canopy, cone

pytest.importorskip("potpourri3d")

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


def meridians(n, every=2):
    """Pairs of nodes of the inner and the outer ring of `cone`."""
    inner = np.arange(0, 4 * n, every)
    return GeodesicDirection(np.stack([inner, 4 * n * n + inner], axis=1))


def across(n, every=2):
    """Pairs of nodes of two opposite edges of `canopy`."""
    node = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    return GeodesicDirection(np.stack([node[0, ::every], node[-1, ::every]], axis=1))


def test_meridians_of_a_surface_of_revolution_are_radial_at_second_order():
    gaps = []
    for n in (6, 12):
        structure = cone(n, prestress=(3e3, 2e3))
        one = prescribed_stress(structure, warp={"film": RadialDirection()})
        other = prescribed_stress(structure, warp={"film": meridians(n)})
        assert other.converged
        assert len(other.steps) <= len(one.steps) + 2
        gaps.append([np.abs(other.points - one.points).max(), abs(other.steps[-1].area - one.steps[-1].area)])
    orders = np.log2(np.array(gaps[0]) / gaps[1])
    assert (orders > 1.8).all()
    assert max(gaps[1]) < 1e-2


def test_direction_is_that_along_the_lines_of_the_form():
    turns = []
    for n in (6, 12):
        direction = across(n)
        form = prescribed_stress(canopy(n), warp={"film": direction})
        shape = (form.points, form.structure.parts["film"].cells)
        lines = [geodesic(shape, int(a), int(b)) for a, b in direction.ends]
        warp = form.structure.warp("film")
        along = [np.abs(np.sum(line.directions * warp[line.cells], axis=1)) for line in lines]
        along.append(np.abs(np.sum(warp_along(shape, lines) * warp, axis=1)))
        turns.append(np.degrees(np.arccos(np.clip(np.concatenate(along), -1, 1))).mean())
    first = direction.vectors("film", canopy(n).points, shape[1])
    assert np.degrees(np.arccos(np.abs(np.sum(first * warp, axis=1)).min())) > 3 * turns[1]
    assert turns[1] < turns[0] / 1.7
    assert turns[1] < 1.0


@pytest.mark.mpi
def test_form_settles_and_is_at_rest_on_all_processes():
    form = prescribed_stress(canopy(n=6), warp={"film": across(6)})
    again = prescribed_stress(replace(canopy(n=6), points=form.points), warp={"film": across(6)})
    assert form.converged
    assert form.steps[-1].change <= 1e-6
    assert np.abs(again.points - form.points).max() < 1e-6 * 8
    for points in MPI.COMM_WORLD.allgather(form.points):
        assert np.array_equal(points, form.points)
    state = Analysis(form.structure).run([Stage("form")])["form"]
    assert np.abs(state.displacement).max() < 1e-12 * 8


def test_first_meshes_give_one_form():
    structure = canopy()
    points, free = structure.points.copy(), ~structure.supported.all(axis=1)
    hump = np.cos(np.pi * points[:, 0] / 8) * np.cos(np.pi * points[:, 1] / 8)
    points[free] += np.outer(hump, [0.4, -0.2, 0.5])[free]
    one = prescribed_stress(structure, warp={"film": across(8)})
    other = prescribed_stress(replace(structure, points=points), warp={"film": across(8)})
    assert other.points == pytest.approx(one.points, abs=1e-6)


def test_parts_have_geodesics_of_their_own():
    structure = halves(canopy(), axis=0)
    cells = {name: structure.parts[name].cells for name in ("one", "two")}
    node = np.arange(81).reshape(9, 9)
    sides = {name: [column for column in range(9) if np.isin(node[:, column], cells[name]).all()] for name in cells}
    warp = {name: GeodesicDirection([node[[0, -1], k] for k in (sides[name][0], sides[name][-1])]) for name in cells}
    form = prescribed_stress(structure, warp=warp)
    assert form.converged
    assert {name: len(value) for name, value in form.wish.items() if name in cells} == {"one": 64, "two": 64}


def test_lines_between_nodes_of_a_flat_mesh_are_straight():
    points, triangles = rectangle(4.0, 4.0, 8, 8)
    skew = points + np.array([0.1, 0.3, 0]) * np.sin(3 * points[:, :1]) * (np.abs(points[:, 1:2]) < 2)
    warp = GeodesicDirection([[0, 80], [2, 62]]).vectors("film", skew, triangles)
    straight = (points[80] - points[0]) / np.linalg.norm(points[80] - points[0])
    centre = skew[triangles].mean(axis=1)
    on_line = np.abs(centre[:, 0] - centre[:, 1]) < 0.2
    assert np.abs(warp[on_line] @ straight).min() > np.cos(np.radians(1.0))
    assert np.abs(np.sum(warp * normals(skew, triangles), axis=1)).max() < 1e-12


def two_pieces():
    structure = canopy(n=2)
    film, count = structure.parts["film"], len(structure.points)
    both = replace(film, cells=np.concatenate([film.cells, film.cells + count]))
    points = np.concatenate([structure.points, structure.points + np.array([0, 0, 5])])
    edge = structure.parts["edge"]
    edges = replace(edge, cells=np.concatenate([edge.cells, edge.cells + count]))
    supports = [replace(one, nodes=[*one.nodes, *(np.asarray(one.nodes) + count)]) for one in structure.supports]
    return Structure(points, {"film": both, "edge": edges}, supports)


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("structure", "ends", "words"),
    [
        (canopy(n=2), [[0, 77]], "geodesic 0, from node 0 to node 77, has its end at node 77, which is none of"),
        (canopy(n=3), [[0, 15], [3, 12]], r"leave cell \d+ at \(.*\) without a direction"),
        (two_pieces(), [[0, 8]], r"the piece of the membrane at \(.*\) has no geodesic; give it one"),
        (
            two_pieces(),
            [[0, 10]],
            r"geodesic 0 has its ends at \(.*\) and \(.*\), on pieces of the membrane that share",
        ),
    ],
)
def test_lines_that_fit_no_membrane_are_refused(structure, ends, words):
    with pytest.raises(ValueError, match=words):
        prescribed_stress(structure, warp={"film": GeodesicDirection(ends)})


@pytest.mark.parametrize("ends", [[], [0, 1], [[3, 3]], [[0, 1], [1, 0]], [[0.5, 1.5]]])
def test_pairs_that_are_no_lines_are_refused(ends):
    with pytest.raises(ValueError, match="GeodesicDirection ends"):
        GeodesicDirection(ends)


def test_geodesics_are_no_stress():
    with pytest.raises(ValueError, match="give a function of place"):
        prescribed_stress(canopy(n=2), stress={"film": across(2)})
