"""Run of the cutting pattern of a case: form, strips, cloth, files and proof."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from mpi4py import MPI

from ...analysis.convergence_error import ConvergenceError
from ...checks import paths
from ...checks.values import counted
from ...form_finding.form import Form
from ...model.structure import Structure
from ...patterns.cut_lines import load_shapely
from ...patterns.flat_strips import CuttingPattern
from ...patterns.outline_fitting import nearest_stress_pattern
from ...patterns.proofs import PatternProof, prove_pattern
from ...plot.proof_pictures import draw_proof
from ...runtime.messages import say, silence
from ...runtime.processes import by_the_first, together
from ..archive import load_results, save_results
from ..patterns.proof_files import FOLDER, PROOF, drop_pattern, write_proof
from ..patterns.saved_patterns import PATTERN_FILE, PROOF_FILE
from ..patterns.write import write_patterns
from ..run_results import FORM
from .case import Case
from .patterns import PatternPlan
from .run import FORM_KEY, folder_of


def run_patterns(case: Case, *, overwrite: bool = False, progress: bool = True) -> PatternProof:
    """Make the cutting pattern of a case, write its files, and prove it.

    The form is that of an earlier run, if it is the same, or found. The files go to `patterns` in the folder of the
    case: those of `write_patterns`; pattern.fxm and proof.fxm, archives to go on from; proof.txt, proof.json; and the
    pictures of `plot.pattern_proof`. A pattern that is refused leaves none.

    Args:
        case: The case.
        overwrite: Replace the files of an earlier pattern.
        progress: Report the progress on stderr.

    Raises:
        ValueError: The case asks for no cutting pattern; there are files of an earlier one; as of `cut_strips`,
            `cutting_pattern` and `write_patterns`.
        ConvergenceError: The strips sewn together find no equilibrium; the files of the pattern are written.
        RuntimeError: Form finding found no shape, or flattening no shape of least energy.
        ImportError: shapely or ezdxf is not installed.
    """
    if case.patterns is None:
        raise ValueError(f"{case.file}: the case asks for no cutting pattern; add a table [patterns] with its seams.")
    folder = folder_of(case) / FOLDER
    with together(MPI.COMM_WORLD):
        _check_packages()
        if MPI.COMM_WORLD.rank == 0:
            _prepare(folder, overwrite)
    with silence(not progress):
        say(f"Cutting pattern goes to {folder}")
        shape = _form(case)
        try:
            proof = _proved(case, case.patterns, shape, folder, progress)
        except ValueError:  # a refused pattern leaves nothing that the next run would ask to overwrite
            by_the_first(drop_pattern)(folder)
            raise
        save_results(proof, folder / PROOF_FILE)
        write_proof(proof, folder)
        if find_spec("pyvista"):
            by_the_first(draw_proof)(proof, folder)
    return proof


def _proved(case: Case, plan: PatternPlan, shape: Structure | Form, folder: Path, progress: bool) -> PatternProof:
    """Make the pattern of a shape and its files, and prove it."""
    with _named(case):
        pattern = _with_units(case, plan.pattern(shape))
        save_results(pattern, folder / PATTERN_FILE)
        say(f"{counted(len(pattern.cloth), 'strip')} flattened")
        if plan.nearest_stress:
            pattern = _nearest(pattern, plan, progress)
            save_results(pattern, folder / PATTERN_FILE)
        settings = {"project": case.title} | plan.files
        write_patterns(pattern, folder, plan.allowances, **settings)
    return prove_pattern(
        pattern,
        plan.loads,
        changes=plan.changes,
        strength=plan.strength_of(pattern, case.limits),
        roll_width=plan.sewn_width,
        progress=progress,
        **plan.proof,
    )


def _with_units(case: Case, pattern: CuttingPattern) -> CuttingPattern:
    """Name the units of a case in its pattern."""
    strips = replace(pattern.strips, force_unit=case.force_unit, length_unit=case.length_unit)
    return replace(pattern, strips=strips)


def _nearest(pattern: CuttingPattern, plan: PatternPlan, progress: bool) -> CuttingPattern:
    """Pattern whose stress is nearest to the design; the given one, whose proof will fail, without equilibrium."""
    try:
        return nearest_stress_pattern(pattern, plan.loads, progress=progress)
    except ConvergenceError:
        return pattern


@contextmanager
def _named(case: Case) -> Iterator[None]:
    """Name the table of the case in errors."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{case.file}: patterns: {error}") from None


def _form(case: Case) -> Structure | Form:
    """Found form, that of an earlier run if it is of the same case; the structure itself without form finding."""
    if not case.steps:
        return case.structure
    folder = folder_of(case)
    key = folder / FORM_KEY
    if (folder / FORM).exists() and key.exists() and key.read_text(encoding="utf-8") == case.form_key:
        say(f"form of {folder / FORM}")
        found: Form = load_results(folder / FORM)
        return found
    form = case.form()
    assert form is not None
    say(f"form finding: {'' if form.converged else 'not '}converged")
    return form


def _check_packages() -> None:
    missing = [name for name in ("shapely", "ezdxf") if not find_spec(name)]
    if missing:
        raise ImportError(
            f"Cutting patterns need the package {' and '.join(missing)}; install it by pip install "
            "'fx-membrane[patterns]'."
        )
    load_shapely()


def _prepare(folder: Path, overwrite: bool) -> None:
    paths.check_writable("folder", folder / PROOF)
    if folder.exists() and any(folder.iterdir()):
        if not overwrite:
            raise ValueError(f"{folder} has an earlier cutting pattern; give --overwrite to replace it.")
        drop_pattern(folder)
