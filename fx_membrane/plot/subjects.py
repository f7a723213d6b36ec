"""Subjects of pictures: states, and forms and structures with their initial stress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..form_finding.form import Form
from ..model.parts import Membrane
from ..model.structure import Structure
from ..results.initial_stress import built_stress
from ..results.states import StageResult
from ..surfaces.stress_lines import states_of

Array = NDArray[np.float64]
Shape = StageResult | Form | Structure


@dataclass(frozen=True, eq=False)
class Shown:
    """A shape and its state, as far as pictures show them.

    Attributes:
        shape: The state, form or structure itself.
        structure: The structure.
        displacement: Displacement from the points of the structure, shape (n, 3) [m].
    """

    shape: Shape
    structure: Structure
    displacement: Array

    @property
    def forces(self) -> dict[str, Array]:
        """Forces of cables and masts by name, of a structure as built, each (cells,) [N]."""
        bars = self.structure.bars
        if isinstance(self.shape, StageResult):
            return {name: found.force for name, found in self.shape.bars.items()}
        if isinstance(self.shape, Form):
            return {name: self.shape.forces[name] for name in bars}
        stress = built_stress(self.structure)
        return {name: stress[name][:, 0, 0] for name in bars}

    def cells_that_are(self, state: str) -> NDArray[np.bool_]:
        """Cells of all membranes, one after the other, in a state, shape (cells,)."""
        return (
            np.concatenate([[], *(states_of(self.shape, name) for name in self.structure.parts_of(Membrane))]) == state
        )

    @property
    def slack(self) -> NDArray[np.int64]:
        """Slack cells of all membranes, shape (cells, 3)."""
        every = [membrane.cells for membrane in self.structure.parts_of(Membrane).values()]
        return np.asarray(np.concatenate(every)[self.cells_that_are("slack")])


def shown(what: str, shape: Any) -> Shown:
    """Check the subject of a picture, and find its structure and shape.

    Raises:
        ValueError: It is none; or the form of a net, which has no structure.
    """
    if not isinstance(shape, StageResult | Form | Structure):
        raise ValueError(
            f"The first argument of {what} is {validation.short_repr(shape)}; give a StageResult, a Form or "
            "a Structure."
        )
    structure = shape if isinstance(shape, Structure) else shape.structure
    moved = shape.displacement if isinstance(shape, StageResult) else np.zeros_like(structure.points)
    return Shown(shape, structure, moved)
