"""Remainders of the residual: their order shows if the tangent is consistent."""

import numpy as np


def remainders(problem, x, d, steps):
    """Norms of R(x + h d) - R(x) - h K d."""
    R, Kd, r = (x.duplicate() for _ in range(3))
    A = problem.discretization.create_matrix()
    problem.residual(x, R)
    problem.tangent(x, A)
    A.mult(d, Kd)
    norms = []
    for h in steps:
        y = x.copy()
        y.axpy(h, d)
        problem.residual(y, r)
        r.axpy(-1.0, R)
        r.axpy(-h, Kd)
        norms.append(r.norm())
    return np.array(norms)
