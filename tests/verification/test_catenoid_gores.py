"""Catenoid of gores cut by least energy and sewn together: shift and stress beside the design, a soap film.

Reference: a computation of the same gores with other software, quarter gores of 6 x 24 and 12 x 48 cells by symmetry
(shift 5.996 and 5.639 mm, stress from 2849.8 to 6521 and from 2852.5 to 6574 N/m); in the limit of small cells a
flattening energy of 669.9 J and a mean stress of 4019.07 N/m. Leading order at the waist, from the strip in one
dimension: 4000 + Eh pi^2 / (3 N^2) at seams, 4000 - Eh pi^2 / (6 N^2) between them.
Discrete: a quarter of the roof, all gores whole, between planes of symmetry.
Claim: these numbers; in the number of gores N, order 2 of the stress and order 4 of the shift.
"""

import numpy as np
import pytest

from fx_membrane.patterns.compensated_cloth import cutting_pattern
from fx_membrane.patterns.proofs import prove_pattern
from gores import catenoid

SOURCE = "computation with other software; strip in one dimension"
DESIGN, EH = 4e3, 5e5


def proved(count, across, along):
    """Proof, flattening energy of all gores [J], least, mean and largest principal stress [N/m]."""
    strips = catenoid(count, across, along, quarter=True)
    proof = prove_pattern(cutting_pattern(strips), progress=False)
    stress = np.concatenate([proof.state.membrane(name).principal for name in strips.names])
    area = np.concatenate([strip.area for strip in proof.strips.values()])
    mean = np.average(stress.mean(axis=1), weights=area)
    return proof, 4 * proof.pattern.energy, np.array([stress.min(), mean, stress.max()])


def test_numbers_of_24_gores(verified):
    proof, energy, stress = proved(24, 12, 48)
    assert 1e3 * proof.shift.max() == pytest.approx(5.996, abs=6e-4)
    assert stress[0] == pytest.approx(2849.8, abs=0.06)
    assert stress[2] == pytest.approx(6521, abs=0.6)
    _, coarse, coarse_stress = proved(24, 6, 24)
    limits = energy + (energy - coarse) / 3, stress[1] + (stress[1] - coarse_stress[1]) / 3
    assert limits == pytest.approx((669.9, 4019.07), rel=5e-3)
    assert proof.seam_difference < 1e-12
    verified("largest shift [mm]", 5.996, 1e3 * proof.shift.max())
    verified("least stress [N/m]", 2849.8, stress[0])
    verified("largest stress [N/m]", 6521, stress[2])


def test_orders_in_the_number_of_gores(verified):
    counts = (32, 64)
    shifts, stresses = [], []
    for count in counts:
        proof, _, stress = proved(count, 4, count)
        shifts.append(proof.shift.max())
        stresses.append(np.abs(stress - DESIGN)[[0, 2]])
    order = np.log2(shifts[0] / shifts[1])
    assert 3.7 < order < 4.1
    orders = np.log2(np.divide(*stresses))
    assert ((orders > 1.8) & (orders < 2.1)).all()
    leading = EH * np.pi**2 / 3 / counts[1] ** 2
    assert stresses[1] == pytest.approx([leading / 2, leading], rel=0.15)
