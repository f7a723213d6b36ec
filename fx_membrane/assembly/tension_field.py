"""Wrinkle strains of many cells at once, for any law: the strain b >= 0 of least energy w(E + b).

Strains are vectors of the components 11, 22, 12 in membranes, 11 in bars; g and D are the first and second derivatives
of the energy by them. `forms.tension_field` has the energy that b belongs to.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..forms.wrinkling import SLACK, TAUT, WRINKLED

Array = NDArray[np.float64]

# Gradient and Hessian of the energy of given cells at given strains, (n,), (n, c) -> (n, c), (n, c, c).
Derivatives = Callable[[NDArray[np.int64], Array], tuple[Array, Array]]


@dataclass(frozen=True)
class WrinkleSearch:
    """Constants of Newton's method for wrinkle strains; those of rounding follow from 2.2e-16, the rounding of numbers.

    Attributes:
        steps: Maximum number of Newton steps.
        halvings: Maximum number of halvings of a step.
        rounding: Stress across a wrinkle that is rounding, relative to the tension.
        unit: The same, relative to the stiffness.
        rest: Distance from the strain without stress that is rounding [-].
        accepted: Multiple of that rounding that is accepted where no step brings it down.
        turn: Largest turn of the tension in a step [rad].
    """

    steps: int = 60
    halvings: int = 30
    rounding: float = 1e-13
    unit: float = 1e-16
    rest: float = 1e-15
    accepted: float = 1e5
    turn: float = 0.3


SEARCH = WrinkleSearch()


class Wrinkles(NamedTuple):
    """Wrinkles of cells.

    Attributes:
        strain: Wrinkle strain b, shape (n, c) [-]; not a number where none was found.
        compliance: Change of -b with the gradient g, shape (n, c, c) [m/N or 1/N].
        state: TAUT, WRINKLED or SLACK, shape (n,).
    """

    strain: Array
    compliance: Array
    state: Array


def natural_strains(derivatives: Derivatives, count: int, size: int) -> Array:
    """Strain without stress of each cell, shape (n, c); not a number where Newton's method finds none."""
    cells, e = np.arange(count), np.zeros((count, size))
    g, D = derivatives(cells, e)
    first = _norm(g)
    for _ in range(SEARCH.steps):
        left = np.flatnonzero(_norm(g) > SEARCH.rounding * first)
        if not len(left):
            return e
        step = -_solved(D[left], g[left])
        e[left], g[left], D[left] = _shortened(derivatives, left, e[left], step, g[left])
    e[~(_norm(g) <= 1e-9 * first)] = np.nan
    return e


def wrinkles(derivatives: Derivatives, E: Array, natural: Array) -> Wrinkles:
    """Find the wrinkles of cells at strains E, shape (n, c), with the strains without stress, shape (n, c).

    Cells at the strain without stress are taut, as by the formulas of `forms.wrinkling`: they resist both ways.
    """
    count, size = E.shape
    every = np.arange(count)
    g, _ = derivatives(every, E)
    found = Wrinkles(np.zeros((count, size)), np.zeros((count, size, size)), np.full(count, float(TAUT)))
    at_rest = _norm(E - natural) <= SEARCH.rest + SEARCH.rounding * _norm(natural)
    slack = np.flatnonzero((_largest(E - natural) <= 0) & ~at_rest)
    pressed = g[:, 0] < 0 if size == 1 else (g[:, 0] + g[:, 1] < 0) | (4 * g[:, 0] * g[:, 1] < g[:, 2] ** 2)
    pressed[at_rest] = pressed[slack] = False
    found.state[slack] = SLACK
    found.strain[slack] = (natural - E)[slack]
    found.compliance[slack] = np.linalg.pinv(derivatives(slack, natural[slack])[1], hermitian=True)
    wrinkled = np.flatnonzero(pressed)
    if size > 1 and len(wrinkled):
        b, K = _across_tension(derivatives, wrinkled, E[wrinkled], natural[wrinkled])
        found.strain[wrinkled], found.compliance[wrinkled], found.state[wrinkled] = b, K, WRINKLED
    return found


