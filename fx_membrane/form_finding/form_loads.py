"""Loads that a form balances: all kinds but energy terms, checked against the structure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..checks import validation
from ..model.gas import refuse_among_loads
from ..model.loads import FormLoad, Pressure, SpreadLoad, check_load
from ..model.structure import Structure

SHOWN = 3  # loads told of at most
NO_GAS = (
    "form finding knows no gas: give its pressure by number, as Pressure(300.0, part), on each membrane around the "
    "chamber, positive along its normals"
)


def checked_form_loads(structure: Structure, loads: Any) -> tuple[FormLoad, ...]:
    """Check the loads of form finding.

    Raises:
        ValueError: One is of another kind; its part, its cells or its nodes do not exist, or cannot bear it.
    """
    refuse_among_loads("loads", loads, NO_GAS)
    checked = tuple(validation.instances("loads", loads, FormLoad))
    for load in checked:
        check_load(structure, "Form finding", load)
    return checked


def words_of_loads(loads: Sequence[Any]) -> str:
    """List distributed loads with their part and their value, in words; empty without any."""
    found = []
    for load in loads:
        if isinstance(load, Pressure):
            found.append(f"a pressure of {load.pressure:.4g} on part {load.part!r}")
        elif isinstance(load, SpreadLoad):
            found.append(f"a load of {np.linalg.norm(np.asarray(load.load)):.4g} on part {load.part!r}")
    return " and ".join(dict.fromkeys(found[:SHOWN])) + (" and others" if len(found) > SHOWN else "")
