"""Case files of the cookbook give the numbers of its scripts."""

import runpy
import shutil
from pathlib import Path

import pytest

from demo_cases import CASES, check_case, has_cases
from fx_membrane import WorkLimit

SCRIPTS = Path(__file__).parent.parent / "demos" / "cookbook"
BY_GMSH = {"cone", "tilted_masts"}
pytestmark = pytest.mark.skipif(not has_cases(), reason="pydantic 2 and pint read case files")


def test_each_script_has_a_case_file():
    found = {path.stem.removeprefix("cookbook_") for path in CASES.glob("cookbook_*.toml")}
    assert found == {path.stem for path in SCRIPTS.glob("*.py")}


@pytest.mark.parametrize("name", ["cone", "cushion", "load_cases", "restart", "tilted_masts"])
def test_case_gives_the_numbers_of_the_script(name, tmp_path, monkeypatch):
    if name in BY_GMSH:
        pytest.importorskip("gmsh")
    monkeypatch.chdir(tmp_path)
    found = runpy.run_path(str(SCRIPTS / f"{name}.py"))
    if name == "restart":
        from fx_membrane.files.cases import from_data  # noqa: PLC0415
        from fx_membrane.files.cases.case import read_case  # noqa: PLC0415

        assert read_case(CASES / "cookbook_restart.toml").work.iterations == 14
        monkeypatch.setattr(from_data, "WorkLimit", lambda **_: WorkLimit())  # the run that goes on has none
    check_case(f"cookbook_{name}", found["direct" if name == "restart" else "results"])


def test_case_gives_the_numbers_of_the_roof_from_gmsh(tmp_path, monkeypatch):
    """On the mesh of the script, as versions of gmsh mesh differently; that of the case is from gmsh 4.8."""
    pytest.importorskip("gmsh")
    monkeypatch.chdir(tmp_path)
    results = runpy.run_path(str(SCRIPTS / "gmsh_roof.py"))["results"]
    shutil.copy(CASES / "cookbook_gmsh_roof.toml", tmp_path)
    (tmp_path / "roof.msh").rename("cookbook_gmsh_roof.msh")
    check_case("cookbook_gmsh_roof", results, tmp_path)


def test_roof_from_gmsh_runs_on_its_own_mesh():
    pytest.importorskip("gmsh")
    from fx_membrane.files.cases.case import read_case  # noqa: PLC0415

    structure = read_case(CASES / "cookbook_gmsh_roof.toml").structure
    assert {name: len(part.cells) for name, part in structure.parts.items()} == {"roof": 386, "edges": 54}