def _across_tension(
    derivatives: Derivatives, cells: NDArray[np.int64], E: Array, natural: Array
) -> tuple[Array, Array]:
    """Wrinkle strain beta n n that leaves no stress across t, and its compliance.

    Newton's method for beta and the angle of t, from the direction of the largest strain; beta stays above zero.
    """
    angle, beta = _direction(E - np.nan_to_num(natural)), np.zeros(len(E))
    g, D = derivatives(cells, E)
    left = np.arange(len(E))
    for _ in range(SEARCH.steps):
        r, J = _residual(g[left], D[left], angle[left], beta[left])
        more = _norm(r) > _rounding(g[left], D[left])
        left, r, J = left[more], r[more], J[more]
        if not len(left):
            break
        step = -_solved(J, r)
        step *= np.minimum(1.0, SEARCH.turn / np.maximum(np.abs(step[:, 1]), SEARCH.turn))[:, None]
        before, length, todo = _norm(r), np.ones(len(left)), np.arange(len(left))
        for _ in range(SEARCH.halvings):
            some, tried = left[todo], length[todo, None] * step[todo]
            tried_beta, tried_angle = np.maximum(beta[some] + tried[:, 0], 0.0), angle[some] + tried[:, 1]
            found = derivatives(cells[some], E[some] + tried_beta[:, None] * _dyads(tried_angle)[0])
            better = _norm(_residual(*found, tried_angle, tried_beta)[0]) < before[todo]
            taken = some[better]
            beta[taken], angle[taken] = tried_beta[better], tried_angle[better]
            g[taken], D[taken] = found[0][better], found[1][better]
            todo = todo[~better]
            if not len(todo):
                break
            length[todo] /= 2
        left = np.delete(left, todo)  # where no step is better
    r, J = _residual(g, D, angle, beta)
    b = beta[:, None] * _dyads(angle)[0]
    b[~(_norm(r) <= SEARCH.accepted * _rounding(g, D))] = np.nan
    a, a1, _ = _dyads(angle)
    B, R = np.stack([a, beta[:, None] * a1], axis=2), np.stack([a, a1], axis=1)
    J[~np.isfinite(b).all(axis=1)] = 0.0  # none found: the energy is no number, and the step is refused
    return b, B @ np.linalg.pinv(J) @ R


def _residual(g: Array, D: Array, angle: Array, beta: Array) -> tuple[Array, Array]:
    """Stress across the tension, normal and shear, shape (n, 2), and its derivative by beta and the angle."""
    a, a1, a2 = _dyads(angle)
    Da, Da1 = np.einsum("nij,nj->ni", D, a), np.einsum("nij,nj->ni", D, a1)
    shear = _dot(g, a1)
    J = np.empty((len(g), 2, 2))
    J[:, 0, 0], J[:, 0, 1] = _dot(a, Da), shear + beta * _dot(a, Da1)
    J[:, 1, 0], J[:, 1, 1] = _dot(a1, Da), _dot(g, a2) + beta * _dot(a1, Da1)
    return np.stack([_dot(g, a), shear], axis=1), J


def _rounding(g: Array, D: Array) -> Array:
    return np.asarray(SEARCH.rounding * _norm(g) + SEARCH.unit * np.abs(D).max(axis=(1, 2)))


def _dyads(angle: Array) -> tuple[Array, Array, Array]:
    """Components of n n for n across the direction at an angle, and their derivatives, (n, 3) each."""
    c, s = np.cos(2 * angle), np.sin(2 * angle)
    a = np.stack([(1 - c) / 2, (1 + c) / 2, -s / 2], axis=1)
    return a, np.stack([s, -s, -c], axis=1), 2 * np.stack([c, -c, s], axis=1)


def _direction(e: Array) -> Array:
    """Angle of the largest principal strain."""
    return np.asarray(np.arctan2(2 * e[:, 2], e[:, 0] - e[:, 1]) / 2)


def _largest(e: Array) -> Array:
    """Largest principal strain."""
    if e.shape[1] == 1:
        return e[:, 0]
    return np.asarray((e[:, 0] + e[:, 1]) / 2 + np.hypot((e[:, 0] - e[:, 1]) / 2, e[:, 2]))


def _shortened(
    derivatives: Derivatives, cells: NDArray[np.int64], e: Array, step: Array, g: Array
) -> tuple[Array, Array, Array]:
    """Shorten steps until the shape is possible and the stress falls; return strains and derivatives there."""
    length, before = np.ones(len(e)), _norm(g)
    for _ in range(SEARCH.halvings):
        trial = e + length[:, None] * step
        found = derivatives(cells, trial)
        worse = ~((_norm(found[0]) < before) & (_largest(-trial) < 0.5))
        if not worse.any():
            break
        length[worse] /= 2
    return trial, *found


def _solved(A: Array, b: Array) -> Array:
    """Solution of A x = b for many small systems; of least norm where one is singular or not finite."""
    try:
        return np.asarray(np.linalg.solve(A, b[:, :, None])[:, :, 0])
    except np.linalg.LinAlgError:
        return np.asarray((np.linalg.pinv(np.nan_to_num(A)) @ b[:, :, None])[:, :, 0])


def _dot(a: Array, b: Array) -> Array:
    return np.asarray(np.einsum("ni,ni->n", a, b))


def _norm(a: Array) -> Array:
    return np.asarray(np.linalg.norm(a, axis=1))
