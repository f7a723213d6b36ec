"""Forces of masts and stays in the place of held nodes, against statics by hand.

Shear legs: a rope pulls the head along x with P. In its plane, the foot of the mast is back at the angle a from the
    vertical, and two stays, spread to both sides, meet the plane on average at the angle b. Balance along x and z gives
    N = -P cos b / sin(b - a) in the mast and T = P cos a / sin(b - a) in the plane, of which each stay has half, times
    its length over that of its projection on the plane.
Cable dome: on each of k radii a straight ridge cable passes the head of an upright strut, under the load W there. The
    strut stands on a diagonal from the outer node, which drops by d per length, and on a hoop. So the strut has -W, the
    diagonal W sqrt(1 + d^2) / d, and the hoop W / (2 d sin(pi / k)).
Reference: equilibrium of nodes; D. H. Geiger, A. Stefaniuk, D. Chen, The design and construction of two cable domes for
    the Korean Olympics, Proc. IASS Symposium, Osaka 1986, for the dome.
Claim: forces to rounding, in any orientation; no displacement in the analysis.
Tolerance: 1e-12 of the largest force, 1e-12 of the size.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    PointLoad,
    Stage,
    Structure,
    Support,
    masts_and_stays,
    updated_reference,
)
from models import rotation

SOURCE = "statics of nodes; D. H. Geiger et al. 1986"


def at_rest(form, loads=()):
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    return state.largest_displacement <= 1e-12 * form.structure.size


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", [None, 0, 1])
@pytest.mark.parametrize(("lean", "reach", "width"), [(0.0, 4.0, 2.0), (-1.0, 5.0, 1.0), (2.0, 6.0, 3.0)])
def test_shear_legs(lean, reach, width, seed, verified):
    turn = np.eye(3) if seed is None else rotation(seed)
    P, height = 3e3, 4.0
    rope = Cable([[0, 1]], 1e7, P)
    form = updated_reference(Structure([[0, 0, height], [8, 0, height]] @ turn.T, {"rope": rope}, [Support([0, 1])]))
    feet = np.array([(-lean, 0, 0), (-reach, width, 0), (-reach, -width, 0)]) @ turn.T
    bars = {"mast": Mast([[0, 2]], 1e8), "stays": Cable([[3, 0], [0, 4]], 1e7)}
    guyed = masts_and_stays(form, bars, feet, heads=0)
    a, b = np.arctan2([lean, reach], height)
    middle = np.hypot(reach, height)
    stay = P * np.cos(a) / np.sin(b - a) / 2 * np.hypot(middle, width) / middle
    assert guyed.forces["mast"] == pytest.approx(-P * np.cos(b) / np.sin(b - a), rel=1e-12)
    assert guyed.forces["stays"] == pytest.approx(stay, rel=1e-12)
    verified("force of a stay [N]", stay, guyed.forces["stays"][0])
    assert at_rest(guyed)


@pytest.mark.mpi_once
@pytest.mark.parametrize("k", [6, 12])
def test_cable_dome(k, verified):
    outer, middle, inner, rise, drop, W = 10.0, 6.0, 1.0, 0.25, 0.5, 500.0
    angle = np.arange(k) * 2 * np.pi / k
    radial = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    length, up = outer - middle, np.array([0, 0, 1.0])
    points = np.concatenate(
        [outer * radial, middle * radial + rise * length * up, inner * radial + rise * (outer - inner) * up]
    )
    i = np.arange(k)
    ridge = Cable(np.concatenate([np.stack([i, k + i], axis=1), np.stack([k + i, 2 * k + i], axis=1)]), 1e8, 2e4)
    loads = [PointLoad(k + i, (0, 0, -W))]
    form = updated_reference(Structure(points, {"ridge": ridge}, [Support(range(3 * k))]), loads)
    lower = middle * radial - drop * length * up
    n = len(points)
    bars = {
        "struts": Mast(np.stack([n + i, k + i], axis=1), 1e8),
        "diagonals": Cable(np.stack([i, n + i], axis=1), 1e8),
        "hoop": Cable(np.stack([n + i, n + (i + 1) % k], axis=1), 1e8),
    }
    dome = masts_and_stays(form, bars, lower, heads=[*(k + i), *(n + i)])
    assert dome.forces["struts"] == pytest.approx(-W, rel=1e-12)
    assert dome.forces["diagonals"] == pytest.approx(W * np.hypot(1, drop) / drop, rel=1e-12)
    assert dome.forces["hoop"] == pytest.approx(W / drop / (2 * np.sin(np.pi / k)), rel=1e-12)
    verified("force of the hoop of a dome [N]", W / drop / (2 * np.sin(np.pi / k)), dome.forces["hoop"][0])
    assert at_rest(dome, loads)
