"""Closed cushion with an edge cable in a pocket and water on top: one Newton loop, on any number of processes."""

import numpy as np
import pytest

from cushions import FABRIC, double_cushion, two_films
from fx_membrane import (
    Ambient,
    Analysis,
    Cable,
    Chamber,
    GasPressure,
    Membrane,
    PlanLoad,
    Pond,
    Rope,
    Seal,
    Stage,
    Structure,
    Support,
    polyline,
)


@pytest.mark.mpi
def test_all_in_one_loop():
    points, top, bottom, rim = two_films(4.0, 4.0, 8, 8)
    bulge = 0.3 * (1 - points[:, 0] ** 2 / 4) * (1 - points[:, 1] ** 2 / 4)
    points[:, 2] = np.where(np.isin(np.arange(len(points)), top), 1.0, -1.0) * bulge
    edge = rim[points[rim, 1] == -2]
    edge = edge[np.argsort(points[edge, 0])]
    parts = {"top": Membrane(top, FABRIC, 50.0), "bottom": Membrane(bottom, FABRIC, 50.0), "edge": Rope(edge, 1e5, 500)}
    supports = [Support(np.setdiff1d(rim, edge[1:-1])), Support(edge[1:-1], "z")]
    cushion = Structure(points, parts, supports, chambers={"air": Chamber(["top", "bottom"])})
    middle = np.flatnonzero((np.abs(points[top].mean(axis=1)[:, :2]) < 0.8).all(axis=1))
    stages = [
        Stage("fan", changes=[GasPressure(300.0, "air")]),
        Stage("sealed", changes=[Ambient(101325.0), Seal("air")], after="fan"),
        Stage("dent", [PlanLoad((0, 0, -1500.0), "top", cells=middle)], after="sealed"),
        Stage("rain", [Pond("top", volume=0.01, cells=middle)], after="dent"),
    ]
    state = Analysis(cushion, progress=False).run(stages)["rain"]
    gas, pond, rope = state.chambers["air"], state.ponds[0], state.rope("edge")
    dry = Analysis(cushion, progress=False).run(stages[:2])["sealed"].chambers["air"]
    # Boyle's law, with the absolute pressure; the volume of the water; the law of the rope.
    assert (101325 + gas.pressure) * gas.volume == pytest.approx((101325 + 300) * dry.volume, rel=1e-10)
    assert pond.volume == pytest.approx(0.01, rel=1e-10)
    before = np.linalg.norm(np.diff(points[edge], axis=0), axis=1).sum()
    stretch = np.linalg.norm(np.diff(state.position[edge], axis=0), axis=1).sum() / before
    assert rope.tension == pytest.approx((500 + 1e5 * (stretch**2 - 1) / 2) * stretch, rel=1e-10)
    residuals = [entry.residual for _, entry in state.history]
    assert len(residuals) < 8
    assert residuals[-1] < 1e-3 * residuals[-2] < 1e-5 * residuals[-3]


@pytest.mark.mpi
def test_two_chambers_in_one_loop():
    """Two cells with a common wall, a rope and a cable in pockets, and water on top."""
    films = double_cushion({}, 4.0, 8)
    points, rim = films.points, np.asarray(films.supports[0].nodes)
    low, high = (rim[points[rim, 1] == y] for y in (-2, 2))
    low, high = (edge[np.argsort(points[edge, 0])] for edge in (low, high))
    sliding = np.concatenate([low[1:-1], high[1:-1]])
    lines = {"rope": Rope(low, 1e5, 500), "cable": Cable(polyline(high), 1e5, 500)}
    cells = {"upper": Chamber({"top": 1, "wall": -1}), "lower": Chamber({"wall": 1, "low": -1}, exponent=1.4)}
    supports = [Support(np.setdiff1d(rim, sliding)), Support(sliding, "z")]
    cushion = Structure(points, dict(films.parts) | lines, supports, chambers=cells)
    middle = np.flatnonzero((np.abs(points[films.parts["top"].cells].mean(axis=1)[:, :2]) < 0.8).all(axis=1))
    stages = [
        Stage("fan", changes=[GasPressure(300.0, "upper"), GasPressure(400.0, "lower")]),
        Stage("sealed", changes=[Ambient(101325.0), Seal("upper"), Seal("lower")], after="fan"),
        Stage("dent", [PlanLoad((0, 0, -2000.0), "top", cells=middle)], after="sealed"),
        Stage("rain", [Pond("top", volume=0.01, cells=middle)], after="dent"),
    ]
    results = Analysis(cushion, progress=False).run(stages)
    state, sealed = results["rain"], results["sealed"].chambers
    for name, exponent, fan in (("upper", 1.0, 300.0), ("lower", 1.4, 400.0)):
        gas = state.chambers[name]
        amount = (101325 + fan) * sealed[name].volume ** exponent
        assert (101325 + gas.pressure) * gas.volume**exponent == pytest.approx(amount, rel=1e-10)
        assert gas.pressure > fan + 1.0  # the load goes through the wall into both cells
    assert state.ponds[0].volume == pytest.approx(0.01, rel=1e-10)
    before = np.linalg.norm(np.diff(points[low], axis=0), axis=1).sum()
    stretch = np.linalg.norm(np.diff(state.position[low], axis=0), axis=1).sum() / before
    assert state.rope("rope").tension == pytest.approx((500 + 1e5 * (stretch**2 - 1) / 2) * stretch, rel=1e-10)
    # The supports take the load on cells of 0.125 m2 in plan and the water; gas pushes against itself.
    weight = 2000.0 * 0.125 * len(middle) + 9810 * 0.01
    assert state.equilibrium.reactions[2] == pytest.approx(weight, rel=1e-8)
    residuals = [entry.residual for _, entry in state.history]
    assert len(residuals) < 8
    assert residuals[-1] < 1e-3 * residuals[-2] < 1e-5 * residuals[-3]
