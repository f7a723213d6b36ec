"""Ring on a rope, and a weight on a rope over pulleys: one tension along a path without friction.

Claim: a ring on a rope of given length hangs on the ellipse about the supports, where both parts pull at the same
angle. Reference: the ellipse in closed form for an inextensible rope, the same with the stretch by the law solved for;
the balance of the ring for a rope of given force. The states are exact: tolerances are those of the printed digits.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    FixedLength,
    GivenForce,
    LengthChange,
    Membrane,
    PointLoad,
    PrestressFactor,
    Rope,
    Stage,
    Structure,
    Support,
    TemperatureChange,
    UnstressedLength,
    polyline,
    rectangle,
)

SOURCE = "closed form, ellipse about the supports"

START = [(0, 0, 0), (4, 0, -3), (10, 0, 2)]
WEIGHT = Stage("weight", [PointLoad(1, (0, 0, -1e4))])


def ring(EA=1e6, **data):
    return Structure(START, {"rope": Rope([0, 1, 2], EA, **data)}, [Support([0, 2]), Support(1, "y")])


def run(structure, *stages):
    return Analysis(structure, progress=False).run(stages)


@pytest.mark.mpi
def test_elastic_rope(verified):
    state = run(ring(unstressed_length=12.0), WEIGHT)["weight"]
    found = state.rope("rope")
    verified("tension of the rope [N]", 8872.71827, found.tension)
    np.testing.assert_allclose(found.tension, 8872.71827, rtol=1e-9)
    np.testing.assert_allclose(found.length / 12, 1.0087573458, rtol=1e-10)
    np.testing.assert_allclose(state.position[1], (3.5340514400, 0, -2.4107608796), atol=1e-9)
    np.testing.assert_allclose(found.force, found.tension)
    residuals = [entry.residual for _, entry in state.history]
    assert residuals[-2] < 1e-2 * residuals[-3] < 1e-4 * residuals[-4]  # quadratic: the border is in the tangent


@pytest.mark.filterwarnings("ignore::fx_membrane.LostPrestressWarning")
def test_rope_that_hardly_stretches():
    state = run(ring(EA=1e11, unstressed_length=12.0), WEIGHT)["weight"]
    np.testing.assert_allclose(state.rope("rope").tension, 9045.34034, rtol=1e-6)
    np.testing.assert_allclose(state.position[1], (3.4924432771, 0, -2.3166247904), atol=1e-6)


@pytest.mark.mpi
@pytest.mark.parametrize("start", [{"force": 9e3}, {}], ids=["from the start", "by a stage"])
def test_given_force(start):
    stages = [WEIGHT, Stage("jack", changes=[GivenForce(9e3, "rope")], after="weight", increments=3)]
    given = run(ring(**(start or {"unstressed_length": 12.0})), *stages)["jack"]
    assert given.rope("rope").tension == pytest.approx(9e3, rel=1e-12)
    ends = np.asarray(START)[[0, 2]] - given.position[1]
    pull = 9e3 * (ends / np.linalg.norm(ends, axis=1)[:, None]).sum(axis=0)
    np.testing.assert_allclose(pull, (0, 0, 1e4), atol=1e-5)


@pytest.mark.mpi
def test_a_rope_fixed_after_it_was_stressed_is_one_of_that_length():
    stages = [
        WEIGHT,
        Stage("jack", changes=[GivenForce(2e4, "rope")], after="weight"),
        Stage("fixed", changes=[FixedLength("rope")], after="jack", increments=3),
        Stage("more", [PointLoad(1, (1e3, 0, -5e3))], after="fixed"),
    ]
    results = run(ring(unstressed_length=12.0), *stages)
    np.testing.assert_allclose(results["fixed"].position, results["jack"].position, atol=1e-9)
    length = results["jack"].rope("rope").unstressed_length
    at_once = Stage("at once", [PointLoad(1, (1e3, 0, -1.5e4))])
    expected = run(ring(unstressed_length=length), at_once)["at once"]
    np.testing.assert_allclose(results["more"].position, expected.position, atol=1e-9)
    assert results["more"].rope("rope").tension == pytest.approx(expected.rope("rope").tension, rel=1e-10)


@pytest.mark.parametrize(
    "change", [LengthChange(-0.2, "rope"), UnstressedLength(11.8, "rope")], ids=["shorter", "of a length"]
)
def test_changed_length_is_another_rope(change):
    results = run(ring(unstressed_length=12.0), WEIGHT, Stage("changed", changes=[change], after="weight"))
    expected = run(ring(unstressed_length=11.8), WEIGHT)["weight"]
    np.testing.assert_allclose(results["changed"].position, expected.position, atol=1e-9)


def test_warmth_and_loss_of_prestress():
    warm = run(
        ring(unstressed_length=12.0), WEIGHT, Stage("t", changes=[TemperatureChange(50, "rope", 1e-5)], after="weight")
    )
    longer = run(ring(unstressed_length=12 / np.sqrt(1 - 2 * 5e-4)), WEIGHT)["weight"]
    np.testing.assert_allclose(warm["t"].position, longer.position, atol=1e-9)
    lost = run(ring(prestress=1e4), WEIGHT, Stage("t", changes=[PrestressFactor(0.5, "rope")], after="weight"))["t"]
    np.testing.assert_allclose(lost.position, run(ring(prestress=5e3), WEIGHT)["weight"].position, atol=1e-9)


@pytest.mark.mpi
def test_edge_cable_in_a_pocket():
    """Its tension is one along the edge, by its whole length, although the load is not."""
    points, triangles = rectangle(4.0, 4.0, 8, 8)
    points[:, :2] += 2.0
    edge = np.flatnonzero(points[:, 1] == 0)
    held = np.flatnonzero((points[:, 1] == 4) | (points[:, 0] == 0) | (points[:, 0] == 4))
    points[edge, 1] += 0.05 * points[edge, 0] * (4 - points[edge, 0])
    parts = {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3), "edge": Rope(edge, 5e6, prestress=2e4)}
    state = run(
        Structure(points, parts, [Support(held)]),
        Stage("wind", [PointLoad(edge[2:4], (0, -500, 800))]),
    )["wind"]
    rope = state.rope("edge")
    np.testing.assert_allclose(rope.force, rope.tension, rtol=1e-14)
    path = state.position[polyline(edge)]
    length = np.linalg.norm(np.diff(path, axis=1), axis=2).sum()
    assert rope.length == pytest.approx(length, rel=1e-12)
    before = np.linalg.norm(np.diff(points[polyline(edge)], axis=1), axis=2).sum()
    stretch = length / before
    assert rope.tension == pytest.approx((2e4 + 5e6 * (stretch**2 - 1) / 2) * stretch, rel=1e-10)
