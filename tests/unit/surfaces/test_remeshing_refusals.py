"""Sizes and shapes that have no new mesh: each is refused in a sentence."""

import numpy as np
import pytest

from fx_membrane import Cable, Membrane, Structure, Support, force_density, polyline, rectangle, remeshed
from hypars import FABRIC, hypar

pytest.importorskip("gmsh")


def sphere(n=8):
    """Blow up a cube: a closed surface."""
    points, triangles = rectangle(2.0, 2.0, n, n)
    up = np.array([0.0, 0.0, 1.0])
    faces = [points + up, points * [1, -1, 1] - up]
    faces += [faces[side][:, axes] for axes in ([2, 0, 1], [1, 2, 0]) for side in range(2)]
    every = np.vstack(faces)
    cells = np.vstack([triangles + k * len(points) for k in range(6)])
    _, first, which = np.unique(np.round(every, 9), axis=0, return_index=True, return_inverse=True)
    every = every[first]
    return every / np.linalg.norm(every, axis=1, keepdims=True), which.ravel()[cells]


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("size", "message"),
    [
        (0, "^size is 0; it must be positive"),
        (-1.0, "^size is -1.0; it must be positive"),
        (9.0, "^size is 9, more than that of the membranes, 4"),
        (1e-4, "^size is 0.0001, for membranes of the size 4: too many cells; give a larger one"),
        (lambda x: np.full(x.shape[1], 1e-5), "^size is 1e-05, for membranes of the size 4: too many cells"),
        (lambda x: -(x[0] ** 2), "^size, as a function of places, gives .*positive numbers"),
        (lambda x: np.ones(3), "^size, as a function of places, gives .*one for each place"),
    ],
)
def test_size_refused(size, message):
    points, _, roof = hypar()
    with pytest.raises(ValueError, match=message):
        remeshed(Structure(points, {"roof": roof}), size)


def test_shapes_refused():
    points, triangles, roof = hypar()
    ball, cells = sphere()
    closed = Structure(ball, {"ball": Membrane(cells, FABRIC, 1e3)})
    with pytest.raises(ValueError, match=r"^Part 'ball' is closed around \(.*make it of two parts"):
        remeshed(closed, 0.3)
    with pytest.raises(ValueError, match=r"^The structure has no membrane to mesh anew; its parts are \['rope'\]"):
        remeshed(Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6)}), 0.3)
    with pytest.raises(ValueError, match=r"^keep names node 99, which does not exist"):
        remeshed(Structure(points, {"roof": roof}), 0.3, keep=[99])
    with pytest.raises(ValueError, match=r"^remeshed shape is 5; give a Structure or Form"):
        remeshed(5, 0.3)
    net = force_density(points[:3], polyline([0, 1, 2]), 1.0, [Support([0, 2])])
    with pytest.raises(ValueError, match=r"^The form of a net has no stiffness"):
        remeshed(net, 0.3)
    fin = Structure(np.vstack([points, [0, 0, 5]]), {"roof": Membrane([*triangles, [40, 41, 81]], FABRIC, 1e3)})
    with pytest.raises(ValueError, match=r"^Part 'roof' branches"):
        remeshed(fin, 0.3)
    centre = points[triangles].mean(axis=1)
    kite = triangles[(centre[:, 0] > 0) != (centre[:, 1] > 0)]
    sheet = Structure(points, {"kite": Membrane(np.vstack([kite, [[0, 1, 10]]]), FABRIC, 1e3)})
    assert remeshed(sheet, 0.5).structure.parts["kite"].cells.shape[1] == 3  # pieces that meet in a node
    hollow = np.setdiff1d(np.arange(128), np.flatnonzero((triangles == 40).any(axis=1))[[0, 3]])
    with pytest.raises(ValueError, match=r"^Part 'roof' touches itself in a node of its rim, at \("):
        remeshed(Structure(points, {"roof": Membrane(triangles[hollow], FABRIC, 1e3)}), 0.5)
