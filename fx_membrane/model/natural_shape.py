"""Natural, stress-free shape of cells: its tensors, and their making from flat triangles and unstressed lengths."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.one_side import with_one_side
from ..geometry.sizes import measures, normals, projected
from . import cell_tensors

Array = NDArray[np.float64]

MAX_RATIO = 2.0  # ratio of natural and reference lengths from which on units or cells are mixed up
RATIO_ROUNDING = 1e-12  # of a ratio


def store(part: Any) -> None:
    """Check and store the natural stretch of a part."""
    validation.store(part, validation.finite, "natural_stretch")
    check(f"{type(part).__name__} natural_stretch", part.natural_tensors())


def check(what: str, tensors: Array) -> None:
    """Refuse natural shapes that are inverted, or half or twice as large as the reference shape.

    Args:
        what: Name in messages.
        tensors: A of `forms.natural_shape`, shape (cells, d, d) [-].
    """
    tensors = cell_tensors.once(tensors)
    values = np.linalg.svd(tensors, compute_uv=False)
    inverted = (np.linalg.det(tensors) <= 0) | (np.trace(tensors, axis1=1, axis2=2) <= 0)  # or turned round
    large, small = values[:, 0] > MAX_RATIO - RATIO_ROUNDING, values[:, -1] < 1 / MAX_RATIO + RATIO_ROUNDING
    bad = np.flatnonzero(inverted | large | small)
    if len(bad):
        cell = int(bad[0])
        ratio = values[cell, 0] if large[cell] else values[cell, -1]
        fault = "is inverted" if inverted[cell] else f"is {ratio:.3g} times as long as in the reference shape"
        raise ValueError(
            f"{what}: cell {cell} {fault} without stress, by {validation.short_repr(tensors[cell].tolist())}; give "
            f"ratios of natural to reference lengths between {1 / MAX_RATIO:g} and {MAX_RATIO:g}."
        )


def refuse(what: str, parts: Mapping[str, Any]) -> None:
    """Refuse parts with a natural shape of their own."""
    for name, part in parts.items():
        if (cell_tensors.once(part.natural_tensors()) - np.eye(part.dimension)).any():
            raise ValueError(
                f"{what}: part {name!r} has a natural stretch, but its stress does not depend on strain here; leave "
                "it out, and give the stress as prestress."
            )


def inverse_less_identity(less: Array) -> Array:
    """A^-1 - I from A - I, both of shape (cells, d, d) [-]; small values keep their digits."""
    return -np.linalg.solve(np.eye(less.shape[1]) + less, less)


def strain(H: Array) -> Array:
    """Green-Lagrange strain of the reference shape with respect to the natural one, shape (cells, d, d) [-].

    Args:
        H: A^-1 - I, shape (cells, d, d) [-].
    """
    turned = H.transpose(0, 2, 1)
    return np.asarray((H + turned + turned @ H) / 2)


def natural_stretch(points: ArrayLike, cells: ArrayLike, size: ArrayLike, warp: ArrayLike | None = None) -> Array:
    """Natural stretch of cells of known stress-free size, for `Membrane`, `Cable` and `Mast`.

    Args:
        points: Nodes in the reference shape, shape (n, 3) [m].
        cells: Segments, shape (k, 2), or triangles, shape (k, 3).
        size: Of segments their unstressed lengths, shape (k,), or one for the whole line, that the cells share in
            proportion [m]. Of triangles the flat, stress-free positions of their corners, shape (k, 3, 2) [m], in the
            order of the nodes in `cells`. The warp is along the first axis, seen from the side about which the first
            cell runs counter-clockwise.
        warp: Of triangles the warp as in `Membrane`, shape (3,) or (k, 3).

    Returns:
        Ratios of natural to reference lengths, shape (k,), or for triangles the tensors A, shape (k, 2, 2) [-].

    Raises:
        ValueError: An array has another shape; a length is not positive; a flat triangle is inverted, or its sides are
            twice or half as long as in the reference shape; a warp is given for segments, lacks for triangles, or is
            normal to one.

    Example:
        >>> natural_stretch([[0, 0, 0], [4, 0, 0]], [[0, 1]], 3.99).tolist()
        [0.9975]
    """
    X = validation.positions("natural_stretch points", points)
    known = validation.finite("natural_stretch size", size)
    if _of_pairs(cells):
        if warp is not None:
            raise ValueError(
                f"natural_stretch cells are pairs of nodes, which have no warp, but warp is "
                f"{validation.short_repr(warp)}; leave it out."
            )
        return _of_lengths(X, validation.cells("natural_stretch cells", cells, 2), known)
    triangles = validation.cells("natural_stretch cells", cells, 3)
    validation.in_range("natural_stretch cells", triangles.ravel(), len(X), "node")
    if known.shape != (len(triangles), 3, 2):
        raise ValueError(
            f"natural_stretch size has shape {known.shape}; give flat triangles of shape ({len(triangles)}, 3, 2)."
        )
    if warp is None:
        raise ValueError("natural_stretch of triangles needs their warp as a vector; give warp=(x, y, z).")
    flat = np.flatnonzero(~(measures(X, triangles) > 0))
    if len(flat):
        raise ValueError(f"natural_stretch cells: cell {flat[0]} has no area; give three nodes that are not in line.")
    edges = np.stack([X[triangles[:, 1]] - X[triangles[:, 0]], X[triangles[:, 2]] - X[triangles[:, 0]]], axis=2)
    with np.errstate(over="ignore", invalid="ignore"):  # of sizes that are refused
        tensors = _edges(known) @ np.linalg.inv(_frames(X, triangles, warp).transpose(0, 2, 1) @ edges)
        check("natural_stretch size beside points and warp", tensors)
    return tensors


def _of_pairs(cells: Any) -> bool:
    """Return True if cells are rows of two nodes."""
    try:
        return np.shape(cells)[-1:] == (2,)
    except ValueError:  # rows of unequal length
        return False


def _of_lengths(X: Array, segments: NDArray[np.int64], lengths: Array) -> Array:
    validation.in_range("natural_stretch cells", segments.ravel(), len(X), "node")
    reference = measures(X, segments)
    if lengths.shape not in ((), (len(segments),)):
        raise ValueError(
            f"natural_stretch size has shape {lengths.shape}; give one length, or one for each of the "
            f"{len(segments)} cells."
        )
    wrong = np.flatnonzero(np.atleast_1d(lengths) <= 0)
    if len(wrong):
        value = np.atleast_1d(lengths)[wrong[0]]
        raise ValueError(f"natural_stretch size has the unstressed length {value:g}; give one that is positive [m].")
    stretch = lengths / (reference if lengths.shape else reference.sum()) * np.ones(len(segments))
    check("natural_stretch size beside points and warp", stretch[:, None, None])
    return stretch


def _frames(X: Array, triangles: NDArray[np.int64], warp: ArrayLike) -> Array:
    """Warp and weft of triangles, on one side of them as `Structure` turns them, shape (k, 3, 2)."""
    normal, given = normals(X, with_one_side(X, triangles)[0]), validation.finite("natural_stretch warp", warp)
    if given.shape not in ((3,), normal.shape):
        raise ValueError(f"natural_stretch warp has shape {given.shape}; give (3,) or ({len(triangles)}, 3).")
    along = projected(np.broadcast_to(given, normal.shape), normal)
    flat = np.flatnonzero(~along.any(axis=1))
    if len(flat):
        raise ValueError(f"natural_stretch warp is zero or normal to cell {flat[0]}; give a vector that lies in it.")
    return np.stack([along, np.cross(normal, along)], axis=2)


def _edges(flat: Array) -> Array:
    return np.stack([flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]], axis=2)
