"""Rings and rigid bodies in balance: the least energy over the places that keep them round, or rigid.

All other nodes eliminated, the energy is quadratic in origins and frames, and so are the constraints. A trust region
goes down to a minimum where that is far; Newton's method on the Lagrangian makes it exact.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.optimize import NonlinearConstraint, minimize

from .motions import Body

Array = NDArray[np.float64]

EXACT = 1e-14  # accepted error of a constraint and unbalanced force, over the squared size and the largest force
ROUNDING = 1e-11  # the same, where it falls no more
REPEATS = 30  # maximum number of Newton's steps
CLOSE = 1e-8  # slope of the energy from which Newton's method goes on
LONGEST = 500  # maximum number of steps downhill
ASIDE = 1e-3  # distance from the start, over the size
UNSTABLE = -1e-9  # curvature over the largest, below which a balance is no minimum


def settled(bodies: Sequence[Body], stiffness: Array, loose: Array, start: Array) -> tuple[Array, Array]:
    """Find the reduced unknowns of bodies in balance, and the forces of their constraints on them, both of shape (p,).

    Args:
        bodies: The bodies.
        stiffness: Stiffness of their reduced unknowns, all other nodes eliminated, shape (p, p) [N/m].
        loose: Unknowns without the constraints, shape (p,) [m].
        start: Unknowns to start from, shape (p,) [m].

    Raises:
        RuntimeError: No place keeps the constraints under the supports.
    """
    equations = _Equations(bodies)
    found = _newton(equations, stiffness, loose, start)
    if found is None:
        found = _newton(equations, stiffness, loose, _lowest(equations, stiffness, loose, start))
    if found is None:
        raise RuntimeError(
            f"{bodies[0].label}{', or another of them,' if len(bodies) > 1 else ''} finds no balance that keeps it in "
            "shape under its supports: give another radius, or fewer supports to its nodes."
        )
    return found


def _lowest(equations: _Equations, stiffness: Array, loose: Array, start: Array) -> Array:
    """Unknowns near a minimum of the energy, downhill from a start, shape (p,) [m]."""
    size, largest = equations.size, np.abs(stiffness).max()
    scaled, goal = stiffness / largest, loose / size
    kept = NonlinearConstraint(
        lambda z: equations.values(z * size) / size**2,
        0.0,
        0.0,
        jac=lambda z: equations.gradients(z * size) / size,
        hess=lambda z, v: np.tensordot(v, equations.curvatures, axes=1),
    )
    aside = start / size + ASIDE * np.cos(np.arange(len(start)))  # off a balance that is no minimum
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of constraints that contradict each other, told by the caller
        found = minimize(
            lambda z: (z - goal) @ scaled @ (z - goal) / 2,
            aside,
            jac=lambda z: scaled @ (z - goal),
            hess=lambda z: scaled,
            method="trust-constr",
            constraints=kept,
            options={"gtol": CLOSE, "maxiter": LONGEST},
        )
    return np.asarray(found.x * size)


class _Equations:
    """Constraints of all bodies, quadratic in their reduced unknowns."""

    def __init__(self, bodies: Sequence[Body]) -> None:
        self.size = max(float(np.linalg.norm(body.first[1])) for body in bodies)
        count = sum(body.ways.shape[1] for body in bodies)
        first = 0
        curvatures, slopes, offsets = [], [], []
        for body in bodies:
            rank = len(body.first) - 1
            here = slice(first, first + body.ways.shape[1])
            first = here.stop
            ways = body.ways.reshape(rank + 1, 3, -1)[1:]
            frame = body.first[1:]
            pairs = [(a, b) for a in range(rank) for b in range(a, rank)]
            products = {
                (a, b): (
                    ways[a].T @ ways[b] + ways[b].T @ ways[a],
                    ways[a].T @ frame[b] + ways[b].T @ frame[a],
                    frame[a] @ frame[b],
                )
                for a, b in pairs
            }
            if body.scale is None:
                equal = tuple(one - other for one, other in zip(products[0, 0], products[1, 1], strict=True))
                wanted = [(equal, 0.0), (products[0, 1], 0.0)]
            else:
                wanted = [(products[a, b], body.scale**2 * (a == b)) for a, b in pairs]
            for (curvature, slope, offset), value in wanted:
                curvatures.append(np.zeros((count, count)))
                curvatures[-1][here, here] = curvature
                slopes.append(np.zeros(count))
                slopes[-1][here] = slope
                offsets.append(offset - value)
        self.curvatures, self.slopes, self.offsets = np.array(curvatures), np.array(slopes), np.array(offsets)

    def values(self, s: Array) -> Array:
        """Return their values, zero where kept, shape (g,) [m2]."""
        return np.asarray((self.curvatures @ s) @ s / 2 + self.slopes @ s + self.offsets)

    def gradients(self, s: Array) -> Array:
        """Return their derivatives, shape (g, p) [m]."""
        return np.asarray(self.curvatures @ s + self.slopes)


def _newton(equations: _Equations, stiffness: Array, loose: Array, start: Array) -> tuple[Array, Array] | None:
    """Minimum near a start by Newton's method, and the forces of constraints; None where it finds none."""
    s = start
    multipliers = np.linalg.lstsq(equations.gradients(s).T, stiffness @ (s - loose), rcond=None)[0]
    last = np.inf
    for _ in range(REPEATS):
        gradients, values = equations.gradients(s), equations.values(s)
        force = gradients.T @ multipliers
        unbalanced = stiffness @ (s - loose) - force
        reference = np.abs(stiffness).max() * equations.size
        error = max(np.abs(values).max() / equations.size**2, np.abs(unbalanced).max() / reference)
        curvature = stiffness - np.tensordot(multipliers, equations.curvatures, axes=1)
        if error <= EXACT or (error <= ROUNDING and error > last / 2):
            free = null_space(gradients)
            least = np.linalg.eigvalsh(free.T @ curvature @ free).min(initial=0.0)
            return (s, force) if least >= UNSTABLE * np.abs(stiffness).max() else None
        last = error
        zero = np.zeros((len(values), len(values)))
        system = np.block([[curvature, -gradients.T], [gradients, zero]])
        step = np.linalg.lstsq(system, -np.concatenate([unbalanced, values]), rcond=None)[0]
        s, multipliers = s + step[: len(s)], multipliers + step[len(s) :]
        if not np.abs(s).max() < 1 / np.finfo(float).eps * equations.size:
            return None
    return None
