"""Rings too far from the base of their membrane: how high a membrane of constant stress ratio can hold one.

On a surface of revolution stresses n_s along meridians and n_t along rings balance if d(r n_s) / dr = n_t. Then r n_s
sin(phi) is constant, with the slope phi of the meridian. A constant ratio k = n_s / n_t gives r n_s ~ r^(1/k), so
sin(phi) = (c / r)^(1/k) with the neck c. The height between neck and radius r is the integral of tan(phi):

    h(c, r) = c k int_0^U cosh(u)^(k - 1) du,  cosh(U) = (r / c)^(1/k)

which is c arcosh(r / c), a catenoid, for k = 1. Radii a and b reach the maximum over c of h(c, a) + h(c, b).

A base that is no circle counts as one, by the mean of log r over the angle. Far from the ring a film is nearly
harmonic. Its conformal radius, the mean over harmonic measure, is less: a square of side 2 a has 1.079 a, and the mean
over the angle is 1.116 a. So a ring that is found too far has no film.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.optimize import minimize_scalar
from scipy.sparse.csgraph import connected_components
from scipy.special import roots_legendre

from ...checks import validation
from ...geometry.sizes import lengths, normals
from ...geometry.topology import boundary_cells, boundary_edges
from ...model.structure import Structure
from .sewn_surfaces import cells_of, joined_membranes, listed

Array = NDArray[np.float64]

# Deviation of the distances from the centre, relative to the radius, up to which a loop counts as a ring: of an ellipse
# with axes of 3 : 1; a square has 0.11.
ROUND_RING = 0.35
ZERO = 1e-9  # coordinate of a centre over the radius, that counts as rounding
NODES, WEIGHTS = roots_legendre(40)  # the integrand, a power of cosh, is smooth


def reach(a: float, b: float, ratio: float = 1.0) -> float:
    """Largest distance along their axis of two rings with a membrane between them [m].

    Args:
        a: Radius of a ring [m].
        b: Radius of the other [m].
        ratio: Stress along meridians over that along rings [-].
    """

    def height(neck: float, radius: float) -> float:
        end = np.arccosh(max((radius / neck) ** (1 / ratio), 1.0))
        return float(neck * ratio * end / 2 * (WEIGHTS @ np.cosh(end * (NODES + 1) / 2) ** (ratio - 1)))

    least = min(a, b)
    found = minimize_scalar(lambda c: -height(c, a) - height(c, b), bounds=(1e-6 * least, least), method="bounded")
    return max(-float(found.fun), height(least, max(a, b)))


class Ring(NamedTuple):
    """Held round edge of a membrane: its nodes, centre (3,), axis (3,), radius [m], and stress ratio there [-]."""

    nodes: NDArray[np.int64]
    centre: Array
    axis: Array
    radius: float
    ratio: float


def far_ring(structure: Structure, points: Array, stresses: Mapping[str, Array], beyond: float = 1.0) -> str:
    """Tell of a held ring that is too far from the base of its membrane, in words; empty without one.

    The base is the held rest of the boundary, or the largest ring if there is none.

    Args:
        structure: The structure.
        points: Its shape, shape (n, 3) [m].
        stresses: By membrane, stress in space, shape (cells, 3, 3) [N/m].
        beyond: Distance of a ring over the reach of its membrane, from which on it counts as too far [-].
    """
    held = structure.supported.all(axis=1)
    for names in joined_membranes(structure, stresses):
        cells, stress = cells_of(structure, names), np.concatenate([stresses[name] for name in names])
        rings = sorted(_rings(points, cells, stress, held), key=lambda ring: ring.radius)
        boundary = np.unique(boundary_edges(cells)) if rings else np.zeros(0, dtype=np.int64)
        base = np.setdiff1d(boundary[held[boundary]], np.concatenate([ring.nodes for ring in rings] or [boundary]))
        if not len(base) and rings:
            base = rings.pop().nodes
        for ring in rings:
            rise = float(np.abs((points[base] - ring.centre) @ ring.axis).min())
            edges = boundary_edges(cells)
            width = _width(points, base, edges[np.isin(edges, base).all(axis=1)], ring)
            high = reach(ring.radius, width, ring.ratio)
            if rise > beyond * high:
                equal = f"{ring.ratio:.3g}" == "1"
                told = "equal stress" if equal else f"a ratio of {ring.ratio:.3g} of the stress"
                return (
                    f"A ring is too far from its base: that of {listed(names)} around "
                    f"{validation.format_point(ring.centre)}, of radius {ring.radius:.4g}, is {rise:.4g} away from it; "
                    f"a membrane with {told} across the ring {'and' if equal else 'to that'} along it reaches "
                    f"about {high:.3g}"
                )
    return ""


def _width(points: Array, base: NDArray[np.int64], edges: NDArray[np.int64], ring: Ring) -> float:
    """Radius of the circle that stands for a base, of nodes (b,) and held edges (k, 2), around a ring [m].

    In directions without a held edge, as between corners with edge cables, its farthest node counts.
    """
    plane = np.linalg.svd(ring.axis[None])[2][1:]
    farthest = max(float(lengths((points[base] - ring.centre) @ plane.T).max()), ring.radius)
    first, last = np.moveaxis((points[edges] - ring.centre) @ plane.T, 1, 0)
    angles = np.abs(np.arctan2(first[:, 0] * last[:, 1] - first[:, 1] * last[:, 0], (first * last).sum(axis=1)))
    logs = [np.log(np.maximum(lengths(place), ring.radius)) for place in (first, last)]  # of nodes, on the curve
    open_angle = max(2 * np.pi - float(angles.sum()), 0.0)
    total = angles @ np.mean(logs, axis=0) + open_angle * np.log(farthest)
    return float(np.exp(total / (angles.sum() + open_angle)))


def has_ring(structure: Structure, triangles: NDArray[np.int64]) -> bool:
    """Return True for a membrane of these cells with several boundaries, one of them held all around."""
    held, edges = structure.supported.all(axis=1), boundary_edges(triangles)
    loop = _loops(edges)
    return len(np.unique(loop)) > 1 and any(held[edges[loop == k]].all() for k in np.unique(loop))


def _loops(edges: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return the number of the closed boundary of each edge, shape (edges,)."""
    links = sparse.coo_matrix((np.ones(len(edges)), edges.T), shape=(edges.max(initial=-1) + 1,) * 2)
    return np.asarray(connected_components(links, directed=False)[1][edges[:, 0]])


