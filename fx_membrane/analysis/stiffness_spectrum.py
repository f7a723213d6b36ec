"""Lowest eigenvalues of the tangent of a state, with borders, and of that of water at an outlet that moves.

Where an outlet sinks, water runs off, and its level follows the outlet: the tangent is unsymmetric. Where it rises, the
water keeps its volume: the tangent is symmetric. Each motion meets one of the two, and the opposite motion the other.
A real eigenvector of a negative eigenvalue of either tangent leads away from the state, one way. A stable state has
none.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.problem_under_actions import LoadedProblem
from ..solvers import eigenvalues
from ..solvers.augmented_matrix import augmented
from ..solvers.eigenvalues import Eigenpair

Rows = NDArray[np.signedinteger[Any]]

SHIFT_MARGIN = 1e-6  # distance of a shift below a bound, as a fraction


class Spectrum(NamedTuple):
    """Lower end of a spectrum.

    Attributes:
        pairs: Lowest eigenvalues, ascending in their real parts.
        negative: Number of eigenvalues with a negative real part, found or not.
        zero: Number of zero eigenvalues, found or not.
    """

    pairs: list[Eigenpair]
    negative: int
    zero: int


def lowest_spectrum(loaded: LoadedProblem, x: PETSc.Vec, K: PETSc.Mat, rows: Rows, count: int) -> Spectrum:
    """Lowest eigenvalues of the tangent, or of the worse one of the two of water at an outlet that moves.

    Args:
        loaded: The problem.
        x: The state.
        K: Sparse part of the tangent, of the free components; freed.
        rows: Rows of K among those of this process's part of a vector.
        count: Number of eigenvalues.
    """
    followers = len(loaded.integrals.following(x))
    again = K.copy() if followers else None
    whole = augmented(K, None, loaded.borders(x), rows)
    pairs, negative = eigenvalues.lowest(whole.K, whole.M, count, borders=whole.negative)
    kept = Spectrum(pairs, negative, eigenvalues.zeros(whole.K, whole.M))
    whole.free()
    if again is None:
        return kept
    drop = _largest_drop(loaded, x, followers)
    lowest = kept.pairs[0].value.real - drop
    followed = _followed(loaded, x, again, rows, count, lowest - SHIFT_MARGIN * (abs(lowest) + drop))
    return min(kept, followed, key=lambda found: (-found.negative, -found.zero, found.pairs[0].value.real))


def _followed(loaded: LoadedProblem, x: PETSc.Vec, K: PETSc.Mat, rows: Rows, count: int, shift: float) -> Spectrum:
    """Spectrum of the tangent whose water follows its outlets, from a shift below all of it."""
    available = K.getSize()[0]
    whole = augmented(K, None, loaded.borders(x, one_sided=True), rows)
    assert whole.M is not None
    number = count
    while True:
        pairs = eigenvalues.nearest(whole.K, whole.M, number, shift)
        if number == available or pairs[-1].value.real > 0:
            break
        number = min(2 * number, available)
    whole.free()
    values = np.array([pair.value for pair in pairs])
    return Spectrum(pairs[:count], int((values.real < 0).sum()), int((values == 0).sum()))


def _largest_drop(loaded: LoadedProblem, x: PETSc.Vec, followers: int) -> float:
    """Largest distance of the spectrum with water that follows below that with kept volumes [N/m].

    The tangents differ by v w^T for each follower, v the border and w = v / C less the row over its own C. The
    symmetric part of -v w^T has the lowest eigenvalue -(v . w + |v| |w|) / 2. No real part is below the lowest
    eigenvalue of the symmetric part (Bendixson).
    """
    kept, followed = loaded.borders(x), loaded.borders(x, one_sided=True)
    drop = 0.0
    for place in range(-followers, 0):
        border, row = kept.vectors[place], followed.rows[place]
        row.axpby(1 / kept.compliances[place], -1 / followed.compliances[place], border)
        drop += (float(border.dot(row)) + float(border.norm() * row.norm())) / 2
    for borders in (kept, followed):
        borders.free()
    return drop
