"""Run of a case: form finding, stages and the files that they leave."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mpi4py import MPI

from ... import Form, write_scene
from ...analysis.convergence_error import ConvergenceError
from ...analysis.stages import Analysis
from ...checks import paths
from ...checks.values import counted
from ...model.stages import Stage
from ...model.structure import Structure
from ...results.states import StageResult, StageResults
from ...runtime.messages import say, silence
from ...runtime.processes import by_the_first, together
from ...solvers.progress import Pulse
from .. import unfinished_run
from ..archive import load_results, save_results
from ..file_names import safe_name
from ..mesh_writer import write_mesh
from ..paraview import ParaViewSeries
from ..patterns.proof_files import FOLDER as PATTERNS
from ..patterns.proof_files import drop_proof
from ..run_results import CHECKPOINT, FORM, RESULTS
from ..tables import TABLES, write_tables
from ..unfinished_run import KeptStates
from ..whole_file import writing
from .case import Case
from .pictures import SCENE, check_drawing, drawings

FORM_KEY = "form.sha256"


def folder_of(case: Case) -> Path:
    """Folder of the results of a case: that of its output, or that of its own name, beside the case file."""
    return case.file.parent / (case.output.folder or case.file.stem)


def run_case(case: Case, *, resume: bool = False, overwrite: bool = False, progress: bool = True) -> StageResults:
    """Find the form of a case, run its stages, and write the files that it asks for.

    Every increment is kept in a checkpoint file. A failed run writes what it has before it raises.

    Args:
        case: The case.
        resume: Go on from the checkpoint of an earlier run; begin if there is none.
        overwrite: Delete the checkpoint and the results of an earlier run, and begin anew.
        progress: Report the progress on stderr.

    Raises:
        ValueError: There are results of an earlier run, and neither resume nor overwrite is given; a file cannot be
            written; the stages do not fit the structure.
        ConvergenceError: A stage found no equilibrium.
        RuntimeError: Form finding found no shape.
        ImportError: A package that an output needs is not installed.
    """
    folder = folder_of(case)
    with together(MPI.COMM_WORLD):
        check_drawing(case.output)
        if MPI.COMM_WORLD.rank == 0:
            _prepare(folder, resume, overwrite)
    with silence(not progress):
        say(f"Results go to {folder}")
        structure, stages = _formed(case, folder, resume)
        if not stages:
            return _form_alone(case, folder)
        return _analysed(case, folder, structure, stages, resume, progress)


def _form_alone(case: Case, folder: Path) -> StageResults:
    """Write the meshes and the scene of a form that no stage follows, which has nothing else to tell."""
    form = load_results(folder / FORM)
    output = case.output
    lacking = [name for name in ("paraview", "report", "pictures", "animation") if getattr(output, name)]
    if lacking:
        names = ", ".join(f"output.{name}" for name in lacking)
        say(f"There are no stages for {names}; add [[stages]] for these files.")
    for ending in output.mesh:
        write_mesh(form, folder / f"form.{ending}", length_unit=case.length_unit)
    if output.scene:
        write_scene(form, folder / SCENE, title=case.title or None)
    return StageResults()


def _analysed(
    case: Case, folder: Path, structure: Structure, stages: Sequence[Stage], resume: bool, progress: bool
) -> StageResults:
    series = None
    wanted = case.output.paraview
    if wanted or (wanted is None and find_spec("pyvista")):  # without a word in the file, where it can be written
        series = ParaViewSeries(folder / "paraview", resume, force_unit=case.force_unit, length_unit=case.length_unit)
    kept = KeptStates(folder, stages, _headed(case, StageResults()))

    def observe(state: StageResult) -> None:
        kept(state)
        if series:
            series(state)

    analysis = Analysis(structure, case.solver, limit=case.work, progress=progress)
    try:
        results = analysis.run(stages, folder / CHECKPOINT, observe)
    except ConvergenceError as error:
        if failed := _write(case, folder, error.results):
            say(failed)
        raise
    except KeyboardInterrupt:
        if MPI.COMM_WORLD.rank == 0:
            kept.keep_last()
        raise
    failed = _write(case, folder, results)
    if failed:
        raise ValueError(f"{failed}\nThe checkpoint has the states: mend this, then run with --resume.")
    return results


def _prepare(folder: Path, resume: bool, overwrite: bool) -> None:
    paths.check_writable("folder", folder / CHECKPOINT)
    there = [name for name in (CHECKPOINT, RESULTS, FORM) if (folder / name).exists()]
    if there and not (resume or overwrite):
        run = "the results of an earlier run" if RESULTS in there else "an earlier run that has not ended"
        run = "the form of an earlier run" if there == [FORM] else run
        raise ValueError(
            f"{folder} has {run} ({', '.join(there)}); give --resume to go on with it, or --overwrite to delete it and "
            "begin anew."
        )
    if not resume:
        shutil.rmtree(folder / unfinished_run.FOLDER, ignore_errors=True)
    if overwrite and not resume:
        for name in (CHECKPOINT, CHECKPOINT + "-journal", RESULTS, FORM, FORM_KEY, *TABLES):
            (folder / name).unlink(missing_ok=True)
        drop_proof(folder / PATTERNS)  # of the form before
    folder.mkdir(parents=True, exist_ok=True)


def _formed(case: Case, folder: Path, resume: bool) -> tuple[Structure, Sequence[Stage]]:
    """Structure in its found form, that of an earlier run if it goes on, and its stages."""
    if not case.steps:
        return case.structure, case.stages
    found: Any = None
    if resume and (folder / FORM).exists():
        with together(MPI.COMM_WORLD):
            _check_key(case, folder)
        found = load_results(folder / FORM)
    else:
        form: Any = case.form(partial(_tell, case))
        found = replace(form, force_unit=case.force_unit, length_unit=case.length_unit)
        save_results(found, folder / FORM)
        _write_key(case, folder)
    return found.structure, case.stages_of(found.structure)


def _check_key(case: Case, folder: Path) -> None:
    """Refuse to go on with the form of another case."""
    key = folder / FORM_KEY
    if not key.exists() or key.read_text(encoding="utf-8") != case.form_key:
        raise ValueError(
            f"{folder / FORM} is the form of another case: geometry, parts or form finding have changed since; give "
            "--overwrite to find it anew."
        )


@by_the_first
def _write_key(case: Case, folder: Path) -> None:
    with writing(folder / FORM_KEY, encoding="utf-8") as stream:
        stream.write(case.form_key)


def _tell(case: Case, number: int, form: Form) -> None:
    """Report a step of form finding."""
    of = f" {number + 1} of {len(case.steps)}" if len(case.steps) > 1 else ""
    steps = f"{counted(len(form.steps), 'step')}, " if form.steps else ""
    say(f"form finding{of}: {case.methods[number]}, {steps}{'' if form.converged else 'not '}converged")


def _write(case: Case, folder: Path, results: StageResults) -> str:
    """Write the files that a case asks for, each although another fails; return what failed, empty if none."""
    if not results and not results.failure:
        return ""
    _headed(case, results)
    failed = []
    pulse = Pulse("writing", shown=MPI.COMM_WORLD.rank == 0)
    for write in _writers(case, folder, results):
        try:
            (pulse.tell if _drawn(write) else pulse)(_words(write))
            write()
        except (ValueError, ImportError, OSError) as error:
            failed.append(str(error))
    if not failed:
        unfinished_run.drop(folder)
    return "\n".join(failed)


def _headed(case: Case, results: StageResults) -> StageResults:
    """Give results the title, the units and the limits of a case."""
    results.title, results.force_unit, results.length_unit = case.title, case.force_unit, case.length_unit
    results.limits = case.limits
    return results


def files_of(case: Case, results: StageResults) -> set[str]:
    """Names of the files and folders that a run leaves in its folder; others there are not its own."""
    folder = folder_of(case)
    given = [entry for write in _writers(case, folder, results) if isinstance(write, partial) for entry in write.args]
    own = {entry.name for entry in given if isinstance(entry, Path)}
    own |= {f"form.{ending}" for ending in case.output.mesh} | {SCENE}
    return own | {CHECKPOINT, RESULTS, FORM, FORM_KEY, "paraview", *TABLES}


def _drawn(write: Callable[[], None]) -> bool:
    """Tell the files that take seconds each, pictures and reports, from the others."""
    return _words(write).endswith((".png", ".gif", ".mp4", ".html", ".pdf"))


def _words(write: Callable[[], None]) -> str:
    """Name the file that a writer is about to write."""
    given = write.args if isinstance(write, partial) else ()
    return next((entry.name for entry in given if isinstance(entry, Path)), "results")


def _writers(case: Case, folder: Path, results: StageResults) -> Iterator[Callable[[], None]]:
    units = {"force_unit": case.force_unit, "length_unit": case.length_unit}
    if case.output.archive:
        yield partial(save_results, results, folder / RESULTS)
    if case.output.tables:
        yield partial(write_tables, results, folder, **units)
    for ending in case.output.mesh:
        for number, state in enumerate(results.states.values()):
            file = folder / f"{safe_name(number, state.name)}.{ending}"
            yield partial(write_mesh, state, file, length_unit=case.length_unit)
    yield from drawings(case.output, results, folder)
