"""Forces of bars of given signs in balance with forces on their nodes: found by least squares, or shown impossible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

Array = NDArray[np.float64]

# Half and double of PENALTY, MINOR and REPEATS change forces of masts with three stays each by less than 1e-12.
FORCE_ROUNDING = 1e-14  # unbalanced force, relative to the largest, that is rounding
PENALTY = 1e4  # weight of balance over wanted forces in one search, after which the next takes up the rest
MINOR = 1e-2  # weight of bars without a wanted force, which stay near the last solution
SETTLED_FORCES = 1e-13  # change of forces, relative to the largest, that counts as none
REPEATS = 100  # limit of searches, of which some three are needed
CARRYING = 1e-10  # force, relative to the largest, below which a bar carries nothing
TOLERANCE = 1e-15  # of a search for signs, which ends after finitely many steps
MAX_STEPS_PER_BAR = 20  # limit of these steps, in numbers of bars
RANK = 1e-10  # singular value, relative to the largest, that counts as zero


def signed(matrix: Array, target: Array) -> Array:
    """Non-negative x that leaves the least residual of matrix @ x = target, shape (bars,)."""
    count = matrix.shape[1]
    found = lsq_linear(
        matrix,
        target,
        (0, np.inf),
        method="bvls",
        tol=TOLERANCE,
        max_iter=MAX_STEPS_PER_BAR * count + MAX_STEPS_PER_BAR,
    )
    return np.asarray(np.maximum(found.x, 0.0))


def nearest(matrix: Array, target: Array, wanted: Array) -> Array:
    """Non-negative solution of matrix @ x = target that is nearest to wanted values, and else the smallest.

    Args:
        matrix: Forces on the free components of nodes by unit forces of bars, shape (components, bars) [-].
        target: Forces to balance, with a non-negative solution, shape (components,) [N].
        wanted: Wanted values, positive; zero where none is wanted, shape (bars,) [N].

    Source:
        M. J. D. Powell, A method for nonlinear constraints in minimization problems, in: R. Fletcher (ed.),
        Optimization, Academic Press 1969, 283-298: the balance is a penalty, shifted by the residual of each search.
    """
    scale = max(np.abs(target).max(initial=0.0), wanted.max(initial=0.0))
    if scale == 0:
        return np.zeros(len(wanted))
    target, wanted, wished = target / scale, wanted / scale, wanted > 0
    if wished.any():
        x = _closest(matrix, target, wanted, np.where(wished, 1.0, MINOR), wished)
        rows, values = np.vstack([matrix, np.eye(len(wanted))[wished]]), np.concatenate([target, x[wished]])
    else:
        rows, values = matrix, target
    x = _closest(rows, values, np.zeros(len(wanted)), np.ones(len(wanted)), wished | True)
    return scale * _exact(matrix, target, x)


def _closest(matrix: Array, target: Array, centre: Array, weight: Array, wished: NDArray[np.bool_]) -> Array:
    """Non-negative solution closest to a centre in wished components; others have it at the last solution."""
    rows = np.vstack([PENALTY * matrix, np.diag(weight)])
    x, shift = centre, np.zeros(len(target))
    for _ in range(REPEATS):
        before = x
        x = signed(rows, np.concatenate([PENALTY * (target + shift), weight * np.where(wished, centre, x)]))
        rest = target - matrix @ x
        shift += rest
        if max(np.abs(rest).max(), np.abs(x - before).max()) <= SETTLED_FORCES:
            break
    return x


def _exact(matrix: Array, target: Array, near: Array) -> Array:
    """Remove rounding from a solution, with its zeros kept."""
    carrying = near > CARRYING
    x = np.where(carrying, near, 0.0)
    for _ in range(2):
        rest = target - matrix @ x
        if np.abs(rest).max() > FORCE_ROUNDING:
            x[carrying] += np.linalg.lstsq(matrix[:, carrying], rest, rcond=RANK)[0]
    return np.asarray(np.maximum(x, 0.0))
