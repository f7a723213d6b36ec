"""Flattening: equal seams, straight threads, laws of all kinds, strips that cannot be laid flat."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, NeoHooke, OrthotropicFabric, Structure, rectangle
from fx_membrane.patterns.flat_shapes import flatten, flattened_strips, largest_difference, thread_angles
from fx_membrane.patterns.strips import Edge, Strips
from gores import catenoid, cone, gores
from own_laws import Foil

LAWS = [Fabric(5e5, 0.3), OrthotropicFabric(6e5, 4e5, 0.3, 2e4), NeoHooke(1e5), Foil(4e5)]


def unequal(strips):
    """Take softer cloth for one strip: its seams are as long on both sides only by constraint."""
    parts = dict(strips.structure.parts)
    first = strips.names[0]
    parts[first] = replace(parts[first], material=Fabric(1e5, 0.0))
    return replace(strips, structure=replace(strips.structure, parts=parts))


@pytest.mark.parametrize("law", LAWS, ids=lambda law: type(law).__name__)
def test_seams_are_as_long_on_both_sides(law):
    strips = catenoid(8, 4, 12, law=law, alternating=False)
    flat = flattened_strips(strips)
    assert largest_difference(flat.places, flat.pieces) < 1e-12
    assert flat.energy > 0
    assert all((one.areas > 0).all() for one in flat.pieces.flat_strips(strips, flat.places).values())


def test_seams_of_different_laws_are_equal_by_constraint():
    strips = unequal(catenoid(8, 4, 12, alternating=False))
    free, bound = flattened_strips(strips, seam_difference=0.5), flattened_strips(strips)
    assert largest_difference(free.places, free.pieces) > 1e-4
    assert largest_difference(bound.places, bound.pieces) < 1e-12
    assert bound.energy > free.energy
    assert flattened_strips(strips, seam_difference=1e-6).energy == pytest.approx(bound.energy, rel=1e-9)


def test_threads_of_woven_strips_are_straight_in_the_plane():
    flat = flattened_strips(catenoid(8, 4, 12, law=LAWS[1], quarter=True))
    assert np.abs(thread_angles(flat.places, flat.shapes, flat.pieces)).max() < 1e-9


def test_energy_is_stationary_and_least():
    flat = flattened_strips(catenoid(8, 4, 8, quarter=True, law=LAWS[2]), seam_difference=1.0)
    cloth = flat.cloth.with_shapes(flat.shapes)
    assert np.abs(cloth.forces(flat.places)).max() < 1e-9 * 1e5
    away = np.random.default_rng(1).normal(size=flat.places.shape)
    assert all(cloth.energy(flat.places + step * away) > flat.energy for step in (1e-3, -1e-3))


def test_sides_run_around_the_strip():
    strips = cone(6, 3, 5)
    for flat in flatten(strips).values():
        assert [side.edge.split()[0] for side in flat.sides] in (["bottom", "seam", "top", "seam"],) or {
            side.edge.split()[0] for side in flat.sides
        } == {"bottom", "seam", "top"}
        assert all(a.rows[-1] == b.rows[0] for a, b in zip(flat.sides, (*flat.sides[1:], flat.sides[0]), strict=True))
        x, y = flat.points[flat.outline].T
        assert (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2 == pytest.approx(flat.area)
        for side in flat.sides:
            (nodes,) = [edge.nodes for edge in strips.edges if edge.name == side.edge]
            found = flat.nodes[side.rows].tolist()
            assert found in (nodes.tolist(), nodes.tolist()[::-1])


def cut_tube():
    """Tube cut open along one line: its seam is on two sides of its one strip."""
    strips = gores(lambda t: 3 + 0 * t, lambda t: 8 * t, 1, 24, 6)
    edges = [replace(edge, strips=("gore 1", "gore 1")) if "seam" in edge.name else edge for edge in strips.edges]
    return replace(strips, edges=tuple(edges))


def test_tube_that_is_cut_once_unrolls():
    (flat,) = flatten(cut_tube()).values()
    around = 24 * 6 * np.sin(np.pi / 24)
    assert flat.width == pytest.approx(around, abs=1e-10)
    assert flat.length == pytest.approx(8, abs=1e-10)
    assert sorted(side.edge for side in flat.sides) == ["bottom 1", "seam 0", "seam 0", "top 1"]


def one_strip(points, triangles, loops):
    part = Membrane(triangles, Fabric(5e5, 0.3), 1e3, warp=(1, 0, 0))
    edges = tuple(Edge(f"border {number}", np.array(nodes), ("a",)) for number, nodes in enumerate(loops))
    return Strips(Structure(points, {"a": part}), edges)


def test_closed_border_is_one_side():
    points, triangles = rectangle(2.0, 1.0, 2, 1)
    (flat,) = flatten(one_strip(points, triangles, [[0, 1, 2, 5, 4, 3, 0]])).values()
    (side,) = flat.sides
    assert flat.nodes[side.rows].tolist() == [0, 1, 2, 5, 4, 3, 0]


def test_strip_with_a_hole_is_refused():
    strips = cut_tube()
    uncut = replace(strips, edges=tuple(edge for edge in strips.edges if "seam" not in edge.name))
    with pytest.raises(ValueError, match=r"Strip 'gore 1' is no disc: it has 2 borders .* cut it open by a seam"):
        flatten(uncut)


def test_strip_in_pieces_is_refused():
    points, triangles = rectangle(3.0, 1.0, 3, 1)
    apart = triangles[np.abs(points[triangles][:, :, 0].mean(axis=1)) > 0.5]
    with pytest.raises(ValueError, match=r"Strip 'a' is no disc: it is in 2 pieces"):
        flatten(one_strip(points, apart, [[0, 1, 5, 4, 0], [2, 3, 7, 6, 2]]))


def test_border_without_an_edge_is_refused():
    points, triangles = rectangle(2.0, 1.0, 2, 1)
    with pytest.raises(ValueError, match=r"Strip 'a' has a border that is on no edge, at .* add an Edge"):
        flatten(one_strip(points, triangles, [[0, 1, 2, 5]]))


def test_strip_that_is_too_curved_is_refused():
    radius, height = (lambda t: 5 * np.cos(2.8 * t - 1.4)), (lambda t: 5 * np.sin(2.8 * t - 1.4))
    with pytest.raises(ValueError, match=r"Strip 'gore .' is too curved .* take narrower strips"):
        flatten(gores(radius, height, 2, 16, 12))


@pytest.mark.mpi
def test_processes_find_the_same_shape():
    from mpi4py import MPI  # noqa: PLC0415

    flat = flattened_strips(catenoid(8, 3, 6, quarter=True))
    shapes = MPI.COMM_WORLD.allgather(flat.places)
    assert all(np.array_equal(shapes[0], other) for other in shapes)
