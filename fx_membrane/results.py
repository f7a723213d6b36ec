"""What a stage ends in: displacements, reactions, stresses, forces and their balance, as NumPy arrays.

Arrays follow the user's own order of nodes and cells, and every process has all of them.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import ufl
from numpy.typing import NDArray
from petsc4py import PETSc

from . import _dolfinx
from .forms import kinematics, stress
from .problem import Actions, PartForms, Problem
from .solver import Iteration
from .structure import Cable, Mast, Membrane, Structure

Array = NDArray[np.float64]


class Increment(NamedTuple):
    """One load increment.

    Attributes:
        load_factor: Share of the stage's own loads and displacements, in (0, 1].
        iterations: The iterates of the solver, the start first.
    """

    load_factor: float
    iterations: tuple[Iteration, ...]


@dataclass(frozen=True, eq=False)
class MembraneResult:
    """State of a membrane; stresses are forces per length, divide by the thickness for [Pa].

    Attributes:
        strain: Green-Lagrange strain in the warp/weft frame, shape (cells, 2, 2) [-].
        second_piola_kirchhoff: Stress per reference length in the warp/weft frame, shape (cells, 2, 2) [N/m], Gil (32).
        cauchy: Stress per current length in global axes, shape (cells, 3, 3) [N/m].
        principal: Principal values of `cauchy`, the larger first, shape (cells, 2) [N/m].
        cauchy_projected: Cauchy stress with the determinant of I + grad u as J, in global axes, shape (cells, 3, 3)
            [N/m]: what Gil (19) gives, the paper's Table 2. It is larger than `cauchy` where cells have turned.
    """

    strain: Array
    second_piola_kirchhoff: Array
    cauchy: Array
    principal: Array
    cauchy_projected: Array


@dataclass(frozen=True, eq=False)
class BarResult:
    """State of cables or masts.

    Attributes:
        strain: Green-Lagrange strain, shape (cells,) [-].
        force: Axial force in the current shape, tension positive, shape (cells,) [N].
    """

    strain: Array
    force: Array


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Balance of everything that acts on the structure in its current shape; moments about the origin.

    Attributes:
        loads: Sum of the loads, shape (3,) [N].
        reactions: Sum of the reactions, shape (3,) [N].
        load_moment: Moment of the loads, shape (3,) [N m].
        reaction_moment: Moment of the reactions, shape (3,) [N m].
        residual: Largest unbalanced force at a free component [N].
    """

    loads: Array
    reactions: Array
    load_moment: Array
    reaction_moment: Array
    residual: float


@dataclass(frozen=True, eq=False)
class StageResult:
    """The final state of a stage.

    Attributes:
        name: Name of the stage.
        structure: The structure.
        displacement: From the reference position, shape (n, 3) [m].
        loads: Dead loads on the nodes, shape (n, 3) [N].
        reactions: Forces that hold the supports and the prescribed displacements, shape (n, 3) [N]; zero where free.
        energy: Total potential energy [J].
        equilibrium: Balance of loads and reactions.
        increments: The load increments of this stage, in order.
        parts: State of each part by name.
    """

    name: str
    structure: Structure
    displacement: Array
    loads: Array
    reactions: Array
    energy: float
    equilibrium: Equilibrium
    increments: tuple[Increment, ...]
    parts: dict[str, MembraneResult | BarResult]

    @property
    def position(self) -> Array:
        """Current position of the nodes, shape (n, 3) [m]."""
        return self.structure.points + self.displacement

    def membrane(self, name: str) -> MembraneResult:
        """State of the membrane of that name.

        Raises:
            ValueError: There is no membrane of that name.
        """
        result = self.parts[self._name(name, Membrane)]
        assert isinstance(result, MembraneResult)
        return result

    def cable(self, name: str) -> BarResult:
        """State of the cables of that name.

        Raises:
            ValueError: There are no cables of that name.
        """
        return self._bar(name, Cable)

    def mast(self, name: str) -> BarResult:
        """State of the masts of that name.

        Raises:
            ValueError: There are no masts of that name.
        """
        return self._bar(name, Mast)

    @property
    def history(self) -> list[tuple[float, Iteration]]:
        """Load factor and iterate, for all iterations of the stage."""
        return [(increment.load_factor, entry) for increment in self.increments for entry in increment.iterations]

    def _bar(self, name: str, kind: type) -> BarResult:
        result = self.parts[self._name(name, kind)]
        assert isinstance(result, BarResult)
        return result

    def _name(self, name: str, kind: type) -> str:
        names = [key for key, part in self.structure.parts.items() if isinstance(part, kind)]
        if name not in names:
            raise ValueError(f"No {kind.__name__} is named {name!r}; those of the structure are {names}.")
        return name


