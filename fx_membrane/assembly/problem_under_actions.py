"""A problem under given actions: energy, residual, tangent and their derivatives as functions of the displacement."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from petsc4py import PETSc

from ..model.digests import of_settings
from ..model.energy_terms import Term
from ..runtime.processes import refuse_differences, summed, together
from . import stress_changes
from .actions import Actions, between
from .fitting import check_actions, check_matrix, check_vector
from .integral_energies import Borders, IntegralEnergies, add_rate
from .loaded_structure import LoadedStructure, of_actions
from .one_integral import IntegralEnergy
from .parameter_derivatives import by_parameter
from .rounding import UNIT
from .stabilization import Stabilization
from .work_on_line import work


@dataclass(frozen=True, eq=False, repr=False)
class LoadedProblem(LoadedStructure):
    """Energy, residual and tangent of a structure under given actions; made by `Problem.under`.

    It is a frozen view: results depend on the displacement x alone, a PETSc vector in the numbering of the `Problem`.
    Methods are collective. They refuse a vector or matrix of another size, with a ValueError.

    Residual, tangent and derivatives are those of the structure without its constraints: rows of constrained components
    hold reactions and their derivatives. For a linear system, `constraints` replaces these rows: those of a right-hand
    side by `zero_constrained` or `constrain_residual`, those of the tangent, and its columns, by `constrain_tangent`.

    It has the attributes of `LoadedStructure`, too.

    Attributes:
        stabilizer: Stabilization of unit shift.
        shift: Size of the stabilization, a tension in all parts, as a strain. It is in the energy, the residual and the
            tangent; nonzero only during a homotopy.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> problem = Problem(rope)
        >>> loaded = problem.under(problem.actions_of(Stage("pull", [PointLoad(1, (0, 0, -10.0))])))
        >>> problem.to_numpy(loaded.residual(problem.create_vector())).round(6).tolist()
        [[-1000.0, 0.0, 0.0], [0.0, 0.0, 10.0], [1000.0, 0.0, 0.0]]
    """

    stabilizer: Stabilization
    shift: float = 0.0

    def __repr__(self) -> str:
        return f"LoadedProblem({self.structure}, {np.count_nonzero(self.actions.held)} constrained components)"

    def under(self, actions: Actions) -> LoadedProblem:
        """View of the same problem under other actions, the same on all processes; not collective."""
        check_actions("actions", actions, self.structure)
        return replace(self, **of_actions(self.assembler, self.magnitudes, actions, self.cells.compression))

    def with_stabilization(self, shift: float) -> LoadedProblem:
        """View of the problem under the same actions with a stabilization, given as a strain."""
        return replace(self, shift=shift)

    def with_integrals(self, energies: Iterable[IntegralEnergy]) -> LoadedProblem:
        """View of the problem with other energies of integrals."""
        return replace(self, integrals=IntegralEnergies(tuple(energies), settled=False))

    def settled(self, x: PETSc.Vec) -> LoadedProblem:
        """View of the problem with the multipliers of given integrals, anew, that belong to a state."""
        if not self.integrals.given:
            return self
        free = replace(self, integrals=replace(self.integrals, settled=False))
        return replace(free, integrals=free._settled_integrals(x))

    def with_multipliers(self, forces: Sequence[float], penalties: Sequence[float]) -> LoadedProblem:
        """View of the problem with other multipliers of given integrals."""
        return replace(self, integrals=self.integrals.with_multipliers(forces, penalties))

    def without_compression_stiffness(self, left: float = 0.0) -> LoadedProblem:
        """View of the problem without the compression stiffness of wrinkled and slack cells.

        Args:
            left: Fraction of the present compression stiffness that remains [-].
        """
        return replace(self, cells=replace(self.cells, compression=left * self.cells.compression))

    # Energy and its derivatives

    def energy(self, x: PETSc.Vec) -> float:
        """Strain energy less the work of loads of fixed direction, and energy terms [J], Gil (70); without pressures.

        Terms without a potential are left out, too.
        """
        self._update(x)
        return self._energy(x)

    def _energy(self, x: PETSc.Vec) -> float:
        """Energy in the shape x that is set in the forms [J]."""
        with np.errstate(all="ignore"):  # of an iterate that diverges
            energy = self.terms.energy() - float(self.own_loads @ x.array_r)
        energy = summed(self.comm, energy + self.assembler.strain_energy()) + self.integrals.energy(x)
        return energy + self.shift * self.stabilizer.energy(x) if self.shift else energy

    def energy_and_residual(self, x: PETSc.Vec, b: PETSc.Vec) -> float:
        """Energy [J] of a shape that is set in the forms once, which takes messages; b is set to the residual [N]."""
        self.residual(x, b)
        return self._energy(x)

    def energy_along(self, x: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """Energy at x + length step as a function of the length, less the work of `work_along` [J]."""
        without_potential = self.work_along(x, step)

        def energy(length: float) -> float:
            with self.discretization.work(1) as (trial,):
                trial.waxpy(length, step, x)
                return self.energy(trial) - without_potential(length)

        return energy

    def work_along(self, x: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """Work of pressures, and of terms without a potential, from x to x + length step by the length [J].

        Water at the height of an outlet that moves, or into which full basins spill, has no potential. The change of
        its term in `energy` is added to its work, so that a line search counts the work alone.

        The force of a pressure is quadratic in the displacement. Three points give its power along a straight line, so
        that its work is exact with or without a potential. For terms without a potential, five points give the work of
        forces up to the fourth power of the displacement. Of others they give a good estimate, as of water.
        """
        following = self.integrals.without_potential(x)
        here = [one.energy(x) for one in following]
        if self.symmetric and not following:
            return lambda length: 0.0

        def power(length: float) -> float:
            with self.discretization.work(2) as (trial, forces):
                trial.waxpy(length, step, x)
                self._pressure_forces(trial, forces)
                self.terms.add_forces(self.terms.without_potential, forces)
                forces.scale(-1.0)
                for one in following:
                    one.add_gradient(trial, forces)
                return -float(forces.dot(step))

        by_power = work(power, 5 if self.terms.without_potential or following else 3)
        if not following:
            return by_power

        def along(length: float) -> float:
            with self.discretization.work(1) as (trial,):
                trial.waxpy(length, step, x)
                changes = [one.energy(trial) - energy for one, energy in zip(following, here, strict=True)]
            return by_power(length) + sum(changes)

        return along

    def residual(self, x: PETSc.Vec, b: PETSc.Vec | None = None) -> PETSc.Vec:
        """Residual: internal minus external nodal forces [N], Gil (42), (50), (71); the reaction where constrained.

        Args:
            x: Displacement [m].
            b: Vector for the result; a new one if None.
        """
        b = self._vector(b)
        self._of_parts(x, b)
        if self.shift:
            self.stabilizer.add_residual(self.shift, x, b)
        self._settled_integrals(x).add_gradient(x, b)
        return b

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat | None = None) -> PETSc.Mat:
        """Tangent: derivative of the residual by the displacement [N/m], Gil (51)-(53), (57).

        With energies of integrals it is the sparse part; `borders` has the rest.

        Args:
            x: Displacement [m].
            A: Matrix for the result; a new one if None.
        """
        if A is None:
            A = self.discretization.create_matrix()
        else:
            check_matrix("A", A, self.discretization.rows)
        self._update(x)
        self.assembler.tangent(A)
        self.terms.add_tangent(A)
        self._settled_integrals(x).add_hessian(x, A)
        if self.shift:
            self.stabilizer.add_tangent(self.shift, A)
        return A

    def borders(self, x: PETSc.Vec, one_sided: bool = False) -> Borders:
        """Borders of the tangent: the parts of rank one of energies of integrals; free them after use.

        Args:
            x: Displacement [m].
            one_sided: True for the unsymmetric ones of water at an outlet that moves, or below full basins. Otherwise
                it keeps its volume, as where that outlet rises and no more water comes.
        """
        self._update(x)
        return self.integrals.borders(x, self.constraints, self.discretization.create_vector, one_sided)

    def stiffen(self, x: PETSc.Vec, A: PETSc.Mat, b: PETSc.Vec, shift: float) -> None:
        """Add a shift of the stabilization to a constrained tangent, and constrain that again."""
        self.stabilizer.add_tangent(shift, A)
        self.constraints.constrain_tangent(x, A, b)

    # Derivatives by parameters

    def derivative(
        self, x: PETSc.Vec, part: str | Term, parameter: str, direction: ArrayLike = 1.0, b: PETSc.Vec | None = None
    ) -> PETSc.Vec:
        """Differentiate the residual by a parameter of a part, at a fixed displacement [N per unit of the parameter].

        Loads of fixed direction and the stabilization do not follow it.

        Args:
            x: Displacement [m].
            part: Name of the part or of a chamber; or an energy term that acts here, the object itself that the
                structure or a stage has: terms that are equal act separately.
            parameter: "prestress" of the part; "natural_stretch", the natural shape in these actions, with the changes
                of stages; "pressure", of a membrane; or a number of the material: "axial_stiffness" of cables and
                masts; "Et" and "nu" of a `Fabric`; "Et_warp", "Et_weft", "nu" and "Gt" of an `OrthotropicFabric`; or
                another field of a law. Of an energy term, one of its parameters. Of a chamber, "pressure" where it is
                open; "amount" (p V, over T if there is one), "air pressure" and "air temperature" where it is closed.
            direction: Change of the parameter: a prestress or natural stretch in one of the forms that the part takes;
                a pressure for all cells or for each, shape (cells,); or a number. Of an energy term, a change of its
                parameter, in its shape or one for all its cells. The result is linear in it.
            b: Vector for the result; a new one if None.

        Raises:
            ValueError: The part or the parameter does not exist; the term does not act here; the direction has another
                shape; they are not the same on all processes.
        """
        return by_parameter(self, x, part, parameter, direction, self._vector(b))

    def load_derivative(self, x: PETSc.Vec, start: Actions | None = None, b: PETSc.Vec | None = None) -> PETSc.Vec:
        """Differentiate the residual by a load factor, at a fixed displacement [N].

        Prescribed displacements grow with the factor too, but a residual does not depend on them: with `rate =
        loaded.under(loaded.actions.less(start))` and the zero vector, `rate.constraints.constrain_tangent(zero, K, dR)`
        moves their effect into dR, and K du = -dR.

        Args:
            x: Displacement [m].
            start: Actions at the load factor 0, those of this problem being at 1; None for none at all: the factor
                multiplies all loads, pressures and energy terms but those of the structure.
            b: Vector for the result; a new one if None.

        Raises:
            ValueError: The actions at the start do not fit the structure, or are not the same on all processes.
        """
        with together(self.comm):
            if start is not None:
                check_actions("start", start, self.structure)
        refuse_differences(self.comm, lambda: of_settings({"start": start}))
        b, rate = self._vector(b), self if start is None else self.under(self.actions.less(start))
        rate._following(x, b)
        b.array += rate.own_loads
        b.scale(-1.0)
        if start is not None:
            self.add_stress_rate(x, start, self.actions, b)
        if self.integrals.all:
            begin = self.actions.without_gas_pressures() if start is None else start
            add_rate(x, lambda factor: self.under(between(begin, self.actions, factor)).integrals, 1.0, b)
        return b

    def add_stress_rate(self, x: PETSc.Vec, start: Actions, end: Actions, b: PETSc.Vec) -> None:
        """Add the derivative of the residual by a load factor through natural shapes and prestress, at a displacement.

        Args:
            x: Displacement [m].
            start, end: Actions at the load factors 0 and 1; those of this problem are between them.
            b: Vector to which it is added [N].
        """
        if end.changes_stress:
            self._update(x)
            stress_changes.add_rates(self.assembler, start, end, self.actions, b)

    def beyond_rounding(self, x: PETSc.Vec, b: PETSc.Vec) -> float:
        """Norm (2-norm) of a constrained residual in the state x beyond the rounding of each entry [N]."""
        displacement = float(x.norm(PETSc.NormType.NORM_INFINITY))
        sizes = np.zeros(b.local_size)
        self.integrals.add_force_sizes(x, sizes)
        rounding = np.repeat(self.magnitudes.scales.rounding(displacement), 3) + UNIT * sizes
        rounding[self.constraints.rows] = UNIT * self.magnitudes.stiffness * displacement
        return self._norm(np.maximum(np.abs(b.array_r) - rounding, 0.0))

    def _vector(self, b: PETSc.Vec | None) -> PETSc.Vec:
        """Vector for a result: the given one, or a new one."""
        if b is None:
            return self.discretization.create_vector()
        check_vector("b", b, self.discretization.rows)
        return b
