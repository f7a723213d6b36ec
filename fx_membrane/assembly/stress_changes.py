"""Derivatives of the residual along the changes of natural shape and prestress in a stage."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

from petsc4py import PETSc

from ..model.cable_changes import ELASTIC
from .actions import Actions
from .assembler import Assembler
from .directed_forms import by_natural_shape, by_prestress, by_tensions, rope_pull
from .forms_of_parts import PartForms
from .parameters import inverse_rate
from .ropes import tension_rates


def add_rates(assembler: Assembler, start: Actions, end: Actions, here: Actions, b: PETSc.Vec) -> None:
    """Add the derivative of the residual by the load factor of a stage to a vector, see `rates` [N]."""
    tensions = tension_rates(assembler.discretization.structure, assembler.ropes, start, end)
    with assembler.discretization.work(1) as (change,):
        for form in rates(start, end, here, tensions):
            b.axpy(1.0, assembler.vector(form, change))


def rates(
    start: Actions, end: Actions, here: Actions, tensions: Mapping[str, float]
) -> Iterator[Callable[[PartForms], Any]]:
    """Yield derivatives of the residual of a part by the load factor of a stage, as forms; None where zero.

    Natural shapes A and prestress factors grow linearly from the start to the end.

    Args:
        start: Actions at the load factor 0.
        end: Actions at the load factor 1.
        here: Actions at the load factor at which the derivatives are taken.
        tensions: Rates of the tensions of ropes, by part [N].
    """
    if end.natural:
        yield lambda part: _natural(part, start, end, here)
    if end.prestress:
        yield lambda part: _prestress(part, start, end)
    if end.tensions:
        yield lambda part: _given(part, start, end)
    if tensions:
        yield lambda part: _rope(part, tensions)


def _natural(part: PartForms, start: Actions, end: Actions, here: Actions) -> Any:
    name, rows = part.mesh.name, part.mesh.cell_rows
    if name not in end.natural or part.rope:
        return None
    less = end.natural[name][rows]
    rate = less - start.natural[name][rows] if name in start.natural else less
    directed = by_natural_shape(part)
    directed.direction.x.array[:] = inverse_rate(here.natural[name][rows], rate).ravel()
    return directed.form


def _prestress(part: PartForms, start: Actions, end: Actions) -> Any:
    name, rows = part.mesh.name, part.mesh.cell_rows
    if name not in end.prestress or part.rope:
        return None
    rate = (end.prestress[name] - start.prestress.get(name, 1.0))[rows]
    directed = by_prestress(part)
    directed.direction.x.array[:] = (rate[:, None, None] * part.mesh.part.prestress_tensors()[rows]).ravel()
    return directed.form


def _given(part: PartForms, start: Actions, end: Actions) -> Any:
    name, rows = part.mesh.name, part.mesh.cell_rows
    if name not in end.tensions or part.rope:
        return None
    directed = by_tensions(part)
    directed.direction.x.array[:] = (end.tensions[name] - start.tensions.get(name, ELASTIC))[rows].ravel()
    return directed.form


def _rope(part: PartForms, tensions: Mapping[str, float]) -> Any:
    directed = rope_pull(part)
    if directed is None:
        return None
    directed.direction.value = tensions[part.mesh.name]
    return directed.form
