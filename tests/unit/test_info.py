"""The command `fx-membrane info` reports the versions in use, and missing modules."""

import importlib.metadata
import re
import subprocess
import sys
import types

import dolfinx
import pytest
from click.testing import CliRunner

import fx_membrane
from fx_membrane.cli import main


def info():
    """Rows of the report by name."""
    done = CliRunner().invoke(main, ["info"], catch_exceptions=False)
    assert done.exit_code == 0
    return {line[:14].strip(): line[14:].strip() for line in done.output.splitlines()}


def test_all_that_computes_is_listed():
    rows = info()
    assert {"fx_membrane", "dolfinx", "PETSc", "MPI", "Python", "numpy", "scipy", "pyvista", "vtk"} <= set(rows)
    assert rows["numpy"] == sys.modules["numpy"].__version__


def test_module_works_like_the_command():
    """In a process of its own nothing has loaded the MPI library that dolfinx of the wheel looks for."""
    done = subprocess.run([sys.executable, "-m", "fx_membrane", "info"], capture_output=True, text=True, check=True)
    rows = {line[:14].strip(): line[14:].strip() for line in done.stdout.splitlines()}
    assert rows["fx_membrane"] == fx_membrane.__version__
    assert rows["dolfinx"] == dolfinx.__version__
    assert rows["PETSc"][0].isdigit()


def test_package_of_case_files_that_is_missing_is_told_with_the_remedy(tmp_path):
    (tmp_path / "roof.toml").write_text("format = 1\n")
    script = (
        "import sys\nfrom fx_membrane.cli import main\n"
        "for command, file, package in ('init', 'new.toml', 'pydantic'), ('check', 'roof.toml', 'pydantic'), "
        "('run', 'roof.toml', 'pint'):\n"
        "    hidden = {name: sys.modules.pop(name) for name in ('pydantic', 'pint') if name in sys.modules}\n"
        "    sys.modules[package] = None\n"
        "    try:\n        main([command, file])\n"
        "    except SystemExit as end:\n        print('ended with', end.code)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert re.findall(r"ended with (\d)", done.stdout) == ["0", "2", "2"], done.stderr
    remedy = r"Case files need pydantic 2 and pint \(.*?(pydantic|pint)\W.*?\): pip install 'fx-membrane\[case\]'\."
    assert re.findall(remedy, done.stderr) == ["pydantic", "pydantic", "pint"]


def test_vtk_without_metadata_is_found(monkeypatch):
    """Debian's python3-vtk9 is a module without metadata of a distribution."""
    debian = types.ModuleType("vtkmodules")
    monkeypatch.setattr(debian, "__version__", "9.3.0", raising=False)
    monkeypatch.setitem(sys.modules, "vtkmodules", debian)
    assert info()["vtk"] == "9.3.0"


@pytest.mark.parametrize("module", ["dolfinx", "scipy", "matplotlib", "pyvista", "vtkmodules", "petsc4py.PETSc"])
def test_missing_module_is_reported(module, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    row = {"vtkmodules": "vtk", "petsc4py.PETSc": "PETSc"}.get(module, module)
    assert "not installed" in info()[row]


def test_module_that_does_not_load_is_reported(monkeypatch, tmp_path):
    """Debian 13's pyvista beside pip's VTK, for instance."""
    (tmp_path / "pyvista.py").write_text("from math import vtkCapsuleSource\n")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "pyvista", raising=False)
    assert "vtkCapsuleSource" in info()["pyvista"]


def test_optional_packages_are_listed_with_their_use(monkeypatch):
    optional = {"pydantic", "pint", "gmsh", "ezdxf", "plotly", "jinja2", "weasyprint", "pandas"}
    assert optional <= set(info())

    def missing(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.version", missing)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    rows = info()
    assert {name: rows[name] for name in ("ezdxf", "pint")} == {
        "ezdxf": "not installed: needed for DXF files",
        "pint": "not installed: needed for case files",
    }


def test_gmsh_tells_its_version_itself():
    """The gmsh of Debian 12 has no metadata of a distribution."""
    gmsh = pytest.importorskip("gmsh")
    assert info()["gmsh"].startswith(gmsh.__version__)  # metadata of Debian 13 add ".dev1"


def test_reader_that_has_gone_is_no_crash():
    """`fx-membrane info | head -1` ended with an error of PETSc."""
    command = [sys.executable, "-m", "fx_membrane", "info"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        process.stdout.close()
        assert "PETSC" not in process.stderr.read()
        assert process.wait() in (0, 1)
