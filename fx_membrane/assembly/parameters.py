"""Changes of a parameter of a part or of an energy term, along which the residual is differentiated."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.sizes import measures
from ..model import cell_tensors, term_parameters
from ..model.digests import of_settings
from ..model.energy_terms import Acting
from ..model.parts import Part
from ..model.structure import Structure
from ..runtime.processes import refuse_differences, together
from .actions import Actions
from .directed_forms import by_modulus, by_natural_shape, by_prestress, rope_pull
from .energy_terms import TermChange
from .forms_of_parts import PartForms, moduli
from .ropes import RopeState, tension_by

Array = NDArray[np.float64]


class Change:
    """Change of a parameter of a part.

    Args:
        structure: The structure.
        actions: Actions under which the residual is differentiated.
        part: Name of the part.
        parameter: Name of the parameter.
        direction: The change, a number or an array of the parameter's shape.

    Raises:
        ValueError: The part or the parameter does not exist, or the direction has another shape.
    """

    def __init__(self, structure: Structure, actions: Actions, part: str, parameter: str, direction: ArrayLike):
        if not isinstance(part, str) or part not in structure.parts:
            raise ValueError(
                f"No part is named {validation.short_repr(part)}; those of the structure are {list(structure.parts)}."
            )
        owner = structure.parts[part]
        names = ("prestress", "natural_stretch", *moduli(owner), *["pressure"] * (part in structure.membranes))
        if not isinstance(parameter, str) or parameter not in names:
            given = validation.short_repr(parameter)
            raise ValueError(f"Part {part!r} has no parameter {given}; those with a derivative are {list(names)}.")
        self.part, self.parameter = part, parameter
        what = f"direction of {parameter!r}"
        self.number = 0.0  # of a rope, the change of its stiffness, prestress or unstressed length
        if parameter in ("prestress", "natural_stretch"):
            self.values = _tensors(what, owner, direction)
            structure.check_shear(part, direction, what)
            if owner.shares_tension:
                self.number = float(self.values[0, 0, 0])
                if parameter == "natural_stretch":
                    self.number *= float(measures(structure.points, owner.cells).sum())
            if parameter == "prestress":
                cell_tensors.check_symmetry(what, self.values)
                self.values = actions.prestress.get(part, np.ones(len(owner.cells)))[:, None, None] * self.values
            else:
                self.values = inverse_rate(actions.natural.get(part, 0.0 * self.values), self.values)
        elif parameter == "pressure":
            structure.check_sides(part)
            self.values = validation.finite(what, direction)
            if self.values.shape not in ((), (len(owner.cells),)):
                raise ValueError(
                    f"The {what} has shape {self.values.shape}; give a number or one for each of the "
                    f"{len(owner.cells)} cells."
                )
            self.values = np.broadcast_to(self.values, len(owner.cells))
        else:
            self.number = validation.number(what, direction)
            self.values = np.asarray(self.number)

    def on_cells(self, parts: Mapping[str, PartForms]) -> dict[str, NDArray[np.float64]]:
        """Values on the cells of this process, by part."""
        return {self.part: self.values[parts[self.part].mesh.cell_rows]} if self.part in parts else {}

    def form(self, part: PartForms, ropes: Mapping[str, RopeState]) -> Any:
        """Compiled derivative of the residual of a part along the change; None for other parts."""
        if part.mesh.name != self.part:
            return None
        pull = rope_pull(part)
        if pull is not None:
            pull.direction.value = tension_by(part.mesh.part, ropes[part.mesh.name], self.parameter, self.number)
            return pull.form
        if self.parameter in ("prestress", "natural_stretch"):
            if self.parameter == "natural_stretch" and part.natural is None:  # no elasticity
                return None
            found = by_prestress(part) if self.parameter == "prestress" else by_natural_shape(part)
            found.direction.x.array[:] = self.values[part.mesh.cell_rows].ravel()
        elif self.parameter not in part.moduli:  # no elasticity: the residual does not depend on it
            return None
        else:
            found = by_modulus(part, self.parameter)
            found.direction.value = self.values
        return found.form


Made = TypeVar("Made", Change, TermChange)


def agreed_change(
    comm: MPI.Intracomm, structure: Structure, actions: Actions, part: str, parameter: str, direction: ArrayLike
) -> Change:
    """Change of a parameter of a part, refused unless it is the same on all processes; see `Change`."""
    return _agreed(comm, part, parameter, lambda: Change(structure, actions, part, parameter, direction))


def agreed_term_change(
    comm: MPI.Intracomm, structure: Structure, acting: Sequence[Acting], term: Any, parameter: str, direction: ArrayLike
) -> TermChange:
    """Change of a parameter of an energy term, refused unless it is the same on all processes; see `change_of_term`."""
    return _agreed(comm, term, parameter, lambda: change_of_term(structure, acting, term, parameter, direction))


def _agreed(comm: MPI.Intracomm, owner: Any, parameter: str, make: Callable[[], Made]) -> Made:
    with together(comm):
        change = make()
    settings = {"part": owner, "parameter": parameter, "direction": change.values}
    refuse_differences(comm, lambda: of_settings(settings))
    return change


def change_of_term(
    structure: Structure, acting: Sequence[Acting], term: Any, parameter: str, direction: ArrayLike
) -> TermChange:
    """Change of a parameter of an energy term.

    Args:
        structure: The structure.
        acting: Energy terms that act.
        term: The term.
        parameter: Name of the parameter.
        direction: The change, in the shape of the parameter; one row for all cells, too, where it has one for each.

    Raises:
        ValueError: The term does not act; it has no parameter of that name; the direction has another shape.
    """
    factors = [entry.factor for entry in acting if entry.term is term]
    if not factors:
        others = ", ".join(term_parameters.described(entry.term) for entry in acting) or "of which there are none"
        raise ValueError(
            f"{term_parameters.described(term)} is none of the energy terms that act here, {others}; give the object "
            "itself that a stage or the structure has."
        )
    change = term_parameters.change_of(term, len(structure.parts[term.part].cells), parameter, direction)
    return TermChange(Acting(term, sum(factors)), parameter, change)


def inverse_rate(less: Array, rate: Array) -> Array:
    """Rate of A^-1 from A - I and the rate of A, all of shape (cells, d, d)."""
    inverse = np.linalg.inv(np.eye(rate.shape[1]) + less)
    return np.asarray(-inverse @ rate @ inverse)


def _tensors(what: str, part: Part, given: ArrayLike) -> Array:
    """Tensors of all cells from a notation that the part takes, shape (cells, d, d)."""
    return part.tensors(what, validation.finite(what, given))


def asked(part: Any, parameter: str, direction: Any) -> dict[str, Any]:
    """Arguments of a derivative by name, to be the same on all processes."""
    return {"part": part, "parameter": parameter, "direction": direction}