class Recorder:
    """Makes results of states; keeps the compiled stress expressions between stages."""

    def __init__(self, problem: Problem):
        self.problem = problem
        self.expressions = {name: _part_expression(part) for name, part in problem.parts.items()}

    def __call__(self, name: str, x: PETSc.Vec, actions: Actions, increments: tuple[Increment, ...]) -> StageResult:
        """Result of a state x under actions that the problem holds."""
        problem, discretization = self.problem, self.problem.discretization
        b = discretization.create_vector()
        problem.residual(x, b)
        residual, displacement = discretization.gather(b), discretization.gather(x)
        reactions = np.where(actions.held, residual, 0.0)
        free = np.where(actions.held, 0.0, residual)
        position = discretization.structure.points + displacement
        return StageResult(
            name=name,
            structure=discretization.structure,
            displacement=displacement,
            loads=actions.loads,
            reactions=reactions,
            energy=problem.energy(x),
            equilibrium=Equilibrium(
                loads=actions.loads.sum(axis=0),
                reactions=reactions.sum(axis=0),
                load_moment=np.cross(position, actions.loads).sum(axis=0),
                reaction_moment=np.cross(position, reactions).sum(axis=0),
                residual=float(np.abs(free).max()),
            ),
            increments=increments,
            parts={name: self._part_result(name) for name in discretization.structure.parts},
        )

    def _part_result(self, name: str) -> MembraneResult | BarResult:
        discretization = self.problem.discretization
        membrane = isinstance(discretization.structure.parts[name], Membrane)
        values = self.expressions[name]() if name in self.expressions else None
        columns = discretization.gather_cells(name, values, 28 if membrane else 2).T
        if not membrane:
            return BarResult(strain=columns[0], force=columns[1])
        return MembraneResult(
            strain=_tensors(columns[0:4]),
            second_piola_kirchhoff=_tensors(columns[4:8]),
            cauchy=_tensors(columns[8:17]),
            cauchy_projected=_tensors(columns[17:26]),
            principal=columns[26:28].T,
        )


def _part_expression(part: PartForms) -> _dolfinx.CellExpression:
    """All that is recorded of a part, as one vector-valued expression; `Recorder._part_result` takes it apart."""
    F, S = part.F, part.S
    cauchy = stress.cauchy(F, S, kinematics.stretch_ratio(F))
    if isinstance(part.mesh.part, Membrane):
        projected = stress.cauchy(F, S, kinematics.projected_ratio(F, part.T))
        entries = [*_entries(part.E), *_entries(S), *_entries(cauchy), *_entries(projected)]
        values = ufl.as_vector([*entries, *(stress.principal(cauchy, F)[i] for i in range(2))])
    else:
        values = ufl.as_vector([part.E[0, 0], ufl.tr(cauchy)])
    return _dolfinx.CellExpression(values, part.mesh.mesh)


def _entries(tensor: ufl.core.expr.Expr) -> list[ufl.core.expr.Expr]:
    rows, columns = tensor.ufl_shape
    return [tensor[i, j] for i in range(rows) for j in range(columns)]


def _tensors(columns: Array) -> Array:
    size = int(np.sqrt(len(columns)))
    return np.ascontiguousarray(columns.T).reshape(-1, size, size)
