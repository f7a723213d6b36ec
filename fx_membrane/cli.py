"""The command `fx-membrane`."""

import json
import os
import sys
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import click

CASE = click.Path(dir_okay=False, path_type=Path)
RESULTS = click.Path(path_type=Path)  # a folder, or the archive in it
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

    def main(self, *arguments: Any, **settings: Any) -> Any:
        """Run the command line; an output that cannot be written, as on a full disk, is one sentence."""
        try:
            return super().main(*arguments, **settings)
        except OSError as error:
            with suppress(OSError, ValueError):  # Python writes again what is left when it ends
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            with suppress(OSError):
                _say(f"The output cannot be written ({error.strerror}); make room, or send it elsewhere.", err=True)
            sys.exit(2)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command, and turn its warnings and exceptions into lines, the latter with exit codes."""
        try:
            with warnings.catch_warnings():
                warnings.showwarning = _warn  # type: ignore[assignment]  # of the same arguments
                return super().invoke(ctx)
        except KeyboardInterrupt:
            later = " Saved increments stay: `fx-membrane run CASE --resume` goes on, --overwrite begins anew."
            code, words = 130, "Stopped." + later * (ctx.invoked_subcommand == "run")
        except (ValueError, ImportError) as error:
            code, words = 2, str(error)
        except OSError as error:
            if error.filename is None:  # the output itself
                raise
            code, words = 2, f"{error.filename}: {error.strerror}; give another place."
        except RuntimeError as error:
            code, words = 1, str(error)
        _say(_of_files(words), err=True)
        sys.exit(code)


def _say(words: str, err: bool = False) -> None:
    """Print on the first process only."""
    if os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK", "0")) == "0":
        click.echo(words, err=err)


def _once(act: Callable[[], None]) -> None:
    """Act on the first process only; MPI is loaded under mpirun alone."""
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", os.environ.get("PMI_SIZE", "1"))) == 1:
        act()
        return
    from .runtime.processes import by_the_first  # noqa: PLC0415

    by_the_first(act)()


def _warn(message: Warning | str, *_: Any) -> None:
    _say(f"Warning: {_of_files(str(message))}", err=True)


def _of_files(words: str) -> str:
    """Put a message of the package, which speaks of Python, in words of case files."""
    from .files.cases.wording import in_keys_of_files  # noqa: PLC0415

    return in_keys_of_files(words)


@click.group(cls=_Group)
@click.version_option(package_name="fx-membrane")
def main() -> None:
    """Nonlinear statics of prestressed tension structures, from case files; the README shows Python scripts.

    Exit codes: 0 done, also with warnings; 1 no equilibrium, no shape, or a limit of the design exceeded; 2 input
    refused, or a file not written; 130 stopped.
    """


@main.command()
@click.argument("case", type=CASE, default="case.toml")
def init(case: Path) -> None:
    """Write a small case file to begin with, and its schema for editors beside it."""

    def write() -> None:
        if case.exists():
            raise ValueError(f"{case} exists; give another name.")
        _write(case, TEMPLATE)
        _write_schema(case.parent)

    _once(write)
    _say(f"Wrote {case}. Next: {_next(case)}")


@main.command()
@click.argument("name", required=False)
@click.option("--run", "at_once", is_flag=True, help="Run it at once.")
@click.pass_context
def demo(ctx: click.Context, name: str | None, at_once: bool) -> None:
    """List the demo cases, or write one in this folder."""
    from .files.demo_cases import SCRIPTS, demo_files, demos, write_demo  # noqa: PLC0415

    if name is None:
        for entry, title in demos().items():
            _say(f"{entry:18} {title}")
        scripts = ", ".join(f"{entry} ({words})" for entry, words in SCRIPTS.items())
        _say(f"\nWrite one: fx-membrane demo NAME. As scripts only, in demos/ of the sources: {scripts}.")
        return
    files = demo_files(name, Path())

    def write() -> None:
        write_demo(name, Path())
        _write_schema(Path())

    _once(write)
    _say(f"Wrote {', '.join(map(str, files))}." + ("" if at_once else f" Next: {_next(files[0])}"))
    if at_once:
        ctx.invoke(run, case=files[0], resume=False, overwrite=False, quiet=False, log=None)


def _next(case: Path) -> str:
    return f"fx-membrane check {case}; fx-membrane run {case}"


@main.command()
@click.argument("case", type=CASE)
def check(case: Path) -> None:
    """Check a case file without computing: all faults at once, each with its line."""
    from .checks.values import counted  # noqa: PLC0415  (the others must not wait for dolfinx)
    from .files.cases.case import read_case  # noqa: PLC0415

    found = read_case(case)
    steps = f"{counted(len(found.steps), 'step')} of form finding, " if found.steps else ""
    _say(f"{case}: {found.structure!r}, {steps}{counted(len(found.stages), 'stage')}; no faults")


@main.command()
@click.argument("case", type=CASE)
@click.option("--resume", is_flag=True, help="Go on with an earlier run where it stopped; begin if there is none.")
@click.option("--overwrite", is_flag=True, help="Delete an earlier run, with all it has saved, and begin anew.")
@click.option("--quiet", is_flag=True, help="Print warnings and errors only.")
@click.option("--log", type=CASE, help="File for a copy of the table of results.")
def run(case: Path, resume: bool, overwrite: bool, quiet: bool, log: Path | None) -> None:
    """Run a case file: form finding, stages, and the files that it asks for."""
    from .analysis.convergence_error import ConvergenceError  # noqa: PLC0415
    from .checks import paths  # noqa: PLC0415
    from .files.cases.case import read_case  # noqa: PLC0415
    from .files.cases.run import folder_of, run_case  # noqa: PLC0415
    from .results.overview import exceeded, overview  # noqa: PLC0415
    from .runtime.processes import by_the_first  # noqa: PLC0415

    if resume and overwrite:
        raise ValueError("--resume goes on with an earlier run, and --overwrite deletes it; give one of them.")
    if log:
        paths.check_writable("--log", log)
    found = read_case(case)
    failure = None
    try:
        results = run_case(found, resume=resume, overwrite=overwrite, progress=not quiet)
    except ConvergenceError as error:
        results, failure = error.results, error

    @by_the_first
    def tell() -> None:
        text = overview(results)
        if text and not quiet:
            _say(f"{text}\n{_after(folder_of(found))}")
        if log:
            _write(log, "\n".join(filter(None, (text, _of_files(str(failure or ""))))) + "\n")

    tell()
    if failure:
        raise failure
    if missed := exceeded(results):
        raise RuntimeError(f"Limits of the design are exceeded: {'; '.join(missed)}. The computation is complete.")


def _write(file: Path, text: str) -> None:
    """Write a whole file or none."""
    from .files.whole_file import writing  # noqa: PLC0415

    with writing(file, encoding="utf-8", errors="backslashreplace") as stream:
        stream.write(text)


def _after(folder: Path) -> str:
    """Lines on the files in a folder of results, and the commands that come next."""
    files = ", ".join(sorted(path.name for path in folder.iterdir()))
    lines = [f"Files in {folder}: {files}", f"Next: fx-membrane show {folder}; fx-membrane report {folder} report.html"]
    if (folder / "paraview").is_dir():
        lines[1] += f"; paraview {folder / 'paraview' / 'series.pvd'}"
    return "\n".join(lines)


@main.command()
@click.argument("source", type=CASE)
@click.argument("target", type=CASE)
@click.option("--unit", help="Unit of length of the target, as m or mm; for a source that names its own, as DXF.")
def convert(source: Path, target: Path, unit: str | None) -> None:
    """Convert a mesh file: from dxf, obj, stl, ply, json or msh to msh, obj or dxf, group by group."""
    from .files.convert import convert as converted  # noqa: PLC0415

    converted(source, target, unit)
    _say(f"Wrote {target}")


@main.command()
@click.argument("results", type=RESULTS)
@click.option("--html", type=CASE, help="Write an interactive scene, one page for browsers, in the place of text.")
def show(results: Path, html: Path | None) -> None:
    """Print the checks and extremes of saved results: the folder of a run, or its results.fxm."""
    from .files.run_results import results_of  # noqa: PLC0415
    from .files.scene.write import write_scene  # noqa: PLC0415
    from .results.overview import states_and_checks  # noqa: PLC0415

    found = results_of(results)
    if html:
        write_scene(found, html)
        _say(f"Wrote {html}")
        return
    _say(states_and_checks(found))


@main.command()
@click.argument("results", type=RESULTS)
@click.argument("target", type=CASE)
@click.option("--title", help="Title of the report; that of the case if not given.")
@click.option("--scene", type=CASE, help="Write an interactive scene, too, and link the report to it.")
def report(results: Path, target: Path, title: str | None, scene: Path | None) -> None:
    """Write a report of saved results, the folder of a run or its results.fxm, as .html or .pdf."""
    from .files.report.write import write_report  # noqa: PLC0415
    from .files.run_results import results_of  # noqa: PLC0415
    from .files.scene.write import write_scene  # noqa: PLC0415

    found = results_of(results)
    if scene:
        write_scene(found, scene, title=title)
    write_report(found, target, title=title, scene=scene)
    _say(f"Wrote {target}")


@main.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors."""
    _say(_schema())


def _schema() -> str:
    from .files.cases.schema import json_schema  # noqa: PLC0415

    return json.dumps(json_schema(), indent=1)


def _write_schema(folder: Path) -> None:
    try:
        _write(folder / "fx-membrane.schema.json", _schema() + "\n")
    except ImportError as error:
        _say(f"No schema written: {error}", err=True)


@main.command()
def info() -> None:
    """Print the versions of everything that computes, for a report of a problem."""
    from .runtime.versions import versions  # noqa: PLC0415

    for name, version in versions().items():
        _say(f"{name:14} {version}")


if __name__ == "__main__":
    main()
