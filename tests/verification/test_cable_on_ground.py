"""Cable that lies on the ground and rises to a support: contact with a plane as an energy term, by a penalty.

Reference: exact solution of cable and penalty. q is the weight per reference length X, k the penalty, z the height
above the ground. The horizontal force H is constant; with the vertical one V, N = sqrt(H^2 + V^2) and the stretch
lambda(N) of N = (N0 + EA (lambda^2 - 1) / 2) lambda,

    dx/dX = lambda H / N,   dz/dX = lambda V / N,   dV/dX = q + k min(z, 0).

Far from the support the cable lies at z = -q / k. There and above the ground

    int_H^N lambda dN = (q + k z)^2 / (2 k) for z < 0,   int_N0^N lambda dN = q z for z > 0.

They give V at z = 0 and at the support, and so the reference length between, over q. On the ground quadrature over z,
with dX = dz N / (lambda V), gives the horizontal length by which the bent cable is shorter than a straight one under H.
The given place of the support fixes H.
Claim: both forces at the support, and that of the ground, converge with second order; forces and moments balance to
1e-10 of the loads.
Tolerance: orders: the end of the contact lies at another place of an element on each mesh, which changes the error by
some per cent where the quadrature is fine: 0.03. The length on the ground is 16 times the decay length sqrt(H / k):
1e-7, which is the tolerance of the extrapolated forces, too.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from fx_membrane import Analysis, Cable, DistributedLoad, PrescribedDisplacement, Stage, Structure, Support, polyline
from own_terms import Ground

SOURCE = "cable on a penalty: quadrature of the exact solution"

L, EA, N0, Q, K, SPAN, HEIGHT = 12.0, 2e5, 500.0, 40.0, 4e3, 11.6, 2.0


def stretch(N):
    return brentq(lambda s: (N0 + EA * (s**2 - 1) / 2) * s - N, 0.9, 1.5, xtol=1e-15)


def work(low, high):
    """Integral of lambda dN."""
    return quad(stretch, low, high, epsabs=0, epsrel=1e-12)[0]


def exact():
    """Horizontal and vertical force at the support, and force of the ground."""

    def vertical(H):
        start = brentq(lambda N: work(H, N) - Q**2 / (2 * K), H, 2 * H, xtol=1e-12)
        end = brentq(lambda N: work(start, N) - Q * HEIGHT, start, 10 * H, xtol=1e-12)
        return np.sqrt(start**2 - H**2), np.sqrt(end**2 - H**2)

    def too_long(H):
        V0, V1 = vertical(H)

        def shortening(z):
            N = brentq(lambda N: work(H, N) - (Q + K * z) ** 2 / (2 * K), H, 2 * H, xtol=1e-13)
            return (stretch(H) * N / H / stretch(N) - 1) * H / np.sqrt(max(N**2 - H**2, 1e-300))

        def along(V):
            N = np.hypot(H, V)
            return stretch(N) * H / N / Q

        on_ground = stretch(H) * (L - (V1 - V0) / Q) - quad(shortening, -Q / K * (1 - 1e-6), 0, epsrel=1e-8)[0]
        return on_ground + quad(along, V0, V1, epsabs=0, epsrel=1e-12)[0] - SPAN

    H = brentq(too_long, 100, 2000, xtol=1e-9)
    V1 = vertical(H)[1]
    return H, V1, Q * L - V1


@pytest.fixture(scope="module")
def states():
    found = []
    for n in (240, 480, 960):
        points = np.linspace(0, L, n + 1)[:, None] * np.array([1.0, 0, 0])
        supports = [Support(0, "xy"), Support(range(n + 1), "y")]
        ground = Ground("cable", K, 0.0, quadrature_degree=25)
        structure = Structure(points, {"cable": Cable(polyline(range(n + 1)), EA, N0)}, supports, terms=[ground])
        lift = PrescribedDisplacement(n, (SPAN - L, 0, HEIGHT))
        stage = Stage("lift", [DistributedLoad((0, 0, -Q), "cable")], [lift], increments=4)
        found.append(Analysis(structure).run([stage])["lift"])
    return found


def test_second_order(states, verified):
    found = [[*state.reactions[-1, [0, 2]], state.terms[0].forces[:, 2].sum()] for state in states]
    # The share of the weight of the last half element is in the reaction, as a load on a held node is.
    names = ["horizontal force [N]", "vertical force [N]", "force of the ground [N]"]
    for name, values, expected in zip(names, np.transpose(found), exact(), strict=True):
        error = values / expected - 1
        np.testing.assert_allclose(np.log2(error[:-1] / error[1:]), 2, rtol=0, atol=0.03)
        assert (4 * values[2] - values[1]) / 3 == pytest.approx(expected, rel=1e-7)
        verified(name, expected, values[2], np.log2(error[1] / error[2]))


def test_balance(states):
    for state in states:
        balance = state.equilibrium
        np.testing.assert_allclose(balance.loads + balance.reactions, 0, rtol=0, atol=1e-10 * Q * L)
        np.testing.assert_allclose(balance.load_moment + balance.reaction_moment, 0, rtol=0, atol=1e-10 * Q * L * L)
        assert balance.residual < 1e-10 * Q * L
        lying = state.position[:, 2] < 0
        assert (state.terms[0].forces[lying, 2][1:-1] > 0).all()
        assert not state.remarks
