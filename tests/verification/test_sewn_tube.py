"""Tube cut into strips, compensated by its law, sewn together and pressed: it has the designed shape and stress.

Reference: closed form. A tube of radius R under the pressure p carries p R around, and n along, held at its ends. Its
cloth is smaller by the stretches that belong to this stress by the law. Discrete: facets that touch the circle of
radius R from outside carry p R between them exactly; they unroll exactly.
Claim: strips cut, flattened, compensated and sewn together do not move; stretches and lengths of the cloth are exact.
Tolerance: rounding.
"""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import Newton, Pressure
from fx_membrane.patterns.compensated_cloth import cutting_pattern
from fx_membrane.patterns.proofs import prove_pattern
from gores import gores

SOURCE = "closed form, n = p R and the law of the cloth"
R, LENGTH, P = 5.0, 10.0, 400.0
AXIAL, HOOP = 1.0008078977, 1.0033824724


@pytest.mark.mpi_once
@pytest.mark.parametrize("count", [4, 1])
def test_sewn_tube_keeps_its_shape(count, verified):
    facets = 24
    corner = R / np.cos(np.pi / facets)
    shape = (lambda t: corner + 0 * t), (lambda t: LENGTH * t)
    tube = gores(*shape, count, facets // count, 5, prestress=(1e3, P * R), alternating=False)
    if count == 1:
        tube = cut_once(tube)
    pattern = cutting_pattern(tube)
    ratio = pattern.compensation["gore 1"]
    np.testing.assert_allclose(1 / ratio, [AXIAL, HOOP], atol=1e-10)
    around = sum(strip.width for strip in pattern.cloth.values())
    assert around / (2 * facets * R * np.tan(np.pi / facets)) * 2 * np.pi * R == pytest.approx(31.3100212544, abs=1e-9)
    assert pattern.cloth["gore 1"].length == pytest.approx(9.9919275445, abs=1e-9)
    proof = prove_pattern(
        pattern, [Pressure(P, name) for name in tube.names], solver=Newton(rtol=1e-13), progress=False
    )
    assert proof.shift.max() < 1e-10
    assert proof.stress_error < 1e-8
    assert proof.seam_difference < 1e-12
    assert all(strip.widest == np.inf for strip in proof.strips.values())
    verified("shift from the design", 0.0, proof.shift.max() / R)
    verified("stretch along", AXIAL, 1 / ratio[0])
    verified("stretch around", HOOP, 1 / ratio[1])
    verified("stress around", P * R, proof.strips["gore 1"].found[:, 1].max())


def cut_once(tube):
    """Take the tube as one strip whose seam is on two of its sides."""
    edges = [replace(edge, strips=("gore 1",) * 2) if "seam" in edge.name else edge for edge in tube.edges]
    return replace(tube, edges=tuple(edges))
