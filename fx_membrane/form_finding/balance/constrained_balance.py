"""Balance of membranes, bars and loads under constraints, step by step towards the geometry of cables."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...checks import validation
from ...model.structure import Structure
from ..constraints.cable_targets import TARGET_ERROR, CableTargets
from ..constraints.kinds import CableConstraint, Constraint, NodeConstraint
from ..constraints.motions import motions_of
from ..plan import Plan
from ..reasons.few_supports import check_supports_of_form
from .cable_forces import Acceleration, difference
from .membrane_balance import balanced, nodal_loads

Array = NDArray[np.float64]

# Ranges: tests/benchmarks/form_finding_constants.py, on 31 ropes and canopies of each kind of constraint.
MAX_SOLVES = 100  # maximum number of solves towards the geometry of cables: 10 are too few, 34 do
MAX_DENSITY_FACTOR = 3.0  # factor on a force density in one step; forms are the same with 30
UNBOUNDED = 1e100  # force density that only a cable without length has [N/m]
# Accepted relative change of a force; with 1e-7 forms move by 1e-7, with 1e-9 by 1e-8 of their size.
SETTLED_FORCE = 1e-8


def continued(words: str) -> str:
    """Sentence as the end of another, with a small letter at its start."""
    return words[:1].lower() + words[1:]


def shortfall(error: float, tolerance: float, steps: int, miss: float, words: str) -> str:
    """Tell how far cables are from the forces or the geometry prescribed, in words; empty if they are near."""
    if miss > TARGET_ERROR:
        return f"{words} after step {steps}, the last; allow more steps (max_iterations=...), or give a nearer value."
    if error <= tolerance:
        return ""
    return (
        f"forces of cables are off by {100 * error:.3g} % of the prescribed ones after step {steps}, the last; allow "
        "more steps (max_iterations=...) or a larger tolerance."
    )


def _unbounded(densities: Mapping[str, Array]) -> str:
    """Tell of a cable whose force density grows without bound, in words; empty without one."""
    for name, q in densities.items():
        for cell in np.flatnonzero(~np.isfinite(q) | (np.abs(q) > UNBOUNDED))[:1]:
            return (
                f"the cable in cell {cell} of part {name!r} shrinks to nothing: its force pulls its ends together; "
                "give it a smaller force, or hold nodes there."
            )
    return ""


class Balance(NamedTuple):
    """Shape in balance.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        reactions: Forces of supports and constraints, shape (n, 3) [N].
        wanted: Force densities of bars that the shape asks for, by part, shape (cells,) [N/m].
        densities: Those it is in balance with.
    """

    points: Array
    reactions: Array
    wanted: dict[str, Array]
    densities: dict[str, Array]


class ConstrainedBalance:
    """Balance of a structure with loads under constraints.

    Args:
        structure: The structure in its first shape.
        loads: Loads on it.
        constraints: Constraints of cables and nodes.
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].
        measure: Meaning of the prestress of cables, one of `MEASURES`.
        collapse: Function of a shape and the number of its step, that tells of its collapse in words.

    Raises:
        ValueError: A constraint does not fit the structure or its supports.
    """

    def __init__(
        self,
        structure: Structure,
        loads: Sequence[Any],
        constraints: Sequence[Constraint],
        axes: Array,
        measure: str,
        collapse: Callable[[Array, int], str],
    ) -> None:
        given = validation.instances("constraints", constraints, Constraint)
        self.structure, self.loads, self.collapse = structure, loads, collapse
        self.motions = motions_of(structure, [one for one in given if isinstance(one, NodeConstraint)])
        check_supports_of_form(structure, loads, given)
        of_cables = [one for one in given if isinstance(one, CableConstraint)]
        self.targets = CableTargets(structure, of_cables, axes, measure, self.motions.guided)

    def start(self, plans: Mapping[str, Plan]) -> dict[str, Array]:
        """Force densities of the first step, by part, shape (cells,) [N/m]."""
        stress = max((float(np.abs(plan.stress).max()) for plan in plans.values()), default=0.0)
        force = float(np.abs(nodal_loads(self.structure, self.loads, self.structure.points)).sum())
        return self.targets.start(stress * self.structure.size + force or 1.0)

    def acceleration(self) -> Acceleration:
        """Return an acceleration of the steps, bounded where the geometry of cables is given."""
        return Acceleration(MAX_DENSITY_FACTOR if self.targets.targets else np.inf)

    def __call__(
        self,
        start: Array,
        plans: Mapping[str, Plan],
        densities: dict[str, Array],
        number: int,
        reference: Array | None = None,
    ) -> Balance | str:
        """Solve for the shape of given force densities; a sentence on its collapse, if it has none.

        Args:
            start: Shape with the held nodes in place, shape (n, 3) [m].
            plans: Membranes in their reference.
            densities: Force densities of bars, by part, shape (cells,) [N/m].
            number: Number of the step.
            reference: Shape in which a line of given geometry has one force; the shape found, if not given.

        Raises:
            ValueError, RuntimeError: There is no balance in the first step; later ones have an earlier shape to keep.
        """
        try:
            points, reactions = balanced(self.structure, self.loads, start, plans, densities, self.motions)
        except (ValueError, RuntimeError) as failure:
            if number == 1:
                raise
            return str(failure)
        try:
            collapse = self.collapse(points, number) or self.targets.out_of_range(points, densities)
            wanted = {} if collapse else self.targets.wanted(points, densities, reference)
            return collapse or _unbounded(wanted) or Balance(points, reactions, wanted, densities)
        except ValueError as upright:
            return str(upright)

    def settled(
        self,
        start: Array,
        plans: Mapping[str, Plan],
        densities: dict[str, Array],
        number: int,
        meets_forces: bool = False,
    ) -> Balance | str:
        """Solve as often as the geometry of cables asks for, with the other force densities given.

        A line of given geometry has one force for its lengths in the start. Args and Raises as for a call; with
        `meets_forces` it has one for those in the shape found, where cables with a force as constraint have it, too.
        """
        accelerated, words = self.acceleration(), ""
        reference = start
        for _ in range(MAX_SOLVES):
            found = self(start, plans, densities, number, reference)
            if isinstance(found, str):
                return found
            if meets_forces:  # Newton's steps take the force of a line to be one in the shape that they start from
                found = found._replace(wanted=self.targets.wanted(found.points, densities, found.points))
            miss, words = self.targets.miss(found.points, densities, found.wanted)
            wanted = self.targets.mixed(densities, found.wanted, meets_forces)
            if miss <= TARGET_ERROR and difference(densities, wanted) <= SETTLED_FORCE:
                return found
            densities, start = accelerated(densities, wanted), found.points
        return f"{words or 'a force does not settle'} after {MAX_SOLVES} solves; give a value nearer to that."
