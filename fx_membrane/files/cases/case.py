"""A case: structure, form finding, stages, solver and output, read from a TOML file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ... import Form
from ...analysis.work import WorkLimit
from ...checks import paths
from ...model.stages import Stage
from ...model.structure import Structure
from ...results.limits import Limits
from ...runtime.package_versions import reason_of_import
from ...solvers.base import Solver
from .faults import CaseError, case_error
from .toml import parsed


@dataclass(frozen=True, eq=False)
class Case:
    """Content of a case file.

    Attributes:
        file: The file.
        title: Its title.
        force_unit: Unit of force of all numbers.
        length_unit: Unit of length of all numbers.
        structure: The structure, before form finding.
        stages: The stages, for the structure and the bars that form finding adds.
        solver: The solver.
        work: Largest work of each stage.
        limits: Limits of the checks.
        output: Table of the files that a run writes.
        steps: Steps of form finding, each a function of an `Outline`.
        methods: Their names.
        form_key: Digest of all that the form depends on.
        doubts: Values that are hardly meant, a line for each, as in the error of faults.
        remade: Function that makes the stages anew for the structure found, on another mesh; None if it keeps its own.
        patterns: Cutting pattern that it asks for, a `PatternPlan`; None for none.
    """

    file: Path
    title: str
    force_unit: str
    length_unit: str
    structure: Structure
    stages: Sequence[Stage]
    solver: Solver
    work: WorkLimit
    limits: Limits
    output: Any
    steps: Sequence[Callable[[Any], Any]]
    methods: Sequence[str]
    form_key: str
    doubts: Sequence[str] = ()
    remade: Callable[[Structure], Sequence[Stage]] | None = None
    patterns: Any = None

    def form(self, observe: Callable[[int, Form], None] | None = None) -> Form | None:
        """Find the form; None if the case asks for none.

        Args:
            observe: Function that is given the number of each step, from 0, and the form after it.

        Raises:
            ValueError, RuntimeError: As of the functions of form finding.
        """
        from .choices import Outline  # noqa: PLC0415

        outline = Outline(self.structure)
        for number, step in enumerate(self.steps):
            outline = step(outline)
            if observe:
                observe(number, outline.form)
        found: Form | None = outline.form
        return found

    def stages_of(self, structure: Structure) -> Sequence[Stage]:
        """Stages of the structure of the form: those of the case, unless it has a new mesh.

        Raises:
            CaseError: They do not fit the new mesh.
        """
        return self.remade(structure) if self.remade else self.stages


def _unread(file: Path, reason: str) -> str:
    """Sentence on a case file that cannot be read, with those that are near."""
    if not (file.is_dir() or file.exists()):
        folder = file.parent
        if not folder.is_dir():
            return f"There is no folder {str(folder)!r}, so no case file {str(file)!r} ({reason}); correct the name."
        start, remedy = f"There is no case file {str(file)!r} ({reason})", "fx-membrane init writes one"
    else:
        folder, remedy = file, "give a case file in it"
        start = f"{str(file)!r} is a folder, and no case file"
        if not file.is_dir():
            return f"The case file {str(file)!r} cannot be read ({reason}); make it readable."
    with suppress(OSError):
        if found := sorted(str(entry) for entry in folder.glob("*.toml")):
            remedy = f"there {'is' if len(found) == 1 else 'are'} {', '.join(found[:5])}{' ...' if found[5:] else ''}"
    return f"{start}; {remedy}."


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
        content = file.read_bytes()
    except OSError as error:
        raise ValueError(_unread(file, error.strerror or str(error))) from None
    try:
        text = content.decode().removeprefix("\ufeff").replace("\r\n", "\n")
    except UnicodeDecodeError as error:
        if content.startswith(b"PK"):
            words = "it is an archive, as of results, and no case; `fx-membrane show` tells of it"
            raise CaseError([f"{file}:1: file: {words}"]) from None
        line = content[: error.start].count(b"\n") + 1
        raise CaseError([f"{file}:{line}: file: it is no text in UTF-8; save it as that"]) from None
    data, readable, unreadable = parsed(file, text)
    try:
        from .from_data import assembled  # noqa: PLC0415  (pydantic and pint, for 0.5 s)

        case, faults = assembled(file, readable, data, partial=bool(unreadable))
    except ImportError as error:
        raise ImportError(reason_of_import(error)) from None
    if case is None:
        told = case_error(file, readable, faults).lines if data or not unreadable else ()
        raise CaseError([*unreadable, *told]) from None
    return case
