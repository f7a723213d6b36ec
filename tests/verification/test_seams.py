"""Seams along geodesics of known length, and strips between them, on a cone and on a sphere.

A cone frustum of the radii 7 and 2 and the height 5 unrolls to a sector of the radii 7 sqrt 2 and 2 sqrt 2. A seam from
base to base, 60 degrees apart, is the chord there; it comes to the radius that the chord comes to. A cone of plane
faces unrolls likewise, and its seams are exact. On a sphere seams are great circles. Lengths of seams between nodes of
a mesh of a curved surface are of second order, and so are those after the cut, which leads seams through nodes that
are near.
"""

import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, Structure, cut_strips, geodesic, rectangle, seams_between
from fx_membrane.geometry.sizes import measures

SOURCE = "unrolled cones, great circles"

pytest.importorskip("potpourri3d")


def cone(around, along):
    """Nodes of a frustum, from the base up, and its cells, closed around."""
    flat, cells = rectangle(1.0, 1.0, around, along, diagonals="right")
    number = np.arange((around + 1) * (along + 1)).reshape(along + 1, around + 1)
    same = number.copy()
    same[:, -1] = number[:, 0]
    used, cells = np.unique(same.ravel()[cells], return_inverse=True)
    u, v = flat[used, 0] + 0.5, flat[used, 1] + 0.5
    r = 7 - 5 * v
    points = np.stack([r * np.cos(2 * np.pi * u), r * np.sin(2 * np.pi * u), 5 * v], axis=1)
    return points, cells.reshape(-1, 3), np.searchsorted(used, number[:, :-1])


def sphere(count):
    """Patch of a sphere of the radius 10, from -10 to 50 degrees of latitude and -10 to 70 of longitude."""
    flat, cells = rectangle(80.0, 60.0, 8 * count, 6 * count, diagonals="right")
    lon, lat = np.radians(flat[:, 0] + 30), np.radians(flat[:, 1] + 20)
    points = 10 * np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=1)
    return points, cells


def on_sphere(lat, lon):
    lat, lon = np.radians([lat, lon])
    return 10 * np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])


def length(points, nodes):
    return np.linalg.norm(np.diff(points[nodes], axis=0), axis=1).sum()


def cut_length(points, cells, seam):
    """Length of a seam after the cut."""
    strips = cut_strips(Structure(points, {"roof": Membrane(cells, Fabric(5e5, 0.3), 1e3)}), [seam])
    return sum(length(strips.structure.points, edge.nodes) for edge in strips.edges if edge.is_seam)


def orders(errors):
    return np.log2(np.abs(errors)[:-1] / np.abs(errors)[1:])


def smallest_radius(line):
    """Radius of the place of a line on a cone that is nearest to the apex, by its distance from there.

    Faces of a cone of plane faces go through the apex, so that distances from there are those of the unrolled faces.
    Distances from the axis are not: those of edges and middles of faces differ by the square of the mesh size.
    """
    start, side = line[:-1] - [0, 0, 7], np.diff(line, axis=0)
    share = np.clip(-np.sum(start * side, axis=1) / np.sum(side**2, axis=1), 0, 1)
    return np.linalg.norm(start + share[:, None] * side, axis=1).min() / np.sqrt(2)


def test_cone(verified):
    """From base to base over 60 degrees, and from base to top over 90."""
    exact = np.array([7.1640547820, 6.5256830972, 9.0075031469])
    found = []
    for n in (1, 2, 4, 8):
        points, cells, node = cone(24 * n, 6 * n)
        side = geodesic((points, cells), int(node[0, 0]), int(node[0, 4 * n]))
        up = geodesic((points, cells), int(node[0, 0]), int(node[-1, 6 * n]))
        found.append([side.length, smallest_radius(side.points), up.length])
    errors = np.array(found) / exact - 1
    rates = np.log2(np.abs(errors[:-1]) / np.abs(errors[1:]))
    assert rates.min() > 1.9, errors
    assert np.abs(errors[-1]).max() < 2e-4, errors
    names = ("seam on a cone, base to base [m]", "smallest radius of that seam [m]", "seam on a cone, base to top [m]")
    for name, *numbers in zip(names, exact, found[-1], rates[-1], strict=True):
        verified(name, *numbers)


def test_sphere(verified):
    """The seam from (0, 0) to (40, 60) degrees, as a line and after the cut."""
    expected, found = 11.7773051445, []
    for count in (1, 2, 4, 8):
        points, cells = sphere(count)
        found.append(geodesic((points, cells), on_sphere(0, 0), on_sphere(40, 60)).length)
    rates = orders(np.array(found) / expected - 1)
    assert rates.mean() > 1.8, found
    assert found[-1] == pytest.approx(expected, rel=1e-3)
    verified("seam on a sphere [m]", expected, found[-1], rates.mean())


def test_great_circle_through_the_rim(verified):
    """From rim to rim across the patch, so that the seam parts it; by its chord of longitude on one latitude."""
    expected, found = 10 * np.arccos(on_sphere(20, -10) @ on_sphere(40, 70) / 100), []
    for count in (1, 2, 4):
        points, cells = sphere(count)
        found.append(cut_length(points, cells, geodesic((points, cells), on_sphere(20, -10), on_sphere(40, 70))))
    rates = orders(np.array(found) / expected - 1)
    assert rates.mean() > 1.7, found
    verified("seam on a sphere after the cut [m]", expected, found[-1], rates.mean())


def test_plane_faces_are_exact(verified):
    """Twelve plane faces: a seam crosses them as in the plane; gores along their middles have equal areas."""
    points, cells, node = cone(12, 5)
    slant = np.linalg.norm(points[node[0, 0]] - points[node[-1, 0]])
    radii = slant * np.array([7, 2]) / 5
    face = 2 * np.arcsin(7 * np.sin(np.pi / 12) / radii[0])
    for ring, turn in ((0, 3), (-1, 2), (-1, 3)):
        r, s = radii[0], radii[ring]
        expected = np.sqrt(r**2 + s**2 - 2 * r * s * np.cos(turn * face))
        seam = geodesic((points, cells), int(node[0, 0]), int(node[ring, turn]))
        assert seam.length == pytest.approx(expected, rel=1e-12)
    verified("seam over plane faces [m]", expected, seam.length)
    roof = Structure(points, {"roof": Membrane(cells, Fabric(5e5, 0.3), 1e3)})
    base = [(points[node[0, k]] + points[node[0, (k + 1) % 12]]) / 2 for k in range(12)]
    top = [(points[node[-1, k]] + points[node[-1, (k + 1) % 12]]) / 2 for k in range(12)]
    strips = cut_strips(roof, [geodesic(roof, a, b) for a, b in zip(base, top, strict=True)])
    areas = [measures(strips.structure.points, strips.membrane(name).cells).sum() for name in strips.names]
    np.testing.assert_allclose(areas, measures(points, cells).sum() / 12, rtol=1e-12)
    lengths = [length(strips.structure.points, edge.nodes) for edge in strips.edges if edge.is_seam]
    np.testing.assert_allclose(lengths, np.hypot(5 * np.cos(np.pi / 12), 5), rtol=1e-12)  # height of a face


def test_family_of_gores_follows_meridians():
    """Between base and ring with a number of gores that divides the mesh, seams are its lines of nodes."""
    points, cells, node = cone(24, 6)
    roof = Structure(points, {"roof": Membrane(cells, Fabric(5e5, 0.3), 1e3)})
    strips = cut_strips(roof, seams_between(roof, node[0], node[-1], strips=12))
    assert len(strips.structure.points) == len(points)
    assert len(strips.names) == 12
