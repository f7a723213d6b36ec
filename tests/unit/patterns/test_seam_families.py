"""Families of seams by number and by roll width, strips of one shape, and strips meshed anew."""

from itertools import pairwise

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    Structure,
    Support,
    boundary_edges,
    cut_strips,
    geodesic,
    planar_cut,
    rectangle,
    seams_between,
    with_copies,
)
from fx_membrane.geometry.sizes import aspects, measures
from fx_membrane.patterns.roll_widths import strip_widths

pytest.importorskip("potpourri3d")


def catenoid(around=24, along=8):
    """Catenoid between rings of the radius 10 and 10, with the nodes of each height."""
    flat, cells = rectangle(1.0, 1.0, around, along, diagonals="to centre")
    u, v = flat[:, 0] + 0.5, flat[:, 1] - 0.0
    waist = 8.4815  # of cosh for the height 10
    r = waist * np.cosh(10 * v / waist)
    points = np.stack([r * np.cos(2 * np.pi * u), r * np.sin(2 * np.pi * u), 10 * v], axis=1)
    keys = np.round(points, 6) + 0.0
    _, first, same = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    points, cells = points[first], same.ravel()[cells]
    bottom, top = (np.flatnonzero(np.isclose(points[:, 2], z)) for z in (-5, 5))
    ring = boundary_edges(cells)
    upper = ring[np.isin(ring, top).all(axis=1)]
    parts = {"roof": Membrane(cells, Fabric(5e5, 0.3), 4e3), "ring": Cable(upper, 1e8, 1e4)}
    return Structure(points, parts, [Support(bottom)]), bottom, top


def test_gores_are_copies():
    roof, bottom, _ = catenoid()
    strips = with_copies(cut_strips(roof, seams_between(roof, bottom, "ring", 12)))
    assert len(strips.names) == 12
    assert strips.copies == dict.fromkeys(strips.names[1:], "strip 1")
    assert not strips.mirrored  # gores are symmetric themselves
    neighbours = [edge.strips for edge in strips.edges if edge.is_seam]
    assert set(pairwise(strips.names)) | {(strips.names[0], strips.names[-1])} == set(neighbours)
    assert {edge.line for edge in strips.edges if not edge.is_seam} == {None, "ring"}


def test_mirrored_halves():
    points, triangles = rectangle(4.0, 4.0, 8, 8, diagonals="to centre")
    points[:, 2] = 0.2 * points[:, 0] ** 2 + 0.3 * points[:, 0] * points[:, 1] ** 2 * 0 + 0.1 * points[:, 1]
    roof = Structure(points, {"roof": Membrane(triangles, Fabric(5e5, 0.3), 4e3)})
    left = geodesic(roof, (-2, -2, 0.6), (-0.5, 2, 0.25))
    right = geodesic(roof, (2, -2, 0.6), (0.5, 2, 0.25))
    strips = with_copies(cut_strips(roof, [left, right]))
    assert strips.copies == {"strip 3": "strip 1"}
    assert strips.mirrored == {"strip 3"}


def test_seams_along_a_cable_and_across():
    points, triangles = rectangle(6.0, 4.0, 12, 8)
    middle = np.flatnonzero(points[:, 1] == 0)
    valley = Cable(list(pairwise(middle.tolist())), 1e6, 1e4)
    roof = Structure(points, {"roof": Membrane(triangles, Fabric(5e5, 0.3), 4e3), "valley": valley})
    strips = cut_strips(roof, ["valley", *planar_cut(roof, (0.3, 0, 0), (1, 0.2, 0))])
    assert len(strips.names) == 4
    assert sorted(edge.line or "" for edge in strips.edges if edge.is_seam) == ["", "", "valley", "valley"]
    area = [measures(strips.structure.points, strips.membrane(name).cells).sum() for name in strips.names]
    assert sum(area) == pytest.approx(24, rel=1e-12)


def test_least_number_for_a_roll():
    roof, bottom, top = catenoid()
    seams = seams_between(roof, bottom, top, roll_width=3.0)
    widest = max(strip_widths(cut_strips(roof, seams)).values())
    fewer = max(strip_widths(cut_strips(roof, seams_between(roof, bottom, top, len(seams) - 1))).values())
    assert widest <= 3.0 < fewer


@pytest.mark.mpi
def test_strips_of_a_size():
    pytest.importorskip("gmsh")
    roof, bottom, top = catenoid(48, 16)
    strips = cut_strips(roof, seams_between(roof, bottom, top, 3), size=1.2)
    cut = strips.structure
    waist = 8.4815
    off = np.hypot(cut.points[:, 0], cut.points[:, 1]) - waist * np.cosh(cut.points[:, 2] / waist)
    assert np.abs(off[np.unique(np.concatenate([strips.membrane(name).cells for name in strips.names]))]).max() < 5e-3
    assert max(aspects(cut.points, strips.membrane(name).cells).max() for name in strips.names) < 4
    for edge in strips.edges:
        long = np.linalg.norm(np.diff(cut.points[edge.nodes], axis=0), axis=1)
        assert 0.4 < long.min() < long.max() < 1.6
    held = np.unique(np.concatenate([edge.nodes for edge in strips.edges if edge.held]))
    assert held.tolist() == np.sort(cut.supports[0].nodes).tolist()
    tensors = np.concatenate([strips.membrane(name).prestress_tensors() for name in strips.names])
    np.testing.assert_allclose(tensors, np.broadcast_to(4e3 * np.eye(2), tensors.shape), rtol=1e-12)


@pytest.mark.mpi
def test_opened_tube_of_a_size():
    pytest.importorskip("gmsh")
    roof, bottom, top = catenoid()
    strips = cut_strips(roof, seams_between(roof, bottom, top, 1), size=2.0)
    (seam,) = (edge for edge in strips.edges if edge.is_seam)
    assert seam.strips == ("roof", "roof")
    assert set(strips.structure.parts) == {"roof", "ring"}
    sides = np.sort(strips.membrane("roof").cells[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1).tolist()
    assert all(sorted(pair) in sides for pair in pairwise(seam.nodes.tolist()))
