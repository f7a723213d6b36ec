"""Checks that vectors, matrices and actions given by users fit a problem.

They do not communicate: a PETSc object knows the rows of every process, so all processes come to the same verdict.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..checks import validation
from ..model.parts import Membrane
from ..model.structure import Structure
from .actions import Actions

NEW_VECTOR = "make one with create_vector, or with to_petsc from an array of shape (n, 3)"
NEW_MATRIX = "make one with create_matrix"


def check_vector(name: str, given: Any, rows: list[int]) -> None:
    """Refuse an object that is no vector with the rows of a problem.

    Args:
        name: Name in messages.
        given: The object.
        rows: First row of each process, and the number of all, as of `Discretization.rows`.

    Raises:
        ValueError: It is of another kind or size, or its rows are distributed otherwise.
    """
    _check_made(name, given, PETSc.Vec, "vector", NEW_VECTOR)
    _check_rows(f"{name} is a PETSc vector with", "rows", given.getOwnershipRanges().tolist(), rows, NEW_VECTOR)


def check_matrix(name: str, given: Any, rows: list[int]) -> None:
    """Refuse an object that is no matrix with the rows and columns of a problem; arguments are those of a vector."""
    _check_made(name, given, PETSc.Mat, "matrix", NEW_MATRIX)
    what = f"{name} is a PETSc matrix with"
    _check_rows(what, "rows", given.getOwnershipRanges().tolist(), rows, NEW_MATRIX)
    _check_rows(what, "columns", given.getOwnershipRangesColumn().tolist(), rows, NEW_MATRIX)


def check_actions(name: str, given: Any, structure: Structure) -> None:
    """Refuse an object that is no actions, or whose arrays do not have the shape of the structure.

    Raises:
        ValueError: It is of another kind; an array has another shape.
    """
    validation.instance(name, given, Actions)
    shape = structure.points.shape
    expected = {name: (getattr(given, name), shape) for name in ("loads", "held", "displacement")}
    for part, pressure in given.pressures.items():
        expected[f"pressures of {part!r}"] = pressure, (len(structure.part(part, Membrane).cells),)
    for part, natural in given.natural.items():
        owner = structure.parts[part]
        expected[f"natural shape of {part!r}"] = natural, (len(owner.cells), owner.dimension, owner.dimension)
    for part, factors in given.prestress.items():
        expected[f"prestress factors of {part!r}"] = factors, (len(structure.parts[part].cells),)
    for part, tension in given.tensions.items():
        expected[f"tension of {part!r}"] = tension, (len(structure.parts[part].cells), 2)
    for entry, (array, wanted) in expected.items():
        if np.shape(array) != wanted:
            raise ValueError(f"Actions {entry} has shape {np.shape(array)}; this structure takes {wanted}.")


def nodal_values(name: str, given: Any, structure: Structure) -> NDArray[np.float64]:
    """Check finite values of all nodes, returned as a read-only array of shape (n, 3)."""
    values = validation.finite(name, given)
    if values.shape != structure.points.shape:
        raise ValueError(
            f"{name} has shape {values.shape}; give {structure.points.shape}, one row x, y, z for each node."
        )
    return values


def _check_made(name: str, given: Any, kind: Any, noun: str, remedy: str) -> None:
    if not isinstance(given, kind):
        shown = f"a PETSc {type(given).__name__}" if isinstance(given, PETSc.Object) else validation.short_repr(given)
        raise ValueError(f"{name} is {shown}; give a PETSc {noun}: {remedy}.")
    if not given.handle or given.getType() is None:
        raise ValueError(f"{name} is a PETSc {noun} without rows; {remedy}.")


def _check_rows(what: str, noun: str, found: list[int], rows: list[int], remedy: str) -> None:
    if found == rows:
        return
    if found[-1] != rows[-1]:
        raise ValueError(f"{what} {found[-1]} {noun}; the problem has {rows[-1]}: {remedy}.")
    raise ValueError(f"{what} the {noun} of the problem, but distributed otherwise over the processes; {remedy}.")
