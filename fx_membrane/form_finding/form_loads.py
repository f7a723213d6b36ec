"""Loads that a form balances: all kinds but energy terms, checked against the structure."""

from typing import Any

from ..checks import validation
from ..model.loads import DistributedLoad, PlanLoad, PointLoad, Pressure, check_load
from ..model.structure import Structure

FormLoad = PointLoad | DistributedLoad | PlanLoad | Pressure


def checked_form_loads(structure: Structure, loads: Any) -> tuple[FormLoad, ...]:
    """Check the loads of form finding.

    Raises:
        ValueError: One is of another kind; its part, its cells or its nodes do not exist, or cannot bear it.
    """
    checked = tuple(validation.instances("loads", loads, FormLoad))
    for load in checked:
        check_load(structure, "Form finding", load)
    return checked
