"""Case from the data of its file: validated, then made; faults of both phases come together."""

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from ...analysis.work import WorkLimit
from ...model.stages import Stage
from ...model.structure import Structure
from ...results.limits import Limits
from ...solvers.base import Solver
from ...solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from ...solvers.newton import Newton
from .case import Case
from .choices import Outline, given
from .faults import Fault, case_error, faults_of_validation
from .form_schema import NewMesh
from .model import Builder
from .schema import CaseModel, keys
from .structure_schema import BROKEN, FileGeometry, UnitNames
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
    tables, found = _validated(data, units)
    faults += found
    if partial or tables is None:
        return None, [fault for fault in faults if not (partial and fault.missing)]
    builder = Builder(tables, file.parent)
    structure = builder.structure()
    stages, steps, outline = list[Stage](), list[Any](), None
    if structure:
        steps, outline = builder.form_finding(structure)
        stages = builder.stages(outline)
    solver, work = _solver(builder, tables), _work(builder, tables)
    limits = _limits(builder, tables, outline.structure if outline else None)
    faults += _independent(in_file(builder.faults, data), faults)
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
    return Case(*heads, structure, stages, solver, work, limits, tables.output, steps, methods, key, anew), faults


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
    """Faults of the model apart from those of a table that has lost keys to a fault of its schema."""
    lists = {("materials",), ("parts",), ("supports",), ("stages",)}
    return [
        fault
        for fault in later
        if fault.path in lists or not any(entry.path[: len(fault.path)] == fault.path for entry in earlier)
    ]


def _validated(data: Mapping[str, Any], units: Units | None) -> tuple[CaseModel | None, list[Fault]]:
    """Tables of a case and their faults, which are BROKEN; None if it has too little to go on."""
    try:
        return CaseModel.model_validate(data, context={"units": units}), []
    except ValidationError as error:
        faults = faults_of_validation(error, data, keys())
    known = {name: table for name, table in data.items() if name in CaseModel.model_fields} | {"format": 1}
    known.pop("units", None)
    try:
        context = {"units": units or Units(), "lenient": True}
        tables = CaseModel.model_validate(known, context=context)
        return tables.model_copy(update={"units": _names(data)}), faults
    except ValidationError:
        return None, faults


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
    try:
        given = {name: names[name] for name in ("force", "length") if isinstance(names.get(name), str)}
        return Units(**given), []
    except ValueError as error:
        return Units(), [Fault(("units",), str(error))]


def _solver(builder: Builder, tables: CaseModel) -> Solver:
    found: Solver = Newton()
    with builder.faults.at("solver"):
        if tables.solver is not None and tables.solver is not BROKEN:
            found = SOLVERS[tables.solver.method](**given(tables.solver, "method"))
    return found


def _work(builder: Builder, tables: CaseModel) -> WorkLimit:
    found = WorkLimit()
    with builder.faults.at("work"):
        if tables.work is not None and tables.work is not BROKEN:
            found = WorkLimit(**given(tables.work))
    return found


def _limits(builder: Builder, tables: CaseModel, structure: Structure | None) -> Limits:
    found = Limits()
    with builder.faults.at("limits"):
        if tables.limits is not None and tables.limits is not BROKEN:
            found = Limits(**given(tables.limits))
    if structure is None:
        return found
    for kind, dimension in (("stress", 2), ("force", 1)):
        for name in getattr(found, kind):
            with builder.faults.at("limits", kind, name):
                builder.check_part(structure, name, dimension)
    return found
