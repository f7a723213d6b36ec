"""Surfaces that several tests use."""

import numpy as np


def half_disc(n):
    """Half of a unit disc, y >= 0: n rings, equilateral triangles in the middle that become circular outwards.

    With circular rings up to the centre there would be a kink: nodes there do not get their share of the load, which
    costs a factor log(1/h).
    """
    corners = np.stack([np.cos(np.pi / 3 * np.arange(4)), np.sin(np.pi / 3 * np.arange(4))], axis=-1)
    rings, points = [np.array([0])], [np.zeros((1, 2))]
    for k in range(1, n + 1):
        share = np.arange(3 * k + 1) / k
        hexagon = np.stack([np.interp(share, np.arange(4), corners[:, i]) for i in range(2)], axis=-1)
        circle = np.stack([np.cos(np.pi / 3 * share), np.sin(np.pi / 3 * share)], axis=-1)
        points.append(k / n * (hexagon + (k / n) ** 3 * (circle - hexagon)))
        rings.append(rings[-1][-1] + 1 + np.arange(3 * k + 1))
    cells = []
    for k, sector in np.ndindex(n, 3):
        inner, outer = rings[k][sector * k :], rings[k + 1][sector * (k + 1) :]
        cells += [(inner[j], outer[j], outer[j + 1]) for j in range(k + 1)]
        cells += [(inner[j], outer[j + 1], inner[j + 1]) for j in range(k)]
    flat = np.concatenate(points)
    flat[np.abs(flat) < 1e-15] = 0.0
    return np.column_stack([flat, np.zeros(len(flat))]), np.array(cells), rings[-1]


def octant(n, R):
    """One eighth of a sphere of the radius R: a face of an octahedron in n^2 triangles, blown up; normals outwards."""
    i, j = (index.ravel() for index in np.mgrid[: n + 1, : n + 1])
    inside = i + j <= n
    number = np.cumsum(inside).reshape(n + 1, n + 1) - 1
    flat = np.stack([n - i - j, i, j], axis=-1)[inside] / n
    # Equal angles along the edges give triangles of nearly the same size.
    bent = np.sin(np.pi / 2 * flat)
    cells = [(number[a, b], number[a + 1, b], number[a, b + 1]) for a in range(n) for b in range(n - a)]
    cells += [(number[a + 1, b], number[a + 1, b + 1], number[a, b + 1]) for a in range(n) for b in range(n - 1 - a)]
    points = R * bent / np.linalg.norm(bent, axis=1, keepdims=True)
    return points, np.array(cells)
