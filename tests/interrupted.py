"""Runs with a checkpoint that are interrupted."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Membrane,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    polyline,
)
from models import EDGE, FABRIC, LIFT, POINTS, TRIANGLES

RIDGE = polyline(range(10, 15))


def structure(points=POINTS, prestress=1e3, stiffness=1e6):
    parts = {
        "fabric": Membrane(TRIANGLES, FABRIC, prestress=prestress),
        "ridge": Cable(RIDGE, stiffness, 500.0),
    }
    return Structure(points, parts, [Support(EDGE)])


def stages(snow=-200.0, increments=3):
    return [
        Stage("lift", displacements=[LIFT], increments=2),
        Stage("snow", [DistributedLoad((0, 0, snow), "fabric")], increments=increments, after="lift"),
        Stage("wind: 45°", [Pressure(300.0, "fabric"), PointLoad(6, (1.0, 2, 3))], increments=2, after="lift"),
    ]


class Killed(Exception):
    """End of the process."""


def counted(analysis, most=10**6):
    """Count the increments solved; end the run instead of one too many."""
    solve, calls = analysis._solve, []

    def wrapped(*arguments):
        if len(calls) == most:
            raise Killed
        calls.append(1)
        return solve(*arguments)

    analysis._solve = wrapped
    return calls


def assert_same(found, expected):
    assert list(found) == list(expected)
    for name, result in expected.items():
        mine = found[name]
        for field in ("displacement", "loads", "reactions"):
            values = getattr(result, field)
            assert getattr(mine, field) == pytest.approx(values, abs=1e-9 * np.abs(values).max()), field
        assert mine.energy == pytest.approx(result.energy, rel=1e-12)
        assert mine.membrane("fabric").principal == pytest.approx(result.membrane("fabric").principal, rel=1e-9)
        assert mine.cable("ridge").force == pytest.approx(result.cable("ridge").force, rel=1e-9)
        assert [factor for factor, _ in mine.history] == [factor for factor, _ in result.history]
        # Unbalanced forces at the end are rounding, which differs between processes.
        for (_, mine_entry), (_, entry) in zip(mine.history, result.history, strict=True):
            assert mine_entry == pytest.approx(entry, rel=1e-6, abs=1e-5)


def cut_short(path, most):
    analysis = Analysis(structure())
    calls = counted(analysis, most)
    with pytest.raises(Killed):
        analysis.run(stages(), path)
    assert len(calls) == most
