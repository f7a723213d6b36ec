"""Evaluation of states: stresses in the cells, and everything gathered in the user's order."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import ufl
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..assembly.forms_of_parts import PartForms
from ..assembly.kinds_of_forms import named
from ..assembly.problem import Problem
from ..assembly.problem_under_actions import LoadedProblem
from ..assembly.ropes import RopeState, unstressed_length
from ..forms import kinematics, stress
from ..solvers.base import LIMITS
from .forces_of_state import Equilibrium, TermResult
from .load_increments import Increment
from .part_results import BarResult, MembraneResult, RopeResult
from .states import StageResult
from .water_of_state import pond_results

STATES = np.array(["taut", "wrinkled", "slack"])  # in the order of `forms.wrinkling`

# Quantities evaluated in each cell, and their shapes.
MEMBRANE: dict[str, tuple[int, ...]] = {
    "strain": (2, 2),
    "second_piola_kirchhoff": (2, 2),
    "cauchy": (3, 3),
    "cauchy_projected": (3, 3),
    "principal": (2,),
    "warp_weft_stress": (2,),
    "state": (),
}
BAR: dict[str, tuple[int, ...]] = {"strain": (), "force": (), "state": ()}
FIELDS = {1: BAR, 2: MEMBRANE}  # by the dimension of a part
CHUNK = 4096  # cells evaluated at once: their quantities fit into the cache of a processor


class StateEvaluator:
    """Evaluation of states; it keeps the compiled stress expressions between stages."""

    def __init__(self, problem: Problem):
        self.problem = problem
        for part in problem.parts.values():
            part.compiled("results", _expression)

    def __call__(
        self, name: str, problem: LoadedProblem, x: PETSc.Vec, increments: tuple[Increment, ...]
    ) -> StageResult:
        """Compute the result of a state x of the problem under actions."""
        actions, discretization = problem.actions, problem.discretization
        _dolfinx.free_dropped(problem.comm)
        with discretization.work(1) as (b,):
            problem.residual(x, b)
            residual, displacement = discretization.to_numpy(b), discretization.to_numpy(x)
        terms = tuple(TermResult(*acting, forces) for acting, forces in problem.term_forces(x))
        loads = (
            actions.loads + problem.pressure_loads(x) + sum(entry.forces for entry in terms) + problem.integral_loads(x)
        )
        reactions = np.where(actions.held, residual, 0.0)
        unbalanced = np.abs(np.where(actions.held, 0.0, residual)).max(axis=1)
        position = problem.structure.points + displacement
        with np.errstate(invalid="ignore"):  # of a start at which an energy term is not a number
            moments = [np.cross(position, forces).sum(axis=0) for forces in (loads, reactions)]
        return StageResult(
            name=name,
            structure=problem.structure,
            displacement=displacement,
            actions=actions,
            loads=loads,
            reactions=reactions,
            energy=problem.energy(x),
            equilibrium=Equilibrium(
                loads=loads.sum(axis=0),
                reactions=reactions.sum(axis=0),
                load_moment=moments[0],
                reaction_moment=moments[1],
                residual=float(unbalanced.max()),
                unbalanced=unbalanced,
            ),
            increments=increments,
            terms=terms,
            ponds=pond_results(problem, x),
            chambers=problem.chambers(x),
            owner=self.problem,
            parts={name: self._part_result(name, problem.assembler.ropes) for name in problem.structure.parts},
        )

    def _part_result(self, name: str, ropes: Mapping[str, RopeState]) -> MembraneResult | BarResult:
        discretization = self.problem.discretization
        part = self.problem.structure.parts[name]
        shapes = FIELDS[part.dimension]
        here = self._cell_values(name, shapes)
        fields: dict[str, NDArray[Any]] = {}
        for field, shape in shapes.items():  # one by one: they fill the memory
            fields[field] = discretization.gather_cells(name, here.pop(field)).reshape(-1, *shape)
        states = STATES[fields.pop("state").astype(int)]
        if name in self.problem.structure.membranes:
            return MembraneResult(**fields, state=states)
        slack = states == "slack"
        if not part.carries_compression:  # cables without force, or with rounding
            slack |= fields["force"] <= LIMITS.rounding * (part.material.stiffness + np.abs(part.prestress))
        if part.shares_tension:
            state = ropes[name]
            return RopeResult(
                **fields, slack=slack, length=state.length, unstressed_length=unstressed_length(part, state)
            )
        return BarResult(**fields, slack=slack)

    def _cell_values(self, name: str, shapes: Mapping[str, tuple[int, ...]]) -> dict[str, NDArray[np.float64]]:
        """Quantities in the cells of this process, in the order of its mesh, shape (its cells, size)."""
        sizes = [math.prod(shape) for shape in shapes.values()]
        part = self.problem.parts.get(name)
        if part is None:
            return {field: np.empty((0, size)) for field, size in zip(shapes, sizes, strict=True)}
        count, evaluate = len(part.mesh.cell_rows), part.compiled("results", _expression)
        fields = {field: np.empty((count, size)) for field, size in zip(shapes, sizes, strict=True)}
        for first in range(0, count, CHUNK):
            end = min(first + CHUNK, count)
            columns = np.split(evaluate(np.arange(first, end)), np.cumsum(sizes)[:-1], axis=1)
            for field, column in zip(fields.values(), columns, strict=True):
                field[first:end] = column
        return fields


def _expression(part: PartForms) -> Callable[[], NDArray[np.float64]]:
    """Compile the quantities of a part as one vector-valued expression, in the order of its `FIELDS`."""
    dimension = part.mesh.part.dimension
    fields = EXPRESSIONS[dimension](part)
    assert {name: value.ufl_shape for name, value in fields.items()} == FIELDS[dimension]
    entries = [value[i] for value in fields.values() for i in np.ndindex(value.ufl_shape)]
    return _dolfinx.cell_expression(ufl.as_vector(entries), part.mesh.mesh, named("results", part.kind))


def _of_membrane(part: PartForms) -> dict[str, Any]:
    F, S = part.F, part.S
    cauchy = stress.cauchy(F, S, kinematics.stretch_ratio(F))
    return {
        "strain": part.E,
        "second_piola_kirchhoff": S,
        "cauchy": cauchy,
        "cauchy_projected": stress.cauchy(F, S, kinematics.projected_ratio(F, part.T)),
        "principal": stress.principal(cauchy, F),
        "warp_weft_stress": stress.warp_weft_stress(cauchy, F),
        "state": part.state,
    }


def _of_bar(part: PartForms) -> dict[str, Any]:
    force = ufl.tr(stress.cauchy(part.F, part.S, kinematics.stretch_ratio(part.F)))
    return {"strain": part.E[0, 0], "force": force, "state": part.state}


EXPRESSIONS = {1: _of_bar, 2: _of_membrane}  # by the dimension of a part
