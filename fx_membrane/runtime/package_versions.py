"""Versions of everything that computes, each read apart: reports of problems matter most if something is missing."""

from __future__ import annotations

import importlib
import importlib.metadata
import importlib.util
import platform
import sys
from collections.abc import Callable

from .pipe_signal import kept_pipe_signal

OPTIONAL = {  # by module, the use of a package that need not be there
    "pydantic": "case files",
    "pint": "case files",
    "gmsh": "msh files, sails and new meshes",
    "ezdxf": "DXF files",
    "shapely": "cutting patterns",
    "plotly": "scenes for browsers",
    "jinja2": "reports",
    "weasyprint": "reports as PDF",
    "pandas": "tables as data frames",
    "imageio_ffmpeg": "animations as MP4",
    "slepc4py": "frequencies and eigenvalues",
}
DISTRIBUTIONS = {"imageio_ffmpeg": "imageio-ffmpeg"}
OF_CASES = {"pydantic", "pint"}


def versions() -> dict[str, str]:
    """Versions by name, or the reason for the absence of one."""
    rows: dict[str, Callable[[], str]] = {
        "fx_membrane": lambda: _version("fx_membrane"),
        "dolfinx": lambda: _version("dolfinx"),
        "PETSc": _petsc,
        "MPI": _mpi,
        "Python": lambda: f"{platform.python_version()} ({sys.executable})",
        "system": platform.platform,
        "numpy": lambda: _version("numpy"),
        "scipy": lambda: _version("scipy"),
        "matplotlib": lambda: _version("matplotlib"),
        "pyvista": lambda: _version("pyvista"),
        "vtk": lambda: _version("vtkmodules"),  # Debian's package of VTK has no metadata
    }
    with kept_pipe_signal():
        _told(_mpi)  # loads the library that dolfinx of the wheel looks for
        found = {name: _told(version) for name, version in rows.items()}
    return found | {name: _optional(name, use) for name, use in OPTIONAL.items()}


def reason_of_import(error: ImportError) -> str:
    """Tell why an import failed; for a package of case files that is missing, or too old, with the remedy."""
    if (error.name or "").partition(".")[0] in OF_CASES:
        return f"Case files need pydantic 2 and pint ({error}): pip install 'fx-membrane[case]'."
    return str(error)


def _optional(name: str, use: str) -> str:
    """Version of a distribution that only some commands need; it is not imported, as that may take a second."""
    try:
        return importlib.metadata.version(DISTRIBUTIONS.get(name, name))
    except importlib.metadata.PackageNotFoundError:
        missing = importlib.util.find_spec(name) is None
    # The module itself tells where there is no metadata, as of Debian's gmsh, whose library may lack another.
    return f"not installed: needed for {use}" if missing else _told(lambda: _version(name))


def _version(module: str) -> str:
    return str(importlib.import_module(module).__version__)


def _petsc() -> str:
    return ".".join(map(str, importlib.import_module("petsc4py.PETSc").Sys.getVersion()))


def _mpi() -> str:
    version: str = importlib.import_module("mpi4py.MPI").Get_library_version()
    return version.split(",", maxsplit=1)[0].strip()


def _told(version: Callable[[], str]) -> str:
    """Return a version, or the reason for its absence: reports of problems matter most if something is missing."""
    try:
        return version()
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
    except ModuleNotFoundError as error:
        return f"not installed (no module {error.name})"
    except Exception as error:
        return f"does not load: {error}"
