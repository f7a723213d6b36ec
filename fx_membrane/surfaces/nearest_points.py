"""Points of a surface nearest to places in space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..checks import validation
from .shapes import Surface

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

CANDIDATES = 32  # cells with near centres among which a place is looked for first
HIT = 1e-12  # distance over the size of the surface below which no cell is nearer
ON = 1e-6  # distance over the size of the surface within which a place is on it


def nearest(surface: Surface, places: Array) -> tuple[Integers, Array, Array]:
    """Cells nearest to places, shape (k,), shares of their corners (k, 3), and distances (k,) [m]."""
    corners = surface.points[surface.triangles]
    centres = corners.mean(axis=1)
    reach = np.linalg.norm(corners - centres[:, None], axis=2).max()
    near = cKDTree(centres).query(places, k=min(CANDIDATES, len(centres)))
    bound, candidates = (np.reshape(entry, (len(places), -1)) for entry in near)
    shares, distance = _in_cells(corners[candidates], places[:, None])
    best = distance.argmin(axis=1)
    rows = np.arange(len(places))
    cells, shares, distance = candidates[rows, best], shares[rows, best], distance[rows, best]
    size = np.ptp(surface.points[surface.triangles.ravel()], axis=0).max()
    unsure = (distance > HIT * size) & (
        bound[:, -1] - reach < distance
    )  # a cell with a centre further away may be nearer
    for row in np.flatnonzero(unsure) if len(centres) > CANDIDATES else ():
        of_all, gaps = _in_cells(corners, places[row])
        cells[row] = gaps.argmin()
        shares[row], distance[row] = of_all[cells[row]], gaps[cells[row]]
    return cells, shares, distance


def _in_cells(corners: Array, place: Array) -> tuple[Array, Array]:
    """Shares of the point nearest to a place in each cell, shape (..., 3), and its distance, shape (...)."""
    a, b, c = np.moveaxis(corners, -2, 0)
    inside = _solved(b - a, c - a, place - a)
    shares = [np.concatenate([1 - inside.sum(axis=-1, keepdims=True), inside], axis=-1)]
    for first in range(3):
        p, q = corners[..., first, :], corners[..., (first + 1) % 3, :]
        t = np.sum((place - p) * (q - p), axis=-1) / np.sum((q - p) ** 2, axis=-1)
        side = np.zeros(shares[0].shape)
        side[..., first], side[..., (first + 1) % 3] = 1 - t.clip(0, 1), t.clip(0, 1)
        shares.append(side)
    every = np.stack(shares)
    gaps = np.linalg.norm(np.einsum("s...c,...ci->s...i", every, corners) - place, axis=-1)
    gaps[0] = np.where(every[0].min(axis=-1) >= 0, gaps[0], np.inf)
    best = gaps.argmin(axis=0)
    return np.take_along_axis(every, best[None, ..., None], axis=0)[0], np.take_along_axis(gaps, best[None], axis=0)[0]


def _solved(u: Array, v: Array, w: Array) -> Array:
    """Coefficients of u and v in the projection of w on their plane, shape (..., 2)."""
    uu, uv, vv = (np.sum(x * y, axis=-1) for x, y in ((u, u), (u, v), (v, v)))
    wu, wv = np.sum(w * u, axis=-1), np.sum(w * v, axis=-1)
    whole = uu * vv - uv**2
    return np.stack([(vv * wu - uv * wv) / whole, (uu * wv - uv * wu) / whole], axis=-1)


def on_surface(what: str, surface: Surface, place: object) -> tuple[int, Array]:
    """Cell and shares of a point given by its node number or its position.

    Raises:
        ValueError: It is neither, or is not on the surface.
    """
    if isinstance(place, int | np.integer) and not isinstance(place, bool):
        cells = np.argwhere(surface.triangles == int(place))
        if not len(cells):
            raise ValueError(f"{what} is node {place}, which is not on the surface; give one of its nodes, or a place.")
        return int(cells[0, 0]), np.eye(3)[cells[0, 1]]
    position = validation.vector(what, place)  # type: ignore[arg-type]  # checked there
    cells, shares, distance = nearest(surface, position[None])
    size = float(np.ptp(surface.points[np.unique(surface.triangles)], axis=0).max())
    if distance[0] > ON * size:
        there = validation.format_point(shares[0] @ surface.points[surface.triangles[cells[0]]])
        raise ValueError(
            f"{what} {validation.format_point(position)} is not on the surface, but {distance[0]:.3g} from it; the "
            f"nearest point is {there}."
        )
    inner = np.where(shares[0] < 1e-9, 0.0, shares[0])
    return int(cells[0]), inner / inner.sum()
