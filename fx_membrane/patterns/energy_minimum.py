"""Least strain energy of cloth in the plane, with equal lengths along seams, by Newton's method with multipliers.

    minimize W(x)  subject to  l_i(x) - l_j(x) = 0 of the sides of seams, or l_i(x) = L_i of sides of given length

The tangent of W and of the multipliers' part is bordered with the gradients of the constraints. Steps are shorter than
the first flip of a cell and lower the merit W + rho |c|_1.

Source: J. Nocedal, S. J. Wright, Numerical Optimization (2006), section 18.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from .cloth import StressFree
from .plane_cells import step_to_flip

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

MOST_STEPS = 100
LAST_STEP = 1e-8  # step over size, after which one more step reaches rounding
MIN_STEP = 1e-4  # shortest step of the line search
SHIFTS = 12  # tries with a stiffer tangent


class Links(NamedTuple):
    """Sides of cells whose lengths are bound.

    Attributes:
        here: Ends of one side, shape (m, 2).
        there: Ends of the side that is as long; the same points where the length is given, shape (m, 2).
        length: Given lengths, or not a number, shape (m,) [m].
    """

    here: Integers
    there: Integers
    length: Array

    @property
    def given(self) -> NDArray[np.bool_]:
        """True for each side of given length, shape (m,)."""
        return np.isfinite(self.length)


class Shape(NamedTuple):
    """Shape of least energy: places, shape (n, 2) [m], and energy [J]."""

    places: Array
    energy: float


def least_energy(cloth: StressFree, places: Array, owner: Integers, links: Links) -> Shape:
    """Shape of least strain energy, from a first one.

    Args:
        cloth: The cloth.
        places: First places, no cell flipped, shape (n, 2) [m].
        owner: Number of the strip of each point, ascending, shape (n,).
        links: Sides of bound lengths.

    Raises:
        RuntimeError: No shape of least energy was found from the first places.
    """
    free, size = _free(places, owner), float(np.ptp(places, axis=0).max())
    multipliers, shift = np.zeros(len(links.length)), 0.0
    energy = cloth.energy(places)
    for _ in range(MOST_STEPS):
        gaps, C = _gaps(places, links), _gap_gradients(places, links)
        forces = cloth.forces(places).ravel()
        stiffness = cloth.stiffness(places) + _gap_curvature(places, links, multipliers)
        for _ in range(SHIFTS):
            step, found = _newton_step(stiffness, C, forces, gaps, free, shift)
            length, reached = _line_search(cloth, places, step, links, energy, gaps, forces, found)
            if length:
                break
            shift = max(10 * shift, 1e-3 * float(stiffness.diagonal().mean()))
        else:
            break
        shift = 0.0 if length == 1 and shift < 1e-6 * stiffness.diagonal().mean() else shift / 10 * (length < 1)
        places, energy, multipliers = places + length * step, reached, found
        if length == 1 and np.abs(step).max() < LAST_STEP * size and shift == 0:
            polished = _polished(cloth, places, links, multipliers, free)
            return Shape(polished, cloth.energy(polished))
    raise RuntimeError(
        "Flattening has not found the shape of least energy; take narrower strips, or a mesh with more regular cells."
    )


def _polished(cloth: StressFree, places: Array, links: Links, multipliers: Array, free: Integers) -> Array:
    """Places after one more Newton step, shape (n, 2) [m]."""
    stiffness = cloth.stiffness(places) + _gap_curvature(places, links, multipliers)
    C, gaps = _gap_gradients(places, links), _gaps(places, links)
    return places + _newton_step(stiffness, C, cloth.forces(places).ravel(), gaps, free, 0.0)[0]


def _free(places: Array, owner: Integers) -> Integers:
    """Components that move: a strip is held at its left end, and across at its right end."""
    held = []
    for strip in range(int(owner[-1]) + 1):
        rows = np.flatnonzero(owner == strip)
        left, right = rows[places[rows, 0].argmin()], rows[places[rows, 0].argmax()]
        held += [2 * left, 2 * left + 1, 2 * right + 1]
    return np.setdiff1d(np.arange(places.size), held)


def lengths(places: Array, ends: Integers) -> Array:
    """Lengths of segments, shape (m,) [m]."""
    return np.asarray(np.linalg.norm(places[ends[:, 1]] - places[ends[:, 0]], axis=1))


def _gaps(places: Array, links: Links) -> Array:
    other = np.where(links.given, links.length, lengths(places, links.there))
    return np.asarray(lengths(places, links.here) - other)


def _gap_gradients(places: Array, links: Links) -> sparse.csr_array:
    entries = []
    for ends, sign in ((links.here, np.ones(len(links.length))), (links.there, np.where(links.given, 0.0, -1.0))):
        t = (places[ends[:, 1]] - places[ends[:, 0]]) * (sign / lengths(places, ends))[:, None]
        entries += [(ends[:, 1], t), (ends[:, 0], -t)]
    rows = np.arange(len(links.length)).repeat(2)
    parts = [
        sparse.csr_matrix(
            (t.ravel(), (rows, (2 * points[:, None] + np.arange(2)).ravel())), shape=(len(links.length), places.size)
        )
        for points, t in entries
    ]
    return parts[0] + parts[1] + parts[2] + parts[3]


def _gap_curvature(places: Array, links: Links, multipliers: Array) -> sparse.csr_array:
    found = sparse.csr_matrix((places.size, places.size))
    for ends, factor in ((links.here, multipliers), (links.there, np.where(links.given, 0.0, -multipliers))):
        length = lengths(places, ends)
        t = (places[ends[:, 1]] - places[ends[:, 0]]) / length[:, None]
        block = (np.eye(2) - t[:, :, None] * t[:, None, :]) * (factor / length)[:, None, None]
        whole = np.concatenate(
            [np.concatenate([block, -block], axis=2), np.concatenate([-block, block], axis=2)], axis=1
        )
        dofs = (2 * ends[:, :, None] + np.arange(2)).reshape(-1, 4)
        place = np.repeat(dofs, 4, axis=1).ravel(), np.tile(dofs, (1, 4)).ravel()
        found = found + sparse.csr_matrix((whole.ravel(), place), shape=found.shape)
    return found


def _newton_step(
    stiffness: sparse.csr_array, C: sparse.csr_array, forces: Array, gaps: Array, free: Integers, shift: float
) -> tuple[Array, Array]:
    """Step of all points, shape (n, 2) [m], and the multipliers [N]."""
    K = stiffness[free][:, free]
    if shift:
        K = K + shift * sparse.identity(len(free))
    scale = float(K.diagonal().mean())  # borders as large as the tangent: equal lengths to rounding
    border = scale * C[:, free]
    matrix = sparse.bmat([[K, border.T], [border, None]], format="csc") if len(gaps) else K.tocsc()
    solved = splu(matrix, permc_spec="COLAMD").solve(-np.concatenate([forces[free], scale * gaps]))
    step = np.zeros(len(forces))
    step[free] = solved[: len(free)]
    return step.reshape(-1, 2), scale * solved[len(free) :]


def _line_search(
    cloth: StressFree,
    places: Array,
    step: Array,
    links: Links,
    energy: float,
    gaps: Array,
    forces: Array,
    multipliers: Array,
) -> tuple[float, float]:
    """Length of the step, zero if none lowers the merit, and the energy there."""
    weight = 1.5 * float(np.abs(multipliers).max(initial=0.0))
    slope = float(forces @ step.ravel()) - weight * float(np.abs(gaps).sum())
    small = np.abs(step).max() < LAST_STEP * np.ptp(places, axis=0).max()
    if not np.isfinite(step).all() or (slope > 0 and not small):
        return 0.0, energy
    length = min(1.0, 0.8 * step_to_flip(places, step, cloth.cloth.triangles))
    merit = energy + weight * float(np.abs(gaps).sum())
    while length > MIN_STEP:
        trial = places + length * step
        reached = cloth.energy(trial)
        if small or reached + weight * float(np.abs(_gaps(trial, links)).sum()) <= merit + 1e-4 * length * slope:
            return length, reached
        length /= 2
    return 0.0, energy
