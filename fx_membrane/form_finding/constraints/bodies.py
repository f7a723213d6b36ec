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

from .motions import Body, carried

Array = NDArray[np.float64]

# Ranges: tests/benchmarks/form_finding_constants.py, on 24 rings and rigid bodies, near and from afar: with a tenth of
# each forms move by less than 1e-9 of their size.
# Accepted error of a constraint and unbalanced force, over the squared size and the largest force.
ACCEPTED_ERROR = 1e-14
STAGNANT_ERROR = 1e-11  # the same, where it falls no more
REPEATS = 30  # maximum number of Newton's steps; 3 leave 1e-11 of the size
NEWTON_SLOPE = 1e-8  # slope of the energy from which Newton's method goes on
MAX_DESCENT_STEPS = 500  # maximum number of steps downhill; 50 do
START_DISTANCE = 1e-3  # distance from the start, over the size
UNSTABLE = -1e-9  # curvature over the largest, below which a balance is no minimum
# The same, below which a direction counts as neutral: as masts that turn together about an axis.
NEUTRAL_CURVATURE = 1e-9


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
        others = ", or another constraint that keeps nodes together," if len(bodies) > 1 else ""
        radius = "give another radius, or " if any(body.radius_given for body in bodies) else ""
        raise RuntimeError(
            f"{bodies[0].label}{others} finds no balance that keeps its shape under its supports: {radius}take "
            "supports from its nodes, or start it nearer to its place in the form."
        )
    return found


def tangents(body: Body, points: Array, forces: Array | None = None) -> tuple[Array, Array]:
    """Motions that keep a body in shape where it is, and how forces on its nodes turn against them.

    Args:
        body: The body.
        points: A shape in which it has its form, shape (n, 3) [m].
        forces: Forces on all nodes, shape (n, 3) [N]; none if not given.

    Returns:
        Orthonormal columns, shape (3 k, m), and the derivatives of the work of the forces on each along each, (m, m).
    """
    equations, s = _Equations([body]), body.unknowns(points)
    gradients, all_ways = equations.gradients(s), carried(body.coordinates) @ body.ways
    free = null_space(gradients / equations.size)
    columns, scale = np.linalg.qr(all_ways @ free)
    if forces is None:
        return columns, np.zeros((columns.shape[1], columns.shape[1]))
    push = all_ways.T @ forces[body.nodes].ravel()
    multipliers = np.linalg.lstsq(gradients.T, push, rcond=None)[0]
    bent = -free.T @ np.tensordot(multipliers, equations.curvatures, axes=1) @ free
    inverse = np.linalg.inv(scale)
    return columns, inverse.T @ bent @ inverse


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
    aside = start / size + START_DISTANCE * np.cos(np.arange(len(start)))  # off a balance that is no minimum
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # of constraints that contradict each other, told by the caller
        found = minimize(
            lambda z: (z - goal) @ scaled @ (z - goal) / 2,
            aside,
            jac=lambda z: scaled @ (z - goal),
            hess=lambda z: scaled,
            method="trust-constr",
            constraints=kept,
            options={"gtol": NEWTON_SLOPE, "maxiter": MAX_DESCENT_STEPS},
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
    s, size, largest = start, equations.size, np.abs(stiffness).max()
    multipliers = np.linalg.lstsq(equations.gradients(s).T, stiffness @ (s - loose), rcond=None)[0]
    last = np.inf
    for _ in range(REPEATS):
        gradients = equations.gradients(s)
        force = gradients.T @ multipliers
        unbalanced = (stiffness @ (s - loose) - force) / (largest * size)
        values = equations.values(s) / size**2
        error = max(np.abs(values).max(), np.abs(unbalanced).max())
        curvature = stiffness - np.tensordot(multipliers, equations.curvatures, axes=1)
        if error <= ACCEPTED_ERROR or (error <= STAGNANT_ERROR and error > last / 2):
            free = null_space(gradients)
            least = np.linalg.eigvalsh(free.T @ curvature @ free).min(initial=0.0)
            return (s, force) if least >= UNSTABLE * largest else None
        last = error
        zero = np.zeros((len(values), len(values)))
        system = np.block([[curvature / largest, -gradients.T / size], [gradients / size, zero]])
        step = np.linalg.lstsq(system, -np.concatenate([unbalanced, values]), rcond=NEUTRAL_CURVATURE)[0]
        s, multipliers = s + size * step[: len(s)], multipliers + largest * step[len(s) :]
        if not np.abs(s).max() < 1 / np.finfo(float).eps * size:
            return None
    return None