def _rings(points: Array, triangles: NDArray[np.int64], stress: Array, held: NDArray[np.bool_]) -> list[Ring]:
    """Round edges of a membrane that are held all around."""
    edges, cells = boundary_edges(triangles), boundary_cells(triangles)
    loop = _loops(edges)
    closed = [k for k in np.unique(loop) if held[edges[loop == k]].all()]
    found = []
    for k in closed:
        nodes = np.unique(edges[loop == k])
        centre = points[nodes].mean(axis=0)
        axis = np.linalg.svd(points[nodes] - centre, full_matrices=False)[2][-1]
        distance = lengths(points[nodes] - centre)
        if distance.std() > ROUND_RING * distance.mean():
            continue
        beside = triangles[cells[loop == k]]
        # Around the axis at the centre of the cell, as an edge has another angle there on a coarse mesh.
        along = np.cross(axis, points[beside].mean(axis=1) - centre)
        along /= lengths(along)[:, None]
        across = np.cross(normals(points, beside), along)
        n_s, n_t = (np.einsum("ki,kij,kj->k", v, stress[cells[loop == k]], v).mean() for v in (across, along))
        if n_t <= ZERO * n_s:  # threads from ring to base, of any length
            continue
        centre = np.where(np.abs(centre) > ZERO * distance.mean(), centre, 0.0)
        found.append(Ring(nodes, centre, axis, float(distance.mean()), float(n_s / n_t)))
    return found
