"""A case: structure, form finding, stages, solver and output, read from a TOML file."""

import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...checks import paths
from ...form_finding.form import Form
from ...form_finding.projected_stress import projected_stress
from ...form_finding.updated_reference import updated_reference
from ...model.loads import Load
from ...model.stages import Stage
from ...model.structure import Structure
from ...solvers.base import Solver
from ...solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from ...solvers.newton import Newton
from .faults import CaseError, Fault, case_error, faults_of_validation
from .units import Units

METHODS: dict[str, Callable[..., Form]] = {"updated reference": updated_reference, "projected stress": projected_stress}
SOLVERS = {"newton": Newton, "conjugate gradient": ConjugateGradient, "steepest descent": SteepestDescent}


@dataclass(frozen=True, eq=False)
class Case:
    """Content of a case file.

    Attributes:
        file: The file.
        title: Its title.
        force_unit: Unit of force of all numbers.
        length_unit: Unit of length of all numbers.
        structure: The structure, before form finding.
        stages: The stages.
        solver: The solver.
        output: Table of the files that a run writes.
        form_loads: Loads that the form balances.
        form_method: Name of the method of form finding; None without.
        form_options: Its other arguments.
    """

    file: Path
    title: str
    force_unit: str
    length_unit: str
    structure: Structure
    stages: Sequence[Stage]
    solver: Solver
    output: Any
    form_method: str | None = None
    form_loads: Sequence[Load] = ()
    form_options: dict[str, Any] | None = None

    def form(self) -> Form | None:
        """Find the form; None if the case asks for none.

        Raises:
            ValueError, RuntimeError: As of the function of form finding.
        """
        if self.form_method is None:
            return None
        return METHODS[self.form_method](self.structure, self.form_loads, **(self.form_options or {}))


def read_case(path: str | Path) -> Case:
    """Read a case file.

    Args:
        path: The file, TOML. `fx-membrane schema` prints its JSON schema; names of other files are relative to it.

    Raises:
        CaseError: It has faults: all that can be seen at once, each with line, key and remedy. It is a ValueError.
        ValueError: It cannot be read.
        ImportError: pydantic 2 or pint is not installed.
    """
    file = paths.path("path", path, spare=0)
    try:
        text = file.read_bytes().decode()
    except OSError as error:
        raise ValueError(f"path is {str(file)!r}, which cannot be read: {error.strerror}.") from None
    except UnicodeDecodeError as error:
        line = file.read_bytes()[: error.start].count(b"\n") + 1
        raise CaseError([f"{file}:{line}: file: it is no text in UTF-8; save it as that"]) from None
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CaseError([_unreadable(file, text, error)]) from None
    except RecursionError:
        raise CaseError([f"{file}:1: file: its tables are nested too deeply; write them apart"]) from None
    return _case(file, text, data)


def _case(file: Path, text: str, data: dict[str, Any]) -> Case:
    from pydantic import ValidationError  # noqa: PLC0415  (0.2 s, which only case files are to wait for)

    from . import schema  # noqa: PLC0415
    from .model import Builder, given  # noqa: PLC0415

    units, faults = _units(data)
    try:
        tables = schema.CaseModel.model_validate(data, context={"units": units})
    except ValidationError as error:
        raise case_error(file, text, [*faults, *faults_of_validation(error, data, schema.keys())]) from None
    if faults:
        raise case_error(file, text, faults)
    builder = Builder(tables, file.parent)
    structure = builder.structure()
    stages = builder.stages(structure) if structure else []
    loads = builder.form_loads(structure) if structure else []
    solver: Solver = Newton()
    with builder.at("solver"):
        if tables.solver:
            solver = SOLVERS[tables.solver.method](**given(tables.solver, "method"))
    if structure is None or builder.faults:
        raise case_error(file, text, builder.faults)
    names = tables.units or schema.UnitNames()
    form = tables.form_finding
    return Case(
        file,
        tables.title,
        names.force,
        names.length,
        structure,
        stages,
        solver,
        tables.output,
        form.method if form else None,
        loads,
        given(form, "method", "loads") if form else None,
    )


def _units(data: dict[str, Any]) -> tuple[Units | None, list[Fault]]:
    """Units of a file, and their faults; None if it names none."""
    names = data.get("units")
    if not isinstance(names, dict):
        return None, []
    try:
        given = {name: names[name] for name in ("force", "length") if isinstance(names.get(name), str)}
        return Units(**given), []
    except ValueError as error:
        return Units(), [Fault(("units",), str(error))]


def _unreadable(file: Path, text: str, error: tomllib.TOMLDecodeError) -> str:
    words = str(error)
    if "(at line " in words:
        words, _, place = words.rpartition(" (at line ")
        line = place.split(",")[0]
    else:
        line = str(len(text.splitlines()))
        words = words.removesuffix(" (at end of document)")
    return f"{file}:{line}: file: it is no TOML: {words[0].lower()}{words[1:]}; correct that line"
