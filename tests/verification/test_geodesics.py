"""Geodesics with known lengths and ends: exact on polyhedra, of second order on meshes of curved surfaces.

A developable polyhedron unrolls: distances are those in the plane. On a cone two points at r and s, apart by the angle
phi on the unrolled cone, have the distance sqrt(r^2 + s^2 - 2 r s cos phi) for phi below pi. On a sphere geodesics are
great circles; lengths are of second order, places of straightest lines of first, as the curvature is at the nodes
beside which they pass. A line along a warp at the angle a to the radius is a logarithmic spiral: it turns by tan(a)
log(r2 / r1).
"""

from itertools import pairwise

import numpy as np
import pytest

from fx_membrane import Fabric, Membrane, Structure, geodesic, rectangle, warp_lines
from surfaces import octant

SOURCE = "unrolled polyhedra, great circles, logarithmic spiral"

pytest.importorskip("potpourri3d")


def test_prism_unrolls(verified):
    """A polygonal cylinder: bent along the lines of nodes of a plane mesh."""
    flat, triangles = rectangle(4.0, 3.0, 8, 6)
    bend = 0.4
    angle = bend * np.arange(8)
    x = np.append(0.0, np.cumsum(0.5 * np.cos(angle)))
    z = np.append(0.0, np.cumsum(0.5 * np.sin(angle)))
    column = np.round((flat[:, 0] + 2) / 0.5).astype(int)
    prism = np.stack([x[column], flat[:, 1], z[column]], axis=1)
    for a, b in [(0, 62), (3, 55), (9, 44), (7, 58)]:
        distance = np.linalg.norm(flat[a] - flat[b])
        assert geodesic((prism, triangles), a, b).length == pytest.approx(distance, rel=1e-12)
        way = (flat[b] - flat[a]) / distance
        face = angle[column[a] - (way[0] < 0)]
        start = np.array([np.cos(face), 0, np.sin(face)])
        verified("distance on a prism [m]", distance, geodesic((prism, triangles), a, b).length)
        line = geodesic((prism, triangles), a, direction=way[0] * start + way[1] * np.array([0, 1, 0]), length=distance)
        np.testing.assert_allclose(line.points[-1], prism[b], rtol=0, atol=1e-12)


def cone(corners, slope, rings=4):
    """Pyramid of equal faces, with the apex as its first node."""
    angle = 2 * np.pi * np.arange(corners) / corners
    radius = np.arange(1, rings + 1)
    points = [[0.0, 0.0, 0.0]]
    points += [[r * np.cos(a), r * np.sin(a), -slope * r] for r in radius for a in angle]
    node = 1 + np.arange(rings * corners).reshape(rings, corners)
    cells = [[0, node[0, k], node[0, (k + 1) % corners]] for k in range(corners)]
    for inner, outer in pairwise(node):
        for k in range(corners):
            following = (k + 1) % corners
            cells += [[inner[k], outer[k], outer[following]], [inner[k], outer[following], inner[following]]]
    return np.array(points), np.array(cells), node


@pytest.mark.parametrize("slope", [0.3, 1.0])
def test_cone(slope):
    """Distances around the apex of a pyramid; a straightest line through it has equal angles on both sides."""
    corners = 6
    points, triangles, node = cone(corners, slope)
    edge = np.linalg.norm(points[node[0, 0]])
    face = 2 * np.arcsin(np.linalg.norm(points[node[0, 1]] - points[node[0, 0]]) / (2 * edge))
    for (i, k), (j, m) in [((3, 0), (3, 1)), ((3, 0), (2, 2)), ((1, 1), (3, 3))]:
        r, s, phi = edge * (i + 1), edge * (j + 1), face * (m - k)
        expected = np.sqrt(r**2 + s**2 - 2 * r * s * np.cos(phi)) if phi < np.pi else r + s
        assert geodesic((points, triangles), int(node[i, k]), int(node[j, m])).length == pytest.approx(
            expected, rel=1e-12
        )
    line = geodesic((points, triangles), int(node[2, 0]), direction=-points[node[2, 0]])
    np.testing.assert_allclose(line.points[-1], points[node[3, 3]], rtol=0, atol=1e-10)
    share = np.array([0.7, 0.3])
    start = 2 * share @ points[node[0, :2]]
    line = geodesic((points, triangles), start, direction=-start)
    end = 4 * share @ points[node[0, 3:5]]
    np.testing.assert_allclose(line.points[-1], end, rtol=0, atol=1e-10)


def test_great_circle():
    """Between nodes of an octant of a sphere that all meshes have, and along a meridian for a given length."""
    errors, aside = [], []
    for n in (8, 16, 32):
        points, triangles = octant(n, 2.0)
        shares = np.array([[1, 2, 1], [2, 1, 1], [1, 1, 2], [3, 0, 1]]) / 4
        places = np.sin(np.pi / 2 * shares)
        places *= 2.0 / np.linalg.norm(places, axis=1, keepdims=True)
        found = []
        for a, b in [(0, 1), (0, 2), (2, 3)]:
            apart = 2.0 * np.arccos(places[a] @ places[b] / 4)
            found.append(abs(geodesic((points, triangles), places[a], places[b]).length / apart - 1))
        side = np.cross(places[0], places[1])
        line = geodesic((points, triangles), places[0], direction=np.cross(side, places[0]), length=apart)
        assert line.length == pytest.approx(apart, rel=1e-12)
        aside.append(np.abs(line.points @ side).max() / np.linalg.norm(side))
        errors.append(found)
    assert (np.log2(np.array(errors[0]) / errors[-1]) / 2 > 1.6).all(), errors
    assert np.max(errors[-1]) < 1e-3, errors
    assert aside[-1] < aside[-2] / 1.4 < aside[-3] / 1.8, aside
    assert aside[-1] < 2e-2, aside


def test_spiral_along_the_warp(verified):
    """Warp at 40 degrees to the radius of an annulus, on a mesh without symmetry in its diagonals."""
    turn, errors = np.radians(40), []
    for n in (8, 16, 32):
        grid, triangles = rectangle(2.0, 1.0, 4 * n, n, diagonals="right")
        r, angle = 1.5 + grid[:, 1], 0.8 * grid[:, 0]
        points = np.stack([r * np.cos(angle), r * np.sin(angle), 0 * r], axis=1)
        centre = points[triangles].mean(axis=1)
        warp = np.cos(turn) * centre + np.sin(turn) * np.cross([0, 0, 1.0], centre)
        part = Membrane(triangles, Fabric(4e5, 0.3), prestress=(2e3, 1e3), warp=warp)
        start = points[np.argmin(np.linalg.norm(points - [1.5 * np.cos(0.0), 0, 0], axis=1))]
        (line,) = warp_lines(Structure(points, {"sheet": part}), [start])
        ends = np.arctan2(line.points[[0, -1], 1], line.points[[0, -1], 0])
        errors.append(abs(np.diff(ends)[0] - np.tan(turn) * np.log(2)))
    order = np.log2(np.array(errors)[:-1] / np.array(errors)[1:])
    assert order.mean() > 1.8, errors
    turned = np.tan(turn) * np.log(2)
    verified("angle of a spiral along the warp", turned, turned + errors[-1], order.mean())
    assert errors[-1] < 1e-3, errors
