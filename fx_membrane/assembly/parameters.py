"""Changes of a parameter of a part, along which the residual is differentiated."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..model.structure import Structure
from .part_forms import PartForms, by_modulus, by_prestress, moduli


class Change:
    """Change of a parameter of a part.

    Args:
        structure: The structure.
        part: Name of the part.
        parameter: Name of the parameter.
        direction: The change, a number or an array of the parameter's shape.

    Raises:
        ValueError: There is no such part or parameter, or the direction has another shape.
    """

    def __init__(self, structure: Structure, part: str, parameter: str, direction: ArrayLike):
        if not isinstance(part, str) or part not in structure.parts:
            raise ValueError(
                f"No part is named {validation.short_repr(part)}; those of the structure are {list(structure.parts)}."
            )
        owner = structure.parts[part]
        names = ("prestress", *moduli(owner), *["pressure"] * (owner.dimension == 2))
        if not isinstance(parameter, str) or parameter not in names:
            given = validation.short_repr(parameter)
            raise ValueError(f"Part {part!r} has no parameter {given}; those with a derivative are {list(names)}.")
        self.part, self.parameter = part, parameter
        what = f"direction of {parameter!r}"
        if parameter == "prestress":
            self.values = replace(owner, prestress=direction).prestress_tensors()
            structure.check_shear(part, direction, f"direction of {parameter!r}")
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
            self.values = np.asarray(validation.number(what, direction))

    def on_cells(self, parts: Mapping[str, PartForms]) -> dict[str, NDArray[np.float64]]:
        """Values on the cells of this process, by part."""
        return {self.part: self.values[parts[self.part].mesh.cell_rows]} if self.part in parts else {}

    def form(self, part: PartForms) -> Any:
        """Compiled derivative of the residual of a part along the change; None for other parts."""
        if part.mesh.name != self.part:
            return None
        if self.parameter == "prestress":
            found = by_prestress(part)
            found.direction.x.array[:] = self.values[part.mesh.cell_rows].ravel()
        elif self.parameter not in part.moduli:  # no elasticity: the residual does not depend on it
            return None
        else:
            found = by_modulus(part, self.parameter)
            found.direction.value = self.values
        return found.form
