"""Seams on the triangles of a surface: nodes, points on edges and points in cells along them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..surfaces.nearest_points import ON, nearest
from ..surfaces.shapes import Surface
from .split_mesh import SplitMesh, barycentric

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

ZERO_BARYCENTRIC = 1e-7  # barycentric coordinate that counts as zero


class Site(NamedTuple):
    """Point of a seam: nodes of the facet that it is on (one), between (two) or within (three), and its position."""

    corners: tuple[int, ...]
    facet: int
    place: Array


def sites_of(surface: Surface, number: int, places: Array, snap: float, shortest: Array) -> list[Site]:
    """Points of a seam on the triangles that it crosses, those near to nodes moved there.

    Args:
        surface: The surface.
        number: Number of the seam, for messages.
        places: Points along it, each two of them in one triangle, shape (k, 3) [m].
        snap: Distance from a node, over the shortest edge there, within which the seam is led through it [-].
        shortest: Shortest edge at the nodes, shape (n,) [m].

    Raises:
        ValueError: The seam leaves the surface.
    """
    middles = (places[1:] + places[:-1]) / 2
    facets, _, gaps = nearest(surface, middles)
    size = float(np.ptp(surface.points[np.unique(surface.triangles)], axis=0).max())
    off = int(gaps.argmax())
    if gaps[off] > ON * size:
        raise ValueError(
            f"seams, entry {number}, is {gaps[off]:.3g} off the surface at {validation.format_point(middles[off])}; "
            "make it on this surface, and on the part that is cut."
        )
    facets = np.append(facets, facets[-1])
    bent = _bends(surface, facets, places)
    facets, places = facets[bent], places[bent]
    corners = surface.points[surface.triangles[facets]]
    shares = barycentric(corners, places)
    shares[shares < ZERO_BARYCENTRIC] = 0.0
    within = (shares > 0).all(axis=1)
    shares[within[:, None] & (shares < snap)] = 0.0
    shares /= shares.sum(axis=1, keepdims=True)
    there = np.einsum("kc,kci->ki", shares, corners)
    nodes = surface.triangles[facets]
    apart = np.linalg.norm(there[:, None] - corners, axis=2)
    close = (apart < snap * shortest[nodes]) & (shares > 0)
    found = []
    for facet, place, row, share, near in zip(facets.tolist(), there, nodes.tolist(), shares, close, strict=True):
        kept = np.flatnonzero(share > 0) if not near.any() else np.flatnonzero(near)[:1]
        found.append(Site(tuple(row[corner] for corner in kept), facet, place))
    return _through_nodes(found)


def _bends(surface: Surface, facets: Integers, places: Array) -> NDArray[np.bool_]:
    """Find the ends of a seam, and the points at which it bends or leaves a facet, shape (k,)."""
    side = np.diff(places, axis=0)
    length = np.linalg.norm(side, axis=1)
    aside = np.linalg.norm(np.cross(side[:-1], side[1:]), axis=1) / np.maximum(length[:-1] + length[1:], 1e-300)
    corners = surface.points[surface.triangles[facets[1:-1]]]
    within = (barycentric(corners, places[1:-1]) > ZERO_BARYCENTRIC).all(axis=1)
    size = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1)
    return np.concatenate([[True], ~within | (aside > ZERO_BARYCENTRIC * size), [True]])


def _through_nodes(sites: list[Site]) -> list[Site]:
    """Lead a seam through its nodes once, without crossings of edges beside these nodes."""
    for way in (range(1, len(sites)), range(len(sites) - 2, -1, -1)):
        step = way.step
        for index in way:
            before, here = sites[index - step], sites[index]
            if len(before.corners) == 1 and len(here.corners) == 2 and before.corners[0] in here.corners:
                sites[index] = before
    kept = [sites[0]]
    for site in sites[1:]:
        if site.corners != kept[-1].corners or len(site.corners) > 1:
            kept.append(site)
    return kept


def laid(mesh: SplitMesh, sites: list[Site]) -> list[int]:
    """Split a mesh along a seam; return the nodes along it."""
    nodes: list[int] = []
    for site in sites:
        if len(site.corners) == 1:
            node = site.corners[0]
        elif len(site.corners) == 2:
            node = mesh.on_edge(*site.corners, site.place)
        else:
            node = mesh.in_facet(site.facet, site.place)
        if not nodes:
            nodes = [node]
        elif node != nodes[-1]:
            nodes += mesh.lay(nodes[-1], node)[1:]
    return nodes
