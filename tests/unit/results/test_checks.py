"""Checks of a state: number, limit, verdict, place and remedy; the table that a run prints at its end."""

import re

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
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
from fx_membrane.results.limits import Limits, limit_checks
from fx_membrane.results.state_checks import checks, table
from fx_membrane.results.table_of_run import overview, states_and_checks

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


@pytest.mark.parametrize(
    ("cells", "words"), [([[0, 1], [1, 2], [2, 0]], "in a ring .* its joints"), ([[0, 1], [1, 2]], "anchor its foot")]
)
def test_remedy_for_masts_in_tension_knows_rings(cells, words):
    """A ring has no foot to anchor."""
    points = [(0, 0, 0), (4, 0, 0), (2, 3, 0)]
    structure = Structure(points, {"bars": Mast(cells, 1e6, prestress=1e3)}, [Support([0, 1]), Support([2], "z")])
    state = Analysis(structure, progress=False).run([Stage("rest")])["rest"]
    found = {check.name: check for check in checks(state)}["masts in tension of 'bars'"]
    assert found.verdict is Verdict.WARN
    assert re.search(words, found.remedy)


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
    assert float(re.match(r"  roof\s+least (\S+) kN/m, cell \d+ at \(", lines[2])[1]) == pytest.approx(least, rel=1e-4)
    assert float(re.match(r"\s+largest (\S+) kN/m, cell", lines[3])[1]) == pytest.approx(largest.max(), rel=1e-4)
    assert re.match(r"  line\s+least \S+ kN, cell \d+ at \(", lines[4])
    assert lines[6].strip() == "100 % slack"


LONG = "roof over the northern entrance hall, between axes A and F, second layer of the fabric"


def test_lines_fit_on_a_screen():
    """No line is longer than 80 columns, but for a word; long names of parts keep their numbers."""
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    parts = {
        LONG: Membrane(triangles, Fabric(100.0, 0.3), 0.1),
        "d\u00e4mmung_" * 9: Cable(polyline([10, 11, 12, 13, 14]), 1e3, prestress=-300.0),
    }
    structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
    results = Analysis(structure, progress=False).run([Stage("load", [DistributedLoad((0, 0, -8.0), LONG)])])
    results.limits = Limits(displacement=1e-9, stress={LONG: 1e-9})
    for text in (overview(results), states_and_checks(results)):
        long = [line for line in text.splitlines() if len(line) > 80]
        assert all(len(line.split()) <= 2 or max(map(len, line.split())) > 60 for line in long), long
    text = " ".join(overview(results).split())
    assert re.search(f"(PASS|WARN) wrinkled or slack area of '{LONG}' \\S+ % 5 %", text)
    assert f"FAIL displacement {results['load'].largest_displacement:.3g} m 1e-09 m" in text


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
