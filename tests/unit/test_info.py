"""The command `fx-membrane info` reports the versions in use, and missing modules."""

import importlib.metadata
import subprocess
import sys
import types

import pytest
from click.testing import CliRunner

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
    done = subprocess.run([sys.executable, "-m", "fx_membrane", "info"], capture_output=True, text=True, check=True)
    assert "fx_membrane" in done.stdout


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
