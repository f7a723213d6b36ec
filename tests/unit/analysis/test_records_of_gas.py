"""Gas in reports, summaries, copies, archives and checkpoints."""

import copy
import pickle
import re
from dataclasses import replace

import numpy as np
import pytest

from cushions import INFLATE, SEAL, airbag, run
from fx_membrane import (
    DistributedLoad,
    GasVolume,
    Stage,
    load_results,
    report,
    save_results,
    stability,
    write_report,
    write_scene,
)
from fx_membrane.results.plain_summary import summary
from fx_membrane.results.table_of_run import overview

SNOW = DistributedLoad((0, 0, -150.0), "top")


@pytest.mark.mpi
def test_results_of_stages():
    states = run(INFLATE, SEAL, Stage("fill", changes=[GasVolume(0.8, "gas")], after="seal"))
    text = report(states["seal"])
    assert re.search(r"chamber 'gas': closed, pressure 300(\.\d+)? N/m2, volume 0\.\d+ m3, dp/dV -\d+ N/m5", text)
    assert "dp/dV" not in report(states["fill"])
    told = summary(states["fill"])["chambers"]["gas"]
    assert told["dp/dV"] is None
    assert told["volume"] == pytest.approx(0.8)
    for copied in (copy.deepcopy(states["seal"]), pickle.loads(pickle.dumps(states["seal"]))):
        assert copied.chambers == states["seal"].chambers
        assert copied.increments[-1].chambers == states["seal"].chambers


def test_archive(tmp_path):
    states = run(INFLATE, SEAL, Stage("fill", changes=[GasVolume(0.8, "gas")], after="seal"))
    save_results(states, tmp_path / "gas.fxm")
    opened = load_results(tmp_path / "gas.fxm")
    assert opened["seal"].chambers == states["seal"].chambers
    assert opened["fill"].increments[-1].chambers == states["fill"].increments[-1].chambers
    assert opened["seal"].structure == states["seal"].structure
    assert opened.stages == states.stages
    assert stability(opened["fill"]).stable


def test_checkpoint(tmp_path):
    stages = [INFLATE, SEAL, Stage("snow", [SNOW], after="seal", increments=3)]
    whole = run(*stages)
    run(*stages[:2], checkpoint_file=tmp_path / "gas")
    resumed = run(*stages, checkpoint_file=tmp_path / "gas")
    again = run(*stages, checkpoint_file=tmp_path / "gas")
    for states in (resumed, again):
        assert np.allclose(states["snow"].displacement, whole["snow"].displacement, atol=1e-12)
        assert states["snow"].increments[-1].chambers["gas"].pressure == pytest.approx(
            whole["snow"].chambers["gas"].pressure, rel=1e-12
        )
    other = replace(airbag(exponent=1.4))
    with pytest.raises(ValueError, match="chamber 'gas'"):
        run(*stages, structure=other, checkpoint_file=tmp_path / "gas")


def test_report_and_scene_tell_the_gas_of_each_stage(tmp_path):
    pytest.importorskip("jinja2")
    pytest.importorskip("plotly")
    states = run(INFLATE, SEAL)
    write_report(states, tmp_path / "gas.html", pictures=False)
    page = (tmp_path / "gas.html").read_text(encoding="utf-8")
    gas = page.split("<h2>Gas</h2>")[1].split("<h2>")[0]
    assert re.findall(r"<td>gas</td><td>(\w+)</td><td class=\"n\">300 N/m2</td>", gas) == ["open", "closed"]
    write_scene(states, tmp_path / "scene.html")
    assert "Chamber 'gas': closed, pressure 300 N/m2" in (tmp_path / "scene.html").read_text(encoding="utf-8")


def test_lines_of_gas_fit_on_a_screen():
    assert max(map(len, overview(run(INFLATE, SEAL)).splitlines())) <= 80
