"""Every demo runs, passes its own check, and draws visible pictures."""

import importlib.util
import json
import os
import re
import runpy
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import matplotlib.image
import numpy as np
import pytest
from mpi4py import MPI

from demo_cases import CASES, check_case, check_pattern, has_cases
from fx_membrane import Analysis, Stage
from fx_membrane.files.demo_cases import SCRIPTS
from fx_membrane.form_finding.reasons.ring_reach import reach
from fx_membrane.plot import windows
from pictures import count_colours

DEMOS = Path(__file__).parent.parent / "demos"
PICTURES: dict[str, list[str]] = {
    "cone": ["plan.png", "prestress.png", "snow.png", "uplift.png", "wind.png"],
    "cushion": [],
    "dolfinx_in_and_out": [],
    "forms_alone": [],
    "own_energy": [],
    "own_law": [],
    "own_solver": [],
    "patterns": ["error.png", "strips.png"],
    "rain": [],
    "shade_pavilion": [
        "fig12_plan.png",
        "fig13_isometric.png",
        "fig14_structure.png",
        "fig15-17a_displacements.png",
        "fig15-17b_displacements.png",
        "fig18-19a_stresses.png",
        "fig18-19b_stresses.png",
    ],
    "solvers": ["pavilion.png", "square.png"],
    "square_membrane": ["fig7_convergence.png", "fig8_displacements.png", "fig9_principal_stresses.png"],
    "tilted_masts": ["snow.png", "structure.png", "wind.png"],
}
# States of the variables of a demo that makes several structures, by the case file of each
STATES = {"rain": {"rain": "soft", "rain_stiff": "stiff"}}

HAS_PYVISTA = importlib.util.find_spec("pyvista") is not None  # Debian 12 has none
STORED = Path(__file__).parent / "demo_numbers.json"


def run(name):
    """Run a demo as by `python demos/name.py`, with its folder on the path; return its variables."""
    with mock.patch.object(sys, "path", [str(DEMOS), *sys.path]):
        found = runpy.run_path(str(DEMOS / f"{name}.py"), run_name="__main__")
    if name in ("cone", "shade_pavilion"):  # others begin with their structures; an import would run all of it again
        sys.modules[name] = SimpleNamespace(**found)  # type: ignore[assignment]
    return found


def compare(name, numbers, chosen):
    """Check for the same numbers, to 1e-10 of the largest in a group, in every version, on any processes.

    To store numbers again after an intended change, run this file as a script.
    """
    stored = {group: values for group, values in json.loads(STORED.read_text())[name].items() if chosen(group)}
    assert numbers.keys() == stored.keys()
    for group, values in numbers.items():
        expected = np.array(stored[group])
        np.testing.assert_allclose(values, expected, rtol=0, atol=1e-10 * np.abs(expected).max(), err_msg=group)


def expected_of(name, found):
    """Results of a demo by stage, by the name of their case file."""
    if name not in STATES:
        return {name: found["results"]}
    return {case: {found[state].name: found[state]} for case, state in STATES[name].items()}


def check_pictures(name):
    """Check that all pictures of a demo exist and are not blank."""
    pictures = sorted(Path("output", name).glob("*.png"))
    assert [picture.name for picture in pictures] == PICTURES[name]
    for picture in pictures:
        image = matplotlib.image.imread(picture)
        assert min(image.shape[:2]) > 400
        white = (image[..., :3] > 0.99).all(axis=2).mean()
        assert 0.1 < white < 0.97  # neither blank nor filled
        assert count_colours(image[..., :3], 17) > 20  # more than one flat colour


def test_every_demo_is_listed():
    assert {path.stem for path in DEMOS.glob("*.py")} == set(PICTURES)


@pytest.mark.parametrize("name", PICTURES)
def test_demos_are_short(name):
    """A screen of code for what a user may write in the place of ours, and not much text around it."""
    lines = (DEMOS / f"{name}.py").read_text().splitlines()
    code = [line for line in lines if line.strip() and not line.startswith("#")]
    assert len(lines) <= 150
    assert not re.match("own|forms_alone|dolfinx", name) or len(code) <= 42


