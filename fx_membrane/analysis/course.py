"""A stage between its actions at the start and at the end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..assembly.acting_ponds import pond_groups
from ..assembly.actions import Actions, between, with_constraints_of
from ..assembly.load_cases import gas_at_end
from ..assembly.problem import Problem
from ..model.basins import StandingWater
from ..model.stages import Stage
from ..model.structure import Structure


class Course(NamedTuple):
    """A stage between its actions.

    Attributes:
        stage: The stage.
        start: Actions at the load factor 0.
        end: Actions at the load factor 1.
        shape: Displacement at its start, shape (n, 3) [m].
        structure: The structure.
    """

    stage: Stage
    start: Actions
    end: Actions
    shape: NDArray[np.float64]
    structure: Structure

    def actions(self, factor: Fraction | float) -> Actions:
        """Actions at a load factor."""
        return between(self.start, self.end, float(factor))

    def with_water(self, waters: Sequence[StandingWater | None]) -> Course:
        """Return the same stage with other water in the basins of its groups of ponds, in their order."""
        new = {
            id(group[0].pond): water
            for group, water in zip(pond_groups(self.actions(1).ponds), waters, strict=True)
            if water is not None
        }

        def filled(actions: Actions) -> Actions:
            ponds = tuple(entry._replace(water=new.get(id(entry.pond))) for entry in actions.ponds)
            return replace(actions, ponds=ponds)

        return self._replace(start=filled(self.start), end=filled(self.end))


def course_of(
    problem: Problem, stage: Stage, ends: dict[str | None, Actions], shape: NDArray[np.float64], fixes: bool
) -> Course:
    """Course of a stage from a shape.

    Args:
        problem: The problem.
        stage: The stage.
        ends: Actions at the end of stages by name; those of this stage are stored anew.
        shape: Displacement at its start, shape (n, 3) [m].
        fixes: True if lengths of cables or heights of drains are known only in this shape.
    """
    end = problem.actions_of(stage, ends[stage.after], shape) if fixes else ends[stage.name]
    if problem.structure.chambers:
        end = replace(end, **gas_at_end(stage, ends[stage.after]))
    before, end = problem.with_gas_of_start(ends[stage.after], end, shape, stage.name)
    ends[stage.name] = end
    return Course(stage, with_constraints_of(before, end, shape), end, shape, problem.structure)
