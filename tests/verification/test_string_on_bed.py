"""Taut string and strip on an elastic bed under a small even load.

Reference: N w'' - k w = q with w = 0 at both ends (Winkler's bed under a string),

    w = -q / k (1 - cosh(a x) / cosh(a L / 2)),   a = sqrt(k / N).

On elements of the length h, cosh(a h) is replaced exactly by c = (2 N / h + 2 k h / 3) / (2 N / h - k h / 3): insert
w = cosh(i acosh(c)) in the balance of node i.
Claim: the discrete shape of the string to the last digits; second order of string and strip to the closed form; the
forces of bed and ends balance the load. The frequencies with the bed are those of the string alone, f, raised to
sqrt(f^2 + k / (4 pi^2 m)).
Tolerance: the load is so small that the force grows by E A / N (q L / N)^2 < 1e-12. The displacement is small, 1e-8 of
the length, beside the rounding of positions, 1e-16: 1e-7. Orders: the next term of the error is (a h)^2 / 10 of the
first: 0.01.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    natural_frequencies,
    rectangle,
)
from own_terms import ElasticBed

SOURCE = "string on Winkler's bed"

L, N, EA, K, Q, MASS = 6.0, 2e3, 2e4, 3e3, 1e-4, 0.4


def closed(x):
    a = np.sqrt(K / N)
    return -Q / K * (1 - np.cosh(a * x) / np.cosh(a * L / 2))


def string(n, terms=()):
    points = np.zeros((n + 1, 3))
    points[:, 0] = np.linspace(-L / 2, L / 2, n + 1)
    cells = np.stack([np.arange(n), np.arange(1, n + 1)], axis=1)
    parts = {"string": Cable(cells, EA, N, mass=MASS)}
    return Structure(points, parts, [Support([0, n]), Support(range(n + 1), "y")], terms=terms)


def strip(n, terms=()):
    points, triangles = rectangle(L, L / 12, n, n // 12)
    ends = np.flatnonzero(np.abs(np.abs(points[:, 0]) - L / 2) < 1e-9)
    parts = {"string": Membrane(triangles, Fabric(EA, 0.3), N)}
    return Structure(points, parts, [Support(ends), Support(range(len(points)), "y")], terms=terms)


def loaded(structure, *more):
    return Analysis(structure).run([Stage("load", [DistributedLoad((0, 0, -Q), "string"), *more])])["load"]


@pytest.mark.mpi_once
@pytest.mark.parametrize("standing", [True, False])
def test_discrete_shape_of_the_string(standing):
    n, bed = 24, ElasticBed("string", K)
    state = loaded(string(n, [bed])) if standing else loaded(string(n), bed)
    h = L / n
    c = (2 * N / h + 2 * K * h / 3) / (2 * N / h - K * h / 3)
    i = np.arange(n + 1) - n / 2
    expected = -Q / K * (1 - np.cosh(i * np.arccosh(c)) / np.cosh(n / 2 * np.arccosh(c)))
    np.testing.assert_allclose(state.displacement[:, 2], expected, rtol=0, atol=1e-7 * Q / K)
    (term,) = state.terms
    carried = -K * h * expected[1:-1].sum()
    assert term.forces[:, 2].sum() == pytest.approx(carried, rel=1e-7)
    assert state.reactions[:, 2].sum() == pytest.approx(Q * L - carried, rel=1e-6)
    assert not state.remarks


@pytest.mark.parametrize("make", [string, strip])
def test_second_order(make, verified):
    error = []
    for n in (24, 48, 96):
        structure = make(n, [ElasticBed("string", K)])
        w = loaded(structure).displacement[:, 2]
        error.append(np.abs(w - closed(structure.points[:, 0])).max() * K / Q)
    np.testing.assert_allclose(np.log2(np.divide(error[:-1], error[1:])), 2, rtol=0, atol=0.03)
    assert error[-1] < 1e-3
    verified("deflection times k / q, largest difference", 0.0, error[-1], np.log2(error[-2] / error[-1]))


def test_frequencies():
    alone, on_bed = (
        natural_frequencies(Analysis(string(24, terms)).run([Stage("rest")])["rest"], 2).frequencies
        for terms in ((), [ElasticBed("string", K)])
    )
    np.testing.assert_allclose(on_bed, np.sqrt(alone**2 + K / (4 * np.pi**2 * MASS)), rtol=1e-11)
