"""The direction of tension in a woven fabric that wrinkles: stationary, and the best.

Reference: the conditions of optimality of the convex problem. Tolerance: rounding, 1e-12.
"""

import numpy as np
import pytest

from fx_membrane import OrthotropicFabric, tension_direction
from fx_membrane.assembly import wrinkling_direction
from wrinkled import COLUMN, ROW, compliance, engineering, state_of, tensor


def random_fabrics(rng, count, low, high):
    """Fabrics with stiffness ratios up to 20, shear stiffness down to 1/50, nu between fractions of its limit."""
    for _ in range(count):
        weft = 1000.0 * 20.0 ** rng.uniform(-1, 1)
        nu = rng.uniform(low, high) * np.sqrt(1000.0 / weft)
        yield OrthotropicFabric(1000.0, weft, nu, rng.choice([1000.0, weft]) * 50.0 ** rng.uniform(-1, 0))


def random_strains(rng, kind, fabric, count=400):
    components = rng.normal(size=(count, 3))
    if kind == "strains":
        return tensor(components)
    if kind == "stresses":
        H = compliance(fabric)
        return tensor(components / np.sqrt(np.diag(H)) @ H, 0.5)
    # Nearly slack: only a narrow cone of directions is extended.
    angle, small = rng.uniform(0, np.pi, count), 10.0 ** rng.uniform(-8, -1, count)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]).transpose(2, 0, 1)
    return turn @ (np.stack([small, -np.ones(count)], axis=-1)[:, :, None] * turn.swapaxes(1, 2))


def wrinkled_cells(rng, fabrics, kind):
    """Wrinkled strains under each fabric, with its moduli and its compliance, cell by cell."""
    strains, moduli, compliances = [], [], []
    for fabric in fabrics:
        e = random_strains(rng, kind, fabric)
        e = e[state_of(e, fabric) == 1]
        strains.append(e)
        moduli.append(np.tile([fabric.Et_warp, fabric.Et_weft, fabric.nu, fabric.Gt], (len(e), 1)))
        compliances.append(np.tile(compliance(fabric), (len(e), 1, 1)))
    return np.concatenate(strains), np.concatenate(moduli), np.concatenate(compliances)


@pytest.mark.study("low", "high")
@pytest.mark.parametrize("kind", ["strains", "stresses", "nearly slack"])
@pytest.mark.parametrize(("low", "high"), [(-0.999, -0.7), (-0.7, 0.0), (0.0, 0.7), (0.7, 0.999)])
def test_direction_of_tension_is_stationary_and_the_best(low, high, kind):
    """Optimal where the wrinkle strain b = C^-1 : S - e is normal to the tension and not negative; the problem is
    convex, so that is enough. Sampling says the same: no direction has more energy."""
    rng = np.random.default_rng(21)
    e, moduli, H = wrinkled_cells(rng, random_fabrics(rng, 100, low, high), kind)
    assert len(e) > 5000
    angle = wrinkling_direction.direction(e[:, ROW, COLUMN], wrinkling_direction.Moduli(*moduli.T))
    t = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    n = np.stack([-t[:, 1], t[:, 0]], axis=-1)
    tt = np.stack([t[:, 0] ** 2, t[:, 1] ** 2, t[:, 0] * t[:, 1]], axis=-1)
    e_tt, H_tt = np.einsum("ni,nij,nj->n", t, e, t), np.einsum("ni,nij,nj->n", tt, H, tt)
    elastic = tensor((e_tt / H_tt)[:, None] * np.einsum("ni,nij->nj", tt, H), 0.5)
    b = elastic - e
    scale = np.abs(e).max(axis=(1, 2)) + np.abs(elastic).max(axis=(1, 2))
    along, across = np.einsum("ni,nij,nj->n", t, b, n) / scale, np.einsum("ni,nij,nj->n", n, b, n) / scale
    worst = int(np.abs(along).argmax())
    assert abs(along[worst]) <= 1e-12, moduli[worst]
    assert across.min() >= -1e-12, moduli[across.argmin()]
    assert (e_tt > 0).all(), moduli[e_tt.argmin()]
    # Where e_tt is a small difference of large terms, it has a rounding of 1e-15 of the strain.
    rounding = 1e-15 * np.abs(e).max(axis=(1, 2)) / np.sqrt(H_tt)
    most = e_tt / np.sqrt(H_tt) * (1 + 1e-12) + rounding
    for c, s in zip(np.cos(np.linspace(0, np.pi, 101)), np.sin(np.linspace(0, np.pi, 101)), strict=True):
        ray = np.array([c**2, s**2, c * s])
        energy = np.maximum(engineering(e) @ ray, 0) / np.sqrt(H @ ray @ ray)
        assert (energy <= most).all(), moduli[(energy - most).argmax()]


