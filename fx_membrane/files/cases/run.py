"""Run of a case: form finding, stages and the files that they leave."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mpi4py import MPI

from ...analysis.convergence_error import ConvergenceError
from ...analysis.stages import Analysis
from ...checks import paths
from ...results.checks import checks, table
from ...results.states import StageResult, StageResults
from ...runtime.messages import say
from ...runtime.processes import together
from ..archive import load_results, save_results
from ..mesh_writer import write_mesh
from ..paraview import ParaViewSeries
from ..run_results import RESULTS
from ..tables import write_tables
from .case import Case

CHECKPOINT, FORM = "checkpoint.sqlite", "form.fxm"


def folder_of(case: Case) -> Path:
    """Folder of the results of a case: that of its output, or that of its own name, beside the case file."""
    return case.file.parent / (case.output.folder or case.file.stem)


def run_case(case: Case, *, resume: bool = False, overwrite: bool = False, progress: bool = True) -> StageResults:
    """Find the form of a case, run its stages, and write the files that it asks for.

    Every increment is kept in a checkpoint file. A failed run writes what it has before it raises.

    Args:
        case: The case.
        resume: Go on from the checkpoint of an earlier run.
        overwrite: Replace the results of an earlier run.
        progress: Report the progress on stderr.

    Raises:
        ValueError: There are results of an earlier run, and neither resume nor overwrite is given; a file cannot be
            written; the stages do not fit the structure.
        ConvergenceError: A stage found no equilibrium.
        RuntimeError: Form finding found no shape.
    """
    folder = folder_of(case)
    with together(MPI.COMM_WORLD):
        if MPI.COMM_WORLD.rank == 0:
            _prepare(folder, resume, overwrite)
    structure = _formed(case, folder, resume)
    series = None
    wanted = case.output.paraview
    if wanted or (wanted is None and find_spec("pyvista")):  # without a word in the file, where it can be written
        series = ParaViewSeries(folder / "paraview", resume, force_unit=case.force_unit, length_unit=case.length_unit)
    results = StageResults()
    try:
        results = Analysis(structure, case.solver, progress=progress).run(case.stages, folder / CHECKPOINT, series)
    except ConvergenceError as error:
        results = error.results
        raise
    finally:
        _write(case, folder, results)
    return results


def shown(case: Case, results: StageResults) -> str:
    """Table of all stages, and the checks of each, to print."""
    return "\n".join(line for state in results.values() for line in _shown(case, state))


def _shown(case: Case, state: StageResult) -> list[str]:
    iterations = sum(len(entry.iterations) - 1 + entry.extra_iterations for entry in state.increments)
    largest = f"{state.largest_displacement:.4g} {case.length_unit}"
    head = f"Stage {state.name!r}: {len(state.increments)} increments, {iterations} iterations, moves up to {largest}"
    return [head, *_parts(case, state), table(checks(state))]


def _parts(case: Case, state: StageResult) -> list[str]:
    width = max(map(len, state.parts)) + 2
    lines = []
    for name, found in state.parts.items():
        values = found.principal
        per = "" if found.dimension == 1 else f"/{case.length_unit}"
        lines.append(f"  {name:{width}}{values.min():12.5g} to {values.max():12.5g} {case.force_unit}{per}")
    return lines


def _prepare(folder: Path, resume: bool, overwrite: bool) -> None:
    paths.check_writable("folder", folder / CHECKPOINT)
    there = [name for name in (CHECKPOINT, RESULTS, FORM) if (folder / name).exists()]
    if there and not (resume or overwrite):
        raise ValueError(
            f"{folder} has results of an earlier run ({', '.join(there)}); give --resume to go on with them, or "
            "--overwrite."
        )
    if overwrite and not resume:
        for name in (CHECKPOINT, CHECKPOINT + "-journal", RESULTS, FORM):
            (folder / name).unlink(missing_ok=True)
    folder.mkdir(parents=True, exist_ok=True)


def _formed(case: Case, folder: Path, resume: bool) -> Any:
    """Structure in its found form, that of an earlier run if it goes on."""
    if case.form_method is None:
        return case.structure
    if resume and (folder / FORM).exists():
        return load_results(folder / FORM).structure
    form = case.form()
    assert form is not None
    say(f"Form found in {len(form.steps)} steps, converged: {form.converged}")
    save_results(form, folder / FORM)
    return form.structure


def _write(case: Case, folder: Path, results: StageResults) -> None:
    if not results:
        return
    results.title, results.force_unit, results.length_unit = case.title, case.force_unit, case.length_unit
    if case.output.archive:
        save_results(results, folder / RESULTS)
    if case.output.tables:
        write_tables(results, folder, force_unit=case.force_unit, length_unit=case.length_unit)
    for ending in case.output.mesh:
        for number, state in enumerate(results.values()):
            write_mesh(state, folder / f"{number:02d}.{ending}")
