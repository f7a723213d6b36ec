"""The command `fx-membrane`."""

import importlib
import importlib.metadata
import json
import os
import platform
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

CASE = click.Path(dir_okay=False, path_type=Path)
TEMPLATE = """\
#:schema fx-membrane.schema.json
format = 1
title = "Flat sheet under snow"
units = { force = "kN", length = "m" }   # of plain numbers, and of all results

[geometry]           # or kind = "file", file = "roof.dxf": layers become parts
kind = "grid"
width = 4
height = 4
columns = 16
rows = 16

[materials.pvc]
kind = "fabric"
Et = "500 kN/m"
nu = 0.3

[parts.roof]
kind = "membrane"
group = "grid"
material = "pvc"
prestress = "1 kN/m"

[[supports]]
rim_of = "roof"

[[stages]]
name = "snow"
loads = [{ kind = "plan", part = "roof", load = [0, 0, "-0.6 kN/m2"] }]
"""


class _Group(click.Group):
    """Commands whose errors of input end with exit code 2, those of a solution with 1, Ctrl-C with 130."""

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command, and turn its exceptions into messages and exit codes."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            click.echo("Stopped. Saved increments stay; `fx-membrane run CASE --resume` goes on.", err=True)
            sys.exit(130)
        except (ValueError, ImportError) as error:
            code, words = 2, str(error)
        except RuntimeError as error:
            code, words = 1, str(error)
        if os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK", "0")) == "0":
            click.echo(words, err=True)
        sys.exit(code)


@click.group(cls=_Group)
@click.version_option(package_name="fx-membrane")
def main() -> None:
    """Nonlinear statics of prestressed tension structures, from case files; the README shows Python scripts."""


@main.command()
@click.argument("case", type=CASE, default="case.toml")
def init(case: Path) -> None:
    """Write a small case file to begin with, and its schema for editors beside it."""
    if case.exists():
        raise ValueError(f"{case} exists; give another name.")
    case.write_text(TEMPLATE, encoding="utf-8")
    _write_schema(case.with_name("fx-membrane.schema.json"))
    click.echo(f"Wrote {case}. Next: fx-membrane check {case}; fx-membrane run {case}")


@main.command()
@click.argument("case", type=CASE)
def check(case: Path) -> None:
    """Check a case file without computing: all faults at once, each with its line."""
    from .files.cases.case import read_case  # noqa: PLC0415  (the others must not wait for dolfinx)

    found = read_case(case)
    click.echo(f"{case}: {found.structure!r}, {len(found.stages)} stages; no faults")


@main.command()
@click.argument("case", type=CASE)
@click.option("--resume", is_flag=True, help="Go on from the checkpoint of an earlier run.")
@click.option("--overwrite", is_flag=True, help="Replace the results of an earlier run.")
@click.option("--quiet", is_flag=True, help="Say nothing while it runs.")
@click.option("--log", type=CASE, help="File for a copy of the table of results.")
def run(case: Path, resume: bool, overwrite: bool, quiet: bool, log: Path | None) -> None:
    """Run a case file: form finding, stages, and the files that it asks for."""
    from mpi4py import MPI  # noqa: PLC0415

    from .files.cases.case import read_case  # noqa: PLC0415
    from .files.cases.run import folder_of, run_case, shown  # noqa: PLC0415

    found = read_case(case)
    results = run_case(found, resume=resume, overwrite=overwrite, progress=not quiet)
    if MPI.COMM_WORLD.rank == 0:
        text = shown(found, results)
        if not quiet:
            click.echo(f"{text}\nFiles are in {folder_of(found)}")
        if log:
            log.write_text(text + "\n", encoding="utf-8")


@main.command()
@click.argument("source", type=CASE)
@click.argument("target", type=CASE)
def convert(source: Path, target: Path) -> None:
    """Convert a mesh file: from dxf, obj, stl, ply, json or msh to msh, obj or dxf, group by group."""
    from .files.convert import convert as converted  # noqa: PLC0415

    converted(source, target)
    click.echo(f"Wrote {target}")


@main.command()
@click.argument("results", type=CASE)
@click.option("--html", type=CASE, help="Write an interactive scene, one page for browsers, in the place of text.")
def show(results: Path, html: Path | None) -> None:
    """Print the checks and extremes of saved results: results.fxm of a run."""
    from .files.archive import load_results  # noqa: PLC0415
    from .files.scene.write import write_scene  # noqa: PLC0415
    from .results.checks import checks, table  # noqa: PLC0415
    from .results.report import report as told  # noqa: PLC0415
    from .results.states import StageResults  # noqa: PLC0415

    found = load_results(results)
    if not isinstance(found, StageResults):
        raise ValueError(f"{results} holds a form, without stages; give results.fxm of a run.")
    if html:
        write_scene(found, html)
        click.echo(f"Wrote {html}")
        return
    for state in found.values():
        shown = told(state, force_unit=found.force_unit, length_unit=found.length_unit)
        click.echo(f"{shown}\n{table(checks(state))}")


@main.command()
@click.argument("results", type=CASE)
@click.argument("target", type=CASE)
@click.option("--title", help="Title of the report; that of the case if not given.")
@click.option("--scene", type=CASE, help="Write an interactive scene, too, and link the report to it.")
def report(results: Path, target: Path, title: str | None, scene: Path | None) -> None:
    """Write a report of saved results as .html or .pdf."""
    from .files.archive import load_results  # noqa: PLC0415
    from .files.report.write import write_report  # noqa: PLC0415
    from .files.scene.write import write_scene  # noqa: PLC0415
    from .results.states import StageResults  # noqa: PLC0415

    found = load_results(results)
    if not isinstance(found, StageResults):
        raise ValueError(f"{results} holds a form, without stages; give results.fxm of a run.")
    title = title or found.title or "Structural analysis"
    if scene:
        write_scene(found, scene, title=title)
    force, length = found.force_unit, found.length_unit
    write_report(found, target, title=title, scene=scene, force_unit=force, length_unit=length)
    click.echo(f"Wrote {target}")


@main.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors."""
    click.echo(_schema())


def _schema() -> str:
    from .files.cases.schema import json_schema  # noqa: PLC0415

    return json.dumps(json_schema(), indent=1)


def _write_schema(file: Path) -> None:
    try:
        file.write_text(_schema() + "\n", encoding="utf-8")
    except ImportError as error:
        click.echo(f"No schema written: {error}", err=True)


@main.command()
def info() -> None:
    """Print the versions of everything that computes, for a report of a problem."""
    rows: dict[str, Callable[[], str]] = {
        "fx_membrane": lambda: importlib.metadata.version("fx-membrane"),
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
    for name, version in rows.items():
        click.echo(f"{name:12} {_told(version)}")


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
