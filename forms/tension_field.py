"""Relaxed energy of any law, from the wrinkle strain that the caller finds in each cell.

The relaxed energy is the least over all wrinkle strains b >= 0 of the energy w(E + b), as in `wrinkling`. Taut: b = 0.
Slack: E + b is the strain without stress. Wrinkled: b is across the tension t, and the stress S(E + b) has no component
across. Where the stress does no work on changes of b, the first derivative is S(E + b). The second follows from the
change of b with E: with the strain as a vector, the gradient g and the Hessian D of w, it is D - D K D. K is the
compliance of the wrinkles. Both b and K are constants here, so that one term of the energy yields the second
derivative:

    w(E + b) - g . K g / 2,    where K g = 0.

Source: A. C. Pipkin, IMA J. Appl. Math. 36 (1986) 85-99; D. J. Steigmann, Proc. R. Soc. Lond. A 429 (1990) 141-173.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

from ufl import as_matrix, as_vector, diff, variable
from ufl.core.expr import Expr


def components(a: Expr) -> list[Expr]:
    """Independent components of a symmetric tensor: 11, 22, 12 in membranes, 11 in bars."""
    return [a[0, 0]] if a.ufl_shape == (1, 1) else [a[0, 0], a[1, 1], (a[0, 1] + a[1, 0]) / 2]


def tensor(v: Expr) -> Expr:
    """Symmetric tensor of its components, a vector of size 3 (d = 2) or 1 (d = 1)."""
    return as_matrix([[v[0]]]) if len(v) == 1 else as_matrix([[v[0], v[2]], [v[2], v[1]]])


def gradient(w: Expr, E: Expr) -> Expr:
    """First derivatives of an energy by the components of the strain, a vector: S11, S22, 2 S12.

    Args:
        w: Strain energy, a scalar.
        E: Green-Lagrange strain, a `ufl.variable`, shape (d, d).
    """
    S = components(diff(w, E))
    return as_vector([*S[:2], 2 * S[2]] if len(S) == 3 else S)


def relaxed_energy(energy: Callable[[Expr], Expr], E: Expr, b: Expr, K: Expr) -> Expr:
    """Relaxed energy per reference area or length, a scalar [J/m2 or J/m].

    Args:
        energy: Strain energy as a function of the strain.
        E: Green-Lagrange strain, shape (d, d) [-].
        b: Components of the wrinkle strain at the current strain, a vector [-].
        K: Compliance of the wrinkles at the current strain, row by row, a vector [m/N or 1/N].
    """
    e = variable(E + tensor(b))
    w = energy(e)
    g, n = gradient(w, e), len(b)
    return w - sum(g[i] * K[n * i + j] * g[j] for i, j in product(range(n), repeat=2)) / 2
