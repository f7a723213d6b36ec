"""Names of a case file, of parts and of stages."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from .faults import nearest
from .schema import CaseModel
from .structure_schema import MembranePart
from .table import BROKEN


def kinds_of(case: CaseModel) -> dict[str, int | None] | None:
    """Dimension of each part that a file has, None for an unknown one; None if it has unknown parts."""
    if case.parts is BROKEN or case.form_finding is BROKEN:
        return None
    tables = dict(case.parts)
    for step in case.form_finding:
        bars = getattr(step, "bars", {})
        if step is BROKEN or bars is BROKEN:
            return None
        tables |= bars
    return {
        name: None if table is BROKEN else 2 if isinstance(table, MembranePart) else 1 for name, table in tables.items()
    }


def check_groups(groups: Collection[str] | None, names: str | list[str]) -> None:
    """Refuse groups that a geometry cannot have although it has a fault.

    Raises:
        ValueError: It has none of that name.
    """
    for name in [names] if isinstance(names, str) else names:
        if groups is not None and name not in groups:
            raise ValueError(f"the geometry has no group {name!r}{nearest(name, groups)}")


def no_stage_before(after: Any, name: Any, earlier: Sequence[Any], names: Sequence[Any]) -> str:
    """Tell that a stage cannot follow another, with the remedy."""
    if after == name:
        return f"{after!r} is the stage itself; name another, or leave it out to start from the reference shape"
    if after in names:
        return f"{after!r} comes later in the file; put it before this one"
    return f"no stage {after!r} is before this one{nearest(after, earlier) or '; correct the name, or leave it out'}"
