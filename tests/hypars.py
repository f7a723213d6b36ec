"""Sheets on a square with z = x y / 8, and measures of meshes, for tests of remeshing."""

import numpy as np

from fx_membrane import Fabric, Membrane, rectangle

FABRIC = Fabric(4e5, 0.3)


def edges(triangles):
    return {tuple(sorted(edge)) for cell in triangles.tolist() for edge in (cell[:2], cell[1:], cell[::2])}


def area(structure, name):
    a, b, c = (structure.points[corner] for corner in structure.parts[name].cells.T)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def hypar(n=8, **changes):
    points, triangles = rectangle(4.0, 4.0, n, n)
    points[:, 2] = points[:, 0] * points[:, 1] / 8
    roof = Membrane(triangles, FABRIC, **{"prestress": 2e3, **changes})
    return points, triangles, roof
