"""Allowances of cutting patterns in case files, and the roll that has to be wider than those of two seams."""

from __future__ import annotations

from typing import Any

from ...patterns.allowances import Allowances
from .faults import Faults
from .making import make
from .table import BROKEN

TRAIL = ("patterns",)


def allowances_of(faults: Faults, table: Any, length_unit: str) -> Allowances:
    """Make the allowances of a table; those that it does not give are the usual ones."""
    allowances = Allowances()
    if table.allowances is not None and table.allowances is not BROKEN:
        with faults.at(*TRAIL, "allowances"):
            given = {key: getattr(table.allowances, key) for key in table.allowances.model_fields_set}
            allowances = make(faults, (*TRAIL, "allowances"), Allowances, given, {})
    in_unit = allowances.in_unit(length_unit)
    if table.roll_width not in (None, BROKEN) and 0 < table.roll_width <= 2 * in_unit.of_seams:
        with faults.at(*TRAIL, "roll_width"):
            raise ValueError(
                f"roll_width is {table.roll_width:g}, no more than two allowances of seams; give a wider roll"
            )
    return in_unit
