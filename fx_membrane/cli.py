"""The command `fx-membrane`."""

import importlib.metadata
import platform
import sys

import click
import dolfinx
from mpi4py import MPI
from petsc4py import PETSc


@click.group()
@click.version_option(package_name="fx-membrane")
def main() -> None:
    """Nonlinear statics of prestressed tension structures. Structures are written as Python scripts; see the README."""


@main.command()
def info() -> None:
    """Print the versions of everything that computes, for a report of a problem."""
    rows = {
        "fx_membrane": importlib.metadata.version("fx-membrane"),
        "dolfinx": dolfinx.__version__,
        "PETSc": ".".join(map(str, PETSc.Sys.getVersion())),
        "MPI": MPI.Get_library_version().split(",")[0].strip(),
        "Python": f"{platform.python_version()} ({sys.executable})",
        "system": platform.platform(),
    }
    for name in ("numpy", "scipy", "matplotlib", "pyvista", "vtk"):
        try:
            rows[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            rows[name] = "not installed"
    for name, version in rows.items():
        click.echo(f"{name:12} {version}")
