"""Commands that check and run a case."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING

import click

from .group import CASE, FILE, heed_sigterm, in_words, quoted, say, write

if TYPE_CHECKING:
    from ..files.cases.case import Case

IDLE = "a run computes nothing: it has neither form_finding nor [[stages]]; "


@click.command()
@click.argument("case", type=CASE)
def check(case: Path) -> None:
    """Check a case file without computing: all faults at once, each with its line."""
    from ..checks.values import counted  # noqa: PLC0415  (the others must not wait for dolfinx)
    from ..files.cases.case import read_case  # noqa: PLC0415
    from ..results.strain_limits import warn_of_large_prestress  # noqa: PLC0415

    found = read_case(case)
    for doubt in found.doubts:
        say(f"Warning: {doubt}.", err=True)
    warn_of_large_prestress(found.structure, stacklevel=1)
    steps = f"{counted(len(found.steps), 'step')} of form finding, " if found.steps else ""
    idle = "" if found.steps or found.stages else f", but {_idle(found)}"
    say(f"{case}: {found.structure!r}, {steps}{counted(len(found.stages), 'stage')}; no faults{idle}")


@click.command()
@click.argument("case", type=CASE)
@click.option("--resume", is_flag=True, help="Go on with an earlier run where it stopped; begin if there is none.")
@click.option("--overwrite", is_flag=True, help="Delete an earlier run, with all it has saved, and begin anew.")
@click.option("--quiet", is_flag=True, help="Print warnings and errors only.")
@click.option("--log", type=FILE, help="File for a copy of the table of results.")
def run(case: Path, resume: bool, overwrite: bool, quiet: bool, log: Path | None) -> None:
    """Run a case file: form finding, stages, and the files that it asks for."""
    from ..analysis.convergence_error import ConvergenceError  # noqa: PLC0415
    from ..checks import paths  # noqa: PLC0415
    from ..files.cases.case import read_case  # noqa: PLC0415
    from ..files.cases.run import files_of, folder_of, run_case  # noqa: PLC0415
    from ..files.form_words import form_at, form_text  # noqa: PLC0415
    from ..results.table_of_run import exceeded, overview  # noqa: PLC0415
    from ..runtime.messages import silence  # noqa: PLC0415
    from ..runtime.processes import by_the_first  # noqa: PLC0415

    heed_sigterm()
    if resume and overwrite:
        raise ValueError("--resume goes on with an earlier run, and --overwrite deletes it; give one of them.")
    if log:
        paths.check_writable("--log", log)
    with silence(quiet):
        found = read_case(case)
    for doubt in found.doubts:
        say(f"Warning: {doubt}.", err=True)
    if not (found.steps or found.stages):
        raise ValueError(f"{case}: {_idle(found)}.")
    failure = None
    try:
        results = run_case(found, resume=resume, overwrite=overwrite, progress=not quiet)
    except ConvergenceError as error:
        results, failure = error.results, error

    form = None if found.stages else form_at(folder_of(found))
    text = overview(results) if form is None else form_text(form)

    @by_the_first
    def tell() -> None:
        if text and not quiet:
            say(f"{text}\n{_after(folder_of(found), files_of(found, results), found.stages)}")
        if log:
            write(log, "\n".join(filter(None, (text, in_words(str(failure or ""))))) + "\n")

    tell()
    if failure:
        raise failure
    if missed := exceeded(results):
        raise RuntimeError(f"Limits of the design are exceeded: {'; '.join(missed)}. The computation is complete.")


@click.command()
@click.argument("case", type=CASE)
@click.option("--overwrite", is_flag=True, help="Replace the files of an earlier cutting pattern.")
@click.option("--quiet", is_flag=True, help="Print warnings and errors only.")
def patterns(case: Path, overwrite: bool, quiet: bool) -> None:
    """Make the cutting pattern of a case, and prove it: DXF, sheets, tables, and the stress after assembly."""
    from ..files.cases.case import read_case  # noqa: PLC0415
    from ..files.cases.pattern_run import run_patterns  # noqa: PLC0415
    from ..files.cases.run import folder_of  # noqa: PLC0415
    from ..files.patterns.proof_files import FOLDER  # noqa: PLC0415
    from ..patterns.proof_tables import text  # noqa: PLC0415
    from ..runtime.messages import silence  # noqa: PLC0415
    from ..runtime.processes import by_the_first  # noqa: PLC0415

    heed_sigterm()
    with silence(quiet):
        found = read_case(case)
    for doubt in found.doubts:
        say(f"Warning: {doubt}.", err=True)
    proof = run_patterns(found, overwrite=overwrite, progress=not quiet)

    @by_the_first
    def tell() -> None:
        if quiet:
            for words in proof.remarks:
                say(f"Warning: {words}", err=True)
            return
        folder = folder_of(found) / FOLDER
        files = ", ".join(sorted(path.name for path in folder.iterdir()))
        say(f"{text(proof)}\nFiles in {folder}: {files}")

    tell()
    if found.patterns and (missed := found.patterns.missed(proof)):
        raise RuntimeError(f"Limits of the design are exceeded: {'; '.join(missed)}. All files are written.")


def _after(folder: Path, names: Collection[str], stages: Collection[object]) -> str:
    """Lines on the files of a run in its folder, and the commands that come next."""
    files, place = ", ".join(sorted(path.name for path in folder.iterdir() if path.name in names)), quoted(folder)
    following = f"fx-membrane report {place} report.html" if stages else f"fx-membrane show {place} --html form.html"
    lines = [f"Files in {folder}: {files}", f"Next: fx-membrane show {place}; {following}"]
    if (folder / "paraview").is_dir() and "paraview" in names:
        lines[1] += f"; paraview {quoted(folder / 'paraview' / 'series.pvd')}"
    return "\n".join(lines)


def _idle(case: Case) -> str:
    """Clause on a case whose run computes nothing."""
    return IDLE + ("`fx-membrane patterns` makes its cutting pattern" if case.patterns else "add one")
