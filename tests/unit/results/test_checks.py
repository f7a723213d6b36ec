"""Checks of a state: number, limit, verdict, place and remedy; the table that a run prints at its end."""

import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Membrane,
    Newton,
    PointLoad,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
)
from fx_membrane.results.check import Verdict
from fx_membrane.results.checks import checks, table
from fx_membrane.results.limits import Limits, limit_checks
from fx_membrane.results.overview import overview

pytestmark = pytest.mark.filterwarnings("ignore")


def sagging():
    """Square of fabric with a slack cable, loaded until its strain leaves the law."""
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    parts = {
        "roof": Membrane(triangles, Fabric(100.0, 0.3), 0.1),
        "line": Cable(polyline([10, 11, 12, 13, 14]), 1e3, prestress=-300.0),
    }
    structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
    return Analysis(structure, progress=False).run([Stage("load", [DistributedLoad((0, 0, -8.0), "roof")])])


def test_each_check_has_number_limit_verdict_place_and_remedy():
    results = sagging()
    found = {check.name: check for check in checks(results["load"])}
    strain = found["largest strain"]
    assert (strain.verdict, strain.limit) == (Verdict.WARN, "5 %")
    assert float(strain.found.split()[0]) > 5
    assert re.match(r"'roof', cell \d+ at \(", strain.place)
    assert "law" in strain.remedy
    slack = found["slack cables of 'line'"]
    assert (slack.verdict, slack.found, slack.limit) == (Verdict.WARN, "4 of 4", "0")
    assert slack.place == "cell 0 at (-1.5, 0, 0)"
    assert "prestress" in slack.remedy
    balanced = found["unbalanced nodal force / largest"]
    assert (balanced.verdict, balanced.place, balanced.remedy) == (Verdict.PASS, "", "")
    assert float(balanced.found) < float(balanced.limit)
    lines = table(list(found.values())).splitlines()
    assert any(line.strip().startswith("cell 0 at (-1.5, 0, 0): Raise") for line in lines)


def test_loose_end_is_named_with_its_place():
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 0, -1)]
    parts = {"rope": Cable(polyline([0, 1, 2]), 1e3, prestress=10.0), "hanger": Cable([[1, 3]], 1e3)}
    structure = Structure(points, parts, [Support([0, 2])])
    pull = Stage("pull", [PointLoad(3, (0, 0, -1.0))])
    state = Analysis(structure, Newton(), progress=False).run([pull])["pull"]
    (loose,) = [check for check in checks(state) if check.name.startswith("loose ends")]
    assert (loose.found, loose.verdict, loose.place) == ("1", Verdict.WARN, "node 3 at (1, 0, -1)")


def test_overview_has_work_extremes_and_places():
    results = sagging()
    results.force_unit, results.length_unit = "kN", "m"
    lines = overview(results).splitlines()
    assert re.match(r"Stage 'load': 1 increment, \d+ iterations$", lines[0])
    assert re.match(r"  largest displacement \S+ m, node 12 at \(0, 0, 0\)$", lines[1])
    least, largest = results["load"].membrane("roof").principal[:, 1].min(), results["load"].membrane("roof").principal
    shown = re.match(r"  roof\s+(\S+) \(cell \d+ at \(.*\)\) to (\S+) \(cell \d+ at \(.*\)\) kN/m", lines[2])
    assert [float(number) for number in shown.groups()] == pytest.approx([least, largest.max()], rel=1e-4)
    assert lines[3].endswith("kN; 100 % slack")


def test_limits_of_the_user_pass_or_fail_with_place_and_remedy():
    state = sagging()["load"]
    stress, force = state.membrane("roof").principal.max(), np.abs(state.cable("line").force).max()
    limits = Limits(displacement=2 * state.largest_displacement, stress={"roof": stress / 2}, force={"line": 1e3})
    moves, roof, line = limit_checks(state, limits)
    assert (moves.name, moves.verdict, moves.place) == ("displacement", Verdict.PASS, "")
    assert (roof.name, roof.found, roof.limit, roof.verdict) == ("utilisation of 'roof'", "2", "1", Verdict.FAIL)
    assert state.membrane("roof").principal[int(roof.place.split()[1]), 0] == pytest.approx(stress, rel=1e-9)
    assert roof.remedy
    assert line.verdict is Verdict.PASS
    assert float(line.found) == pytest.approx(force / 1e3, rel=1e-2)
    with pytest.raises(ValueError, match="stress of 'roof' is 0"):
        Limits(stress={"roof": 0.0})
