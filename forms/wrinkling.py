"""Relaxed energies: membranes that wrinkle and cables that go slack under compression.

With the total elastic strain e = E + C^-1 : sigma0, the relaxed energy is the least over all wrinkle strains b >= 0,

    w(e) = min (e + b) : C : (e + b) / 2 = max { S : e - S : C^-1 : S / 2  over stresses S >= 0 },

Pipkin's tension field. It is convex, and its derivative is continuous. There are three states. Taut: the stress C : e
has no compression, the energy is that of `elasticity.strain_energy`. Slack: e has no extension, no energy. Wrinkled:
tension s = e_tt / H_tt along one direction t only, with H_tt the compliance along t. The direction t has the largest
energy e_tt^2 / (2 H_tt). In an isotropic membrane t is the principal direction and the energy Et e1^2 / 2.

Energies are counted from E = 0, as in Gil (40): w(e) - sigma0 : C^-1 : sigma0 / 2. The derivative of a `conditional` is
the consistent tangent. The taut branch is written in E, not in principal strains: their square root has no derivative
at equal values.

Source: A. C. Pipkin, IMA J. Appl. Math. 36 (1986) 85-99; D. J. Steigmann, Proc. R. Soc. Lond. A 429 (1990) 141-173.
"""

from __future__ import annotations

from typing import NamedTuple

from ufl import And, Identity, conditional, cos, det, diff, ge, gt, inner, sin, sqrt, tr, variable
from ufl.core.expr import Expr

from . import elasticity

TAUT, WRINKLED, SLACK = 0, 1, 2


class Relaxed(NamedTuple):
    """Relaxed energy and its state.

    Attributes:
        energy: Per prestressed area or length, a scalar [J/m2 or J/m].
        state: TAUT, WRINKLED or SLACK, a scalar [-].
    """

    energy: Expr
    state: Expr


def isotropic(E: Expr, sigma0: Expr, Et: Expr, nu: Expr) -> Relaxed:
    """Relaxed energy of an isotropic membrane.

    Args:
        E: Green-Lagrange strain in any tangent frame, shape (2, 2) [-].
        sigma0: Cauchy prestress in that frame, shape (2, 2) [N/m].
        Et: Young's modulus times thickness [N/m].
        nu: Poisson's ratio [-].
    """
    e0 = elasticity.isotropic_compliance(sigma0, Et, nu)
    e = E + e0
    e1, e2 = _principal(e)
    taut = ge(e2 + nu * e1, 0)
    full = elasticity.strain_energy(E, sigma0, elasticity.isotropic(E, Et, nu))
    return _relaxed(full, Et * e1**2 / 2, inner(sigma0, e0) / 2, taut, gt(e1, 0))


def orthotropic(E: Expr, sigma0: Expr, Et_warp: Expr, Et_weft: Expr, nu: Expr, Gt: Expr, angle: Expr) -> Relaxed:
    """Relaxed energy of a woven fabric.

    The direction t that maximizes e_tt^2 / (2 H_tt) has no closed form. The caller solves for it at the current strain,
    as by `fx_membrane.tension_direction`.
    One Newton step in the formula itself lets t follow the strain, so that the second derivative is exact.

    Args:
        E: Green-Lagrange strain in the warp/weft frame, shape (2, 2) [-].
        sigma0: Cauchy prestress in the warp/weft frame, shape (2, 2) [N/m].
        Et_warp, Et_weft: Modulus times thickness [N/m].
        nu: Poisson's ratio, the contraction of the weft under tension in the warp [-].
        Gt: Shear modulus times thickness [N/m].
        angle: From the warp to t at the current strain, where wrinkled [rad].
    """
    e0 = elasticity.orthotropic_compliance(sigma0, Et_warp, Et_weft, nu, Gt)
    e = E + e0

    def tension(angle: Expr) -> Expr:
        c, s = cos(angle), sin(angle)
        e_tt = c**2 * e[0, 0] + s**2 * e[1, 1] + c * s * (e[0, 1] + e[1, 0])
        H_tt = c**4 / Et_warp + s**4 / Et_weft + c**2 * s**2 * (1 / Gt - 2 * nu / Et_warp)
        return e_tt**2 / (2 * H_tt)

    start = variable(angle)
    slope = diff(tension(start), start)
    CE = elasticity.orthotropic(E, Et_warp, Et_weft, nu, Gt)
    S = sigma0 + CE
    full = elasticity.strain_energy(E, sigma0, CE)
    taut = And(ge(det(S), 0), ge(tr(S), 0))
    return _relaxed(
        full, tension(start - slope / diff(slope, start)), inner(sigma0, e0) / 2, taut, gt(_principal(e)[0], 0)
    )


def cable(E: Expr, sigma0: Expr, EA: Expr) -> Relaxed:
    """Relaxed energy of a cable, which is taut or slack.

    Args:
        E: Green-Lagrange strain, shape (1, 1) [-].
        sigma0: Prestress, shape (1, 1) [N].
        EA: Young's modulus times cross-section [N].
    """
    full = elasticity.strain_energy(E, sigma0, elasticity.axial(E, EA))
    taut = ge(sigma0[0, 0] + EA * E[0, 0], 0)
    stored = inner(sigma0, sigma0) / (2 * EA)
    return Relaxed(conditional(taut, full, -stored), conditional(taut, TAUT, SLACK))


def blend(relaxed: Expr, full: Expr, eta: Expr) -> Expr:
    """Relaxed energy with a fraction eta of the full one: that keeps slack nodes in place [J/m2 or J/m]."""
    return (1 - eta) * relaxed + eta * full


def _relaxed(full: Expr, wrinkled: Expr, stored: Expr, taut: Expr, extended: Expr) -> Relaxed:
    energy = conditional(taut, full, conditional(extended, wrinkled, 0.0) - stored)
    return Relaxed(energy, conditional(taut, TAUT, conditional(extended, WRINKLED, SLACK)))


def _principal(e: Expr) -> tuple[Expr, Expr]:
    """Principal values, the larger first."""
    mean = tr(e) / 2
    deviator = e - mean * Identity(2)
    radius = sqrt(inner(deviator, deviator) / 2)
    return mean + radius, mean - radius
