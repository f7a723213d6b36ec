"""Natural shapes of parts: what they are made of, and refused input."""

from itertools import pairwise

import numpy as np
import pytest

from fx_membrane import Cable, Fabric, Mast, Membrane, OrthotropicFabric, Structure, Support, natural_stretch
from models import sheet

FABRIC = Fabric(Et=1e5, nu=0.3)
TRIANGLES = [[0, 1, 2], [0, 2, 3], [1, 2, 3]]
SQUARE = np.array([[0.0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0]])
FLAT = SQUARE[[[0, 1, 2], [0, 2, 3]]][:, :, :2]


def membrane(stretch, warp=(1, 0, 0)):
    return Membrane(TRIANGLES, FABRIC, warp=warp, natural_stretch=stretch)


@pytest.mark.parametrize(
    ("stretch", "tensor"),
    [
        (0.99, [[0.99, 0], [0, 0.99]]),
        ((0.99, 0.98), [[0.99, 0], [0, 0.98]]),
        ([[0.99, 0.01], [0.01, 0.98]], [[0.99, 0.01], [0.01, 0.98]]),
        ([[1.0, 0.1], [0.0, 1.0]], [[1.0, 0.1], [0.0, 1.0]]),  # the natural warp keeps its direction
        ([[0.99], [0.98], [0.97]], [[0.97, 0], [0, 0.97]]),
        ([(0.99, 1.0), (0.98, 1.0), (0.97, 1.0)], [[0.97, 0], [0, 1.0]]),
    ],
)
def test_natural_tensors(stretch, tensor):
    tensors = membrane(stretch).natural_tensors()
    assert tensors.shape == (3, 2, 2)
    assert np.array_equal(tensors[-1], tensor)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: membrane([[0, 1.0], [1.0, 0]]), r"^Membrane natural_stretch: cell 0 is inverted .*\[1.0, 0.0\]\].*"),
        (lambda: membrane(-1.0), r"^Membrane natural_stretch: cell 0 is inverted .*-1\.0"),
        (lambda: membrane(2.01), r"^Membrane natural_stretch: cell 0 is 2\.01 times as long .* between 0\.5 and 2\.$"),
        (lambda: membrane(2.0), r"^Membrane natural_stretch: cell 0 is 2 times as long .* between 0\.5 and 2\.$"),
        (lambda: membrane((0.5, 1.0)), r"^Membrane natural_stretch: cell 0 is 0\.5 times as long"),
        (lambda: membrane([1.0, 1.0, 0.49]), r"^Membrane natural_stretch has shape \(3,\); give a number, a "),
        (lambda: membrane([[1.0], [1.0], [0.49]]), r"natural_stretch: cell 2 is 0\.49 times as long .* between 0\.5"),
        (lambda: membrane(np.ones((3, 3))), r"^Membrane natural_stretch has shape \(3, 3\)"),
        (lambda: membrane(np.nan), r"^Membrane natural_stretch .*nan"),
        (
            lambda: membrane((0.99, 0.98), warp=None),
            r"^Membrane natural_stretch is \[0\.99, 0\.98\], which has a warp and a weft; give the warp as a vector",
        ),
        (lambda: Cable([[0, 1]], 1e6, natural_stretch=0.0), r"^Cable natural_stretch: cell 0 is "),
        (lambda: Cable([[0, 1]], 1e6, natural_stretch=-0.9), r"^Cable natural_stretch: cell 0 is inverted"),
        (lambda: Mast([[0, 1]], 1e6, natural_stretch=3.0), r"^Mast natural_stretch: cell 0 is 3 times as long"),
        (lambda: Mast([[0, 1]], 1e6, natural_stretch=(0.9, 1.0)), r"^Mast natural_stretch has shape \(2,\).* 1 cells"),
    ],
)
def test_bad_natural_stretch(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_natural_stretch_of_lengths():
    points = [[0, 0, 0], [3, 0, 0], [4, 0, 0]]
    line = list(pairwise(range(3)))
    assert natural_stretch(points, line, 3.96) == pytest.approx([0.99, 0.99])
    assert natural_stretch(points, line, [2.97, 1.0]) == pytest.approx([0.99, 1.0])


def test_natural_stretch_of_flat_triangles():
    """It does not depend on place and turn of the flat triangles, nor on the order of the nodes."""
    A = np.array([[0.99, 0.01], [0.0, 0.97]])
    triangles = np.array([[0, 1, 2], [0, 3, 2]])  # the second runs clockwise
    flat = SQUARE[triangles][:, :, :2] @ A.T + [5.0, -3.0]
    found = natural_stretch(SQUARE, triangles, flat, (1, 0, 0))
    assert np.allclose(found, [A, A], atol=1e-14)
    part = Membrane(triangles, FABRIC, warp=(1, 0, 0), natural_stretch=found)
    turned = Structure(SQUARE, {"roof": part}, [Support([0, 1, 2, 3])]).parts["roof"]
    assert not np.array_equal(turned.cells, triangles)
    assert np.allclose(turned.natural_tensors(), [A, A], atol=1e-14)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((SQUARE, [[0, 1]], 0.0), r"^natural_stretch size has the unstressed length 0; give one that is positive"),
        ((SQUARE, [[0, 1], [1, 2]], [2.0, -1.0]), r"^natural_stretch size has the unstressed length -1"),
        ((SQUARE, [[0, 1], [1, 2]], [2.0, 1.0, 1.0]), r"^natural_stretch size has shape \(3,\).*2 cells"),
        ((SQUARE, [[0, 1]], 4.1), r"^natural_stretch size beside points and warp: cell 0 is 2\.05 times as long"),
        ((SQUARE, [[0, 1]], 2.0, (1, 0, 0)), r"^natural_stretch cells are pairs .* warp is \(1, 0, 0\); leave"),
        ((SQUARE, [[0, 1, 2], [0, 2, 3]], FLAT, (1, 0)), r"^natural_stretch warp has shape \(2,\); give \(3,\) or"),
        ((SQUARE * [1, 0, 0], [[0, 1, 2]], FLAT[:1], (1, 0, 0)), r"^natural_stretch cells: cell 0 has no area"),
        ((SQUARE, [[0, 9]], 2.0), r"^natural_stretch cells names node 9"),
        ((SQUARE, [[0, 1, 2], [0, 2, 3]], FLAT), r"^natural_stretch of triangles needs their warp .*give warp="),
        ((SQUARE, [[0, 1, 2], [0, 2, 3]], FLAT, (0, 0, 1)), r"^natural_stretch warp is zero or normal to cell 0"),
        ((SQUARE, [[0, 1, 2], [0, 2, 3]], FLAT[:1], (1, 0, 0)), r"^natural_stretch size has shape \(1, 3, 2\)"),
        (
            (SQUARE, [[0, 1, 2], [0, 2, 3]], FLAT * [-1, 1], (1, 0, 0)),
            r"^natural_stretch size beside .*: cell 0 is inverted",
        ),
        (
            (SQUARE, [[0, 1, 2], [0, 2, 3]], 3 * FLAT, (1, 0, 0)),
            r"^natural_stretch size beside .*: cell 0 is 3 times",
        ),
        (
            (SQUARE, [[0, 1, 2], [0, 2, 3]], 2 * SQUARE[[[0, 1, 2], [0, 2, 3]]][:, :, :2], (1, 0, 0)),
            r"^natural_stretch size beside .*: cell 0 is 2 times",
        ),
    ],
)
def test_bad_natural_sizes(arguments, message):
    with pytest.raises(ValueError, match=message):
        natural_stretch(*arguments)


