"""Case from the data of its file: validated, then made; faults of both phases come together."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ...analysis.stage_check import check_run
from ...analysis.work import WorkLimit
from ...checks import paths
from ...model.stages import Stage
from ...model.structure import Structure
from ...results.limits import Limits
from ...solvers.base import Solver
from ...solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from ...solvers.newton import Newton
from .case import Case
from .chambers import tell_gas
from .choices import Outline
from .doubts import doubts_of
from .faults import Fault, Faults, case_error, faults_of_validation
from .form_schema import NewMesh
from .kinds import with_kinds
from .known_keys import keys_at
from .making import make
from .model import Builder
from .schema import CaseModel, keys
from .structure_schema import FileGeometry, UnitNames
from .table import BROKEN, given, is_whole, sound
from .units import Units

SOLVERS: dict[str, Any] = {
    "newton": Newton,
    "conjugate gradient": ConjugateGradient,
    "steepest descent": SteepestDescent,
}


def assembled(file: Path, text: str, data: Mapping[str, Any], partial: bool) -> tuple[Case | None, list[Fault]]:
    """Make a case of its data.

    Args:
        file: The file.
        text: Its content.
        data: The tables.
        partial: True if lines of the file could not be read: nothing is called missing then, and nothing is made.

    Returns:
        The case, None with faults or of partial data; the faults.
    """
    units, faults = _units(data)
    if partial:
        units = units or Units()  # theirs may be among the lines that could not be read
    tables, found = _validated(data, units)
    faults += found
    if partial or tables is None:
        return None, [fault for fault in faults if not (partial and fault.missing)]
    builder = Builder(tables, file.parent)
    structure = builder.structure()
    steps, outline = builder.form_finding(structure)
    stages = builder.stages(outline)
    patterns = builder.patterns(outline)
    solver, work = _solver(builder, tables), _work(builder, tables)
    if is_whole(tables.output) and tables.output.folder:
        with builder.faults.at("output", "folder"):
            paths.path("folder", tables.output.folder.rstrip("/"))
    limits = _limits(builder, tables, outline.structure)
    if not (builder.faults or faults):
        tell_gas(builder.faults, stages, solver)
    faults += _independent(in_file(builder.faults, data), faults)
    if structure is not None and not faults and not steps:  # a shape that is found may be held otherwise
        with builder.faults.at("supports"):
            check_run(structure, stages)
        faults += builder.faults
    if structure is None or faults:
        return None, faults

    def remade(found: Structure) -> Sequence[Stage]:
        again = builder.stages(Outline(found, renumbered=True))
        if builder.faults:
            raise case_error(file, text, in_file(builder.faults, data))
        return again

    names = tables.units or UnitNames()
    anew = remade if any(isinstance(step, NewMesh) for step in tables.form_finding) else None
    heads = file, tables.title, names.force, names.length
    methods, key = [step.method for step in tables.form_finding], _form_key(tables, file.parent)
    doubts = case_error(file, text, doubts_of(data, structure, stages)).lines
    return Case(
        *heads, structure, stages, solver, work, limits, tables.output, steps, methods, key, doubts, anew, patterns
    ), faults


def in_file(faults: Sequence[Fault], data: Mapping[str, Any]) -> list[Fault]:
    """Faults by the paths of the file, where form finding may be a table instead of a list of one."""
    if not isinstance(data.get("form_finding"), dict):
        return list(faults)
    return [
        fault._replace(path=("form_finding", *fault.path[2:])) if fault.path[:1] == ("form_finding",) else fault
        for fault in faults
    ]


def _form_key(tables: CaseModel, folder: Path) -> str:
    """Digest of the tables on which the form depends, and of the mesh file."""
    digest = hashlib.sha256()
    for name in ("units", "geometry", "materials", "parts", "supports", "separate", "form_finding"):
        digest.update(repr(getattr(tables, name)).encode())
    if isinstance(tables.geometry, FileGeometry):
        digest.update((folder / tables.geometry.file).read_bytes())
    return digest.hexdigest()


def _independent(later: Sequence[Fault], earlier: Sequence[Fault]) -> list[Fault]:
    """Faults of the model apart from those of a table that has lost keys to a fault of its schema.

    A part is not of the wrong kind for a table whose own kind was guessed.
    """
    guessed = {fault.path[:-1] for fault in earlier if fault.path[-1:] in (("kind",), ("method",))}
    guessed |= {fault.path for fault in earlier if fault.missing}
    lists = {("materials",), ("parts",), ("supports",), ("stages",)}
    return [
        fault
        for fault in later
        if not (fault.path[-1:] == ("part",) and fault.path[:-1] in guessed and " is no " in fault.words)
        and (fault.path in lists or not any(entry.path[: len(fault.path)] == fault.path for entry in earlier))
    ]


def _validated(data: Mapping[str, Any], units: Units | None) -> tuple[CaseModel | None, list[Fault]]:
    """Tables of a case and their faults, which are BROKEN; None if it has too little to go on."""
    try:
        return CaseModel.model_validate(data, context={"units": units}), []
    except ValidationError as error:
        faults = faults_of_validation(error, data, keys(), keys_at)
    guessed = with_kinds(data, units)
    try:
        CaseModel.model_validate(guessed, context={"units": units})
    except ValidationError as error:
        told = {fault.path for fault in faults}
        more = faults_of_validation(error, guessed, keys(), keys_at)
        faults += [fault for fault in more if fault.path not in told and not _guesswork(fault, faults, data)]
    tables = CaseModel.model_validate(
        {**guessed, "format": 1, "units": None}, context={"units": units or Units(), "lenient": True}
    )
    return tables.model_copy(update={"units": _names(data)}), faults


def _guesswork(fault: Fault, known: Sequence[Fault], data: Mapping[str, Any]) -> bool:
    """Tell if a fault may come from the kind that was guessed for a table: keys that it lacks, or has too many."""
    kinds = [entry for entry in known if entry.path[-1:] in (("kind",), ("method",))]
    unlike = {entry.path[:-1] for entry in kinds if "may be meant" not in entry.words}
    without_kind = {entry.path for entry in known if entry.missing}
    owner, key = fault.path[:-1], fault.path[-1]
    if "no key of that name" in fault.words:  # a table without a kind may have the keys of any
        return owner in unlike or (owner in without_kind and key in keys_at(data, owner))
    return fault.missing and owner in without_kind.union(entry.path[:-1] for entry in kinds)


def _names(data: Mapping[str, Any]) -> UnitNames | None:
    try:
        return UnitNames.model_validate(data["units"])
    except (KeyError, ValidationError):
        return None


def _units(data: Mapping[str, Any]) -> tuple[Units | None, list[Fault]]:
    """Units of a file, and their faults; None if it names none."""
    names = data.get("units")
    if not isinstance(names, dict):
        return None, []
    good, faults = dict[str, str](), Faults()
    for name in ("force", "length"):
        if isinstance(names.get(name), str):
            with faults.at("units", name):
                Units(**{name: names[name]})
                good[name] = names[name]
    return Units(**good), list(faults)


def _solver(builder: Builder, tables: CaseModel) -> Solver:
    found: Solver = Newton()
    with builder.faults.at("solver"):
        if tables.solver is not None and tables.solver is not BROKEN:
            maker = SOLVERS[tables.solver.method]
            found = make(builder.faults, ("solver",), maker, given(tables.solver, "method"), {})
    return found


def _work(builder: Builder, tables: CaseModel) -> WorkLimit:
    found = WorkLimit()
    with builder.faults.at("work"):
        if tables.work is not None and tables.work is not BROKEN:
            found = make(builder.faults, ("work",), WorkLimit, given(tables.work), {})
    return found


def _limits(builder: Builder, tables: CaseModel, structure: Structure | None) -> Limits:
    if tables.limits is None or tables.limits is BROKEN:
        return Limits()
    faults, count = builder.faults, len(builder.faults)
    with faults.at("limits", "displacement"):
        if tables.limits.displacement not in (None, BROKEN):
            Limits(displacement=tables.limits.displacement)
    for kind, dimension in (("stress", 2), ("force", 1)):
        for name, value in sound(getattr(tables.limits, kind)):
            with faults.at("limits", kind, name):
                Limits(**{kind: {name: value}})  # type: ignore[arg-type]  # not the displacement
            with faults.at("limits", kind, name):
                builder.check_part(structure, name, dimension)
    return Limits() if len(faults) > count or not is_whole(tables.limits) else Limits(**given(tables.limits))