@pytest.mark.parametrize("name", PICTURES)
@pytest.mark.parametrize(
    "pictures",
    [
        pytest.param(True, marks=pytest.mark.drawn, id="pictures"),
        pytest.param(False, marks=pytest.mark.mpi, id="numbers"),
    ],
)
def test_demo(name, pictures, tmp_path, monkeypatch, capsys):
    """With pictures on one process, where pyvista is installed; on several, and without pyvista, the numbers alone."""
    if pictures != (HAS_PYVISTA and MPI.COMM_WORLD.size == 1):
        pytest.skip("runs with pictures on one process, without on several")
    if name == "patterns":
        pytest.importorskip("potpourri3d")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(windows, "LONGER", 500)  # pixels, which the software of a machine without screen draws
    small = MPI.COMM_WORLD.size > 1  # without the pavilion for all solvers: thousands of steps, each of many messages
    options = ["--small"] * small + ["--no-pictures"] * (not pictures)
    monkeypatch.setattr(sys, "argv", [name, *options])
    found = run(name)
    compare(name, found["numbers"], lambda group: not (small and name == "solvers" and "pavilion" in group))
    printed = capsys.readouterr().out
    first = os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK", "0")) == "0"
    assert ("Check passed" in printed) == first
    if first and name == "shade_pavilion":  # both sentences of the paper, beside cells and nodes
        assert re.findall(r"strain (\S+) in cells, (\S+) at nodes \(paper: less than 1\.0e-2\)", printed) == [
            ("1.197e-02", "1.184e-02"),
            ("1.236e-02", "1.218e-02"),
        ]
        assert re.findall(r"tension: (\d+) of 432 cells, others wrinkle; 247 of 247 nodes", printed) == ["414", "418"]
    if pictures:
        check_pictures(name)
    # On several processes one case file is enough: their numbers, stored above, are those of one process.
    if (CASES / f"{name}.toml").exists() and has_cases() and (MPI.COMM_WORLD.size == 1 or name == "cone"):
        for case, expected in expected_of(name, found).items():
            check_case(case, expected)
    if name == "patterns" and has_cases() and MPI.COMM_WORLD.size == 1:
        check_pattern("cone", found["pattern"])


@pytest.mark.parametrize("name", ["forms_alone", "dolfinx_in_and_out"])
def test_script_of_dolfinx_runs_in_a_process_of_its_own(name, tmp_path):
    """Here nothing else has imported dolfinx's modules, or found its libraries."""
    done = subprocess.run(
        [sys.executable, DEMOS / f"{name}.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "Check passed" in done.stdout


def test_every_demo_has_a_case_file_or_is_a_script_of_ones_own():
    cases = {path.stem for path in CASES.glob("*.toml") if not path.stem.startswith("cookbook_")}
    several = {case for names in STATES.values() for case in names}
    assert cases - several == set(PICTURES) - SCRIPTS.keys() - STATES.keys()
    assert several <= cases


@pytest.mark.skipif(not HAS_PYVISTA, reason="draws pictures")
def test_readme_script(tmp_path, monkeypatch, capsys):
    """The script in the README runs as printed there."""
    monkeypatch.chdir(tmp_path)
    script = (DEMOS.parent / "README.md").read_text().split("```python\n")[1].split("```")[0]
    exec(compile(script, "README.md", "exec"), {"__name__": "__main__"})
    assert "principal stress II" in capsys.readouterr().out
    assert Path("snow.png").exists()


def test_readme_forms():
    """The scripts from a plan to a shape run as printed there, and their forms are found and at rest."""
    section = (DEMOS.parent / "README.md").read_text().split("## From a plan to a shape")[1].split("\n## ")[0]
    found = {}
    for block in section.split("```python\n")[1:]:
        exec(compile(block.split("```")[0], "README.md", "exec"), found)
    assert f"{reach(0.6, 6.0, 1.5):.1f} m" in section
    for name in ("in_plan", "nearer", "soap_film", "wish", "sagging", "guyed"):
        form = found[name]
        assert form.steps[-1].stress_error < 0.1
        state = Analysis(form.structure).run([Stage("form")])["form"]
        assert state.largest_displacement < 1e-12 * 12
    assert all(found[name].converged for name in ("in_plan", "soap_film", "sagging", "guyed"))
    assert np.ptp(found["net"].points[:, 2]) == pytest.approx(3.0)


if __name__ == "__main__":
    sys.argv.append("--no-pictures")
    found = {name: run(name)["numbers"] for name in PICTURES}
    STORED.write_text(json.dumps(found, indent=1) + "\n")