def test_natural_shape_with_shear_of_a_band_with_one_side_is_refused():
    """Its sign depends on the cell, as of a prestress."""
    n = 12
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    width = np.repeat([[-1.0], [1.0]], n, axis=1)
    radius = 3 + width * np.cos(t / 2)
    points = np.stack([radius * np.cos(t), radius * np.sin(t), width * np.sin(t / 2)], axis=-1).reshape(-1, 3)
    lower, upper = np.arange(n), n + np.arange(n)
    after = np.roll(np.arange(n), -1)
    low, up = lower[after].copy(), upper[after].copy()
    low[-1], up[-1] = n, 0  # the twist
    band = np.concatenate([np.stack([lower, low, up], 1), np.stack([lower, up, upper], 1)])
    woven = OrthotropicFabric(1e5, 1e5, 0.3, 1e4)
    warp = np.stack([-np.sin(t), np.cos(t), 0 * t], 1)
    part = Membrane(band, woven, warp=np.tile(warp, (2, 1)), natural_stretch=[[1.0, 0.01], [0.0, 1.0]])
    with pytest.raises(ValueError, match=r"with shear in its natural stretch \[\[1.0, 0.01\], \[0.0, 1.0\]\]"):
        Structure(points, {"band": part}, [Support([0, 1, 2])])


def test_natural_stretch_is_compared_by_value():
    one, same, other = (membrane(stretch) for stretch in (0.99, 0.99, 0.98))
    assert one == same
    assert one != other
    assert sheet() == sheet()