def test_public_helper_takes_moduli_of_each_cell():
    """The angle of wrinkled cells is that of each fabric alone; taut and slack cells have none."""
    rng = np.random.default_rng(22)
    fabrics = list(random_fabrics(rng, 20, -0.7, 0.7))
    e = np.concatenate([random_strains(rng, "strains", fabric, 30) for fabric in fabrics])
    state = np.concatenate([state_of(part, fabric) for part, fabric in zip(np.split(e, 20), fabrics, strict=True)])
    assert (np.bincount(state) > 20).all()
    moduli = {name: np.repeat([getattr(f, name) for f in fabrics], 30) for name in ("Et_warp", "Et_weft", "nu", "Gt")}
    found = tension_direction(e, **moduli)
    assert not found[state != 1].any()
    for number, fabric in enumerate(fabrics):
        here = slice(30 * number, 30 * number + 30)
        wrinkled = state[here] == 1
        expected = wrinkling_direction.direction(e[here][wrinkled][:, ROW, COLUMN], fabric)
        np.testing.assert_array_equal(found[here][wrinkled], expected)


def test_search_ends_when_it_has_settled(monkeypatch):
    """Newton's method settles in few steps, and a fabric of positive nu has one maximum where it is extended."""
    rng = np.random.default_rng(23)
    fabric = OrthotropicFabric(900.0, 600.0, 0.3, 300.0)
    e = random_strains(rng, "strains", fabric)
    steps, stationarity = [], wrinkling_direction._stationarity
    monkeypatch.setattr(wrinkling_direction, "_stationarity", lambda *of: steps.append(1) or stationarity(*of))
    wrinkling_direction.direction(e[state_of(e, fabric) == 1][:, ROW, COLUMN], fabric)
    assert len(steps) < 10


def test_public_helper_on_a_process_without_cells():
    assert tension_direction(np.empty((0, 2, 2)), 1e5, 1e5, 0.3, 1e4).shape == (0,)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"strain": [1.0, 2.0, 3.0]}, r"strain has shape \(3,\); give \(n, 2, 2\)"),
        ({"strain": [[[np.nan, 0], [0, 1]]]}, "strain.*value.*not finite"),
        (
            {"strain": [[[0.01, 0], [0, 0.02]], [[0, 0.01], [-0.01, 0]]]},
            r"strain of cell 1 is \[\[0\.0, 0\.01\], \[-0\.01, 0\.0\]\], which is not symmetric; give.*12 and 21",
        ),
        ({"Gt": 0.0}, "Gt is 0.*positive"),
        ({"Et_weft": [1.0, 2.0]}, r"Et_weft.*shape \(2,\).*number.*one.*1 cells"),
        ({"nu": 1.5}, "nu.2 Et_weft / Et_warp must be below 1"),
        ({"nu": "0.3"}, "nu.*array.*numbers"),
    ],
)
def test_public_helper_refuses(change, words):
    given = {"strain": [[[0.01, 0], [0, -0.01]]], "Et_warp": 1e5, "Et_weft": 1e5, "nu": 0.3, "Gt": 1e4}
    with pytest.raises(ValueError, match=words):
        tension_direction(**given | change)
