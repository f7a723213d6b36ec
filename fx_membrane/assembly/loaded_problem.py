"""A problem under given actions: energy, residual, tangent and their derivatives as functions of the displacement."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike
from petsc4py import PETSc

from ..model.fingerprints import of_settings
from ..runtime.processes import refuse_differences, together
from . import parameters
from .actions import Actions
from .assembler import Assembler
from .fitting import check_actions, check_matrix, check_vector
from .loaded_structure import LoadedStructure, of_actions
from .rounding import UNIT, Magnitudes
from .stabilization import Stabilization
from .work import work


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
    """

    stabilizer: Stabilization
    shift: float = 0.0

    def __repr__(self) -> str:
        return f"LoadedProblem({self.structure}, {np.count_nonzero(self.actions.held)} constrained components)"

    def under(self, actions: Actions) -> "LoadedProblem":
        """View of the same problem under other actions, the same on all processes; not collective."""
        check_actions("actions", actions, self.structure)
        return replace(self, **of_actions(self.assembler, self.magnitudes, actions, self.cells.compression))

    def with_stabilization(self, shift: float) -> "LoadedProblem":
        """View of the problem under the same actions with a stabilization, given as a strain."""
        return replace(self, shift=shift)

    def without_compression_stiffness(self, left: float = 0.0) -> "LoadedProblem":
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
        with np.errstate(all="ignore"):  # of an iterate that diverges
            energy = self.terms.energy() - float(self.own_loads @ x.array_r)
        energy = float(self.comm.allreduce(energy + self.assembler.strain_energy()))
        return energy + self.shift * self.stabilizer.energy(x) if self.shift else energy

    def energy_along(self, x: PETSc.Vec, step: PETSc.Vec) -> Callable[[float], float]:
        """Energy at x + length step as a function of the length, with the work of pressures along the step [J].

        The force of a pressure is quadratic in the displacement. Three points give its power along a straight line, so
        that its work is exact with or without a potential. For terms without a potential, five points give the work of
        forces up to the fourth power of the displacement. Of others they give a good estimate.
        """

        def energy(length: float) -> float:
            with self.discretization.work(1) as (trial,):
                trial.waxpy(length, step, x)
                return self.energy(trial)

        if self.symmetric:
            return energy

        def power(length: float) -> float:
            with self.discretization.work(2) as (trial, forces):
                trial.waxpy(length, step, x)
                self._pressure_forces(trial, forces)
                self.terms.add_forces(self.terms.without_potential, forces)
                return float(forces.dot(step))

        without_potential = work(power, 5 if self.terms.without_potential else 3)
        return lambda length: energy(length) - without_potential(length)

    def residual(self, x: PETSc.Vec, b: PETSc.Vec | None = None) -> PETSc.Vec:
        """Residual: internal minus external nodal forces [N], Gil (42), (50), (71); the reaction where constrained.

        Args:
            x: Displacement [m].
            b: Vector for the result; a new one if None.
        """
        b = self._vector(b)
        self._update(x)
        self.assembler.internal_forces(b)
        b.array -= self.own_loads
        self.terms.add_forces(self.terms.all, b, -1.0)
        if self.shift:
            self.stabilizer.add_residual(self.shift, x, b)
        return b

    def tangent(self, x: PETSc.Vec, A: PETSc.Mat | None = None) -> PETSc.Mat:
        """Tangent: derivative of the residual by the displacement [N/m], Gil (51)-(53), (57).

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
        if self.shift:
            self.stabilizer.add_tangent(self.shift, A)
        return A

    def stiffen(self, x: PETSc.Vec, A: PETSc.Mat, b: PETSc.Vec, shift: float) -> None:
        """Add a shift of the stabilization to a constrained tangent, and constrain that again."""
        self.stabilizer.add_tangent(shift, A)
        self.constraints.constrain_tangent(x, A, b)

    # Derivatives by parameters

    def derivative(
        self, x: PETSc.Vec, part: str, parameter: str, direction: ArrayLike = 1.0, b: PETSc.Vec | None = None
    ) -> PETSc.Vec:
        """Differentiate the residual by a parameter of a part, at a fixed displacement [N per unit of the parameter].

        Loads of fixed direction and the stabilization do not follow the parameter.

        Args:
            x: Displacement [m].
            part: Name of the part.
            parameter: "prestress"; "pressure", of a membrane; or a number of the material: "axial_stiffness" of cables
                and masts; "Et" and "nu" of a `Fabric`; "Et_warp", "Et_weft", "nu" and "Gt" of an `OrthotropicFabric`;
                or another field of a law.
            direction: Change of the parameter: a prestress in one of the forms that the part takes; a pressure for all
                cells or for each, shape (cells,); or a number. The result is linear in it.
            b: Vector for the result; a new one if None.

        Raises:
            ValueError: There is no such part or parameter; the direction has another shape; they are not the same on
                all processes.
        """
        with together(self.comm):
            given = parameters.Change(self.structure, part, parameter, direction)
        settings = {"part": part, "parameter": parameter, "direction": given.values}
        refuse_differences(self.comm, lambda: of_settings(settings))
        b = self._vector(b)
        if given.parameter == "pressure":
            data = replace(self.cells, pressures=given.on_cells(self.assembler.parts))
            check_vector("x", x, self.discretization.rows)
            self.assembler.update(x, data)
            self.assembler.vector(lambda part: part.pressure, b).scale(-1.0)
            return b
        self._update(x)
        return self.assembler.vector(given.form, b)

    def load_derivative(self, x: PETSc.Vec, start: Actions | None = None, b: PETSc.Vec | None = None) -> PETSc.Vec:
        """Differentiate the residual by a load factor, at a fixed displacement [N].

        Prescribed displacements of the stage grow with the factor too, but a residual does not depend on them: with
        `rate = loaded.under(loaded.actions.less(start))` and the zero vector,
        `rate.constraints.constrain_tangent(zero, K, dR)` moves their effect into dR, and K du = -dR.

        Args:
            x: Displacement [m].
            start: Actions at the load factor 0, those of this problem being at 1; None for none at all, so that the
                factor multiplies all loads, pressures and energy terms. Terms of the structure do not follow it.
            b: Vector for the result; a new one if None.

        Raises:
            ValueError: The actions at the start do not fit the structure, or are not the same on all processes.
        """
        with together(self.comm):
            if start is not None:
                check_actions("start", start, self.structure)
        refuse_differences(self.comm, lambda: of_settings({"start": start}))
        b = self._vector(b)
        rate = self if start is None else self.under(self.actions.less(start))
        rate._following(x, b)
        b.array += rate.own_loads
        b.scale(-1.0)
        return b

    def beyond_rounding(self, x: PETSc.Vec, b: PETSc.Vec) -> float:
        """Norm (2-norm) of a constrained residual in the state x beyond the rounding of each entry [N]."""
        displacement = float(x.norm(PETSc.NormType.NORM_INFINITY))
        rounding = self.magnitudes.scales.rounding(displacement)
        rounding[self.constraints.rows] = UNIT * self.magnitudes.stiffness * displacement
        beyond = np.maximum(np.abs(b.array_r) - rounding, 0.0)
        return self._norm(beyond)

    def _vector(self, b: PETSc.Vec | None) -> PETSc.Vec:
        """Vector for a result: the given one, or a new one."""
        if b is None:
            return self.discretization.create_vector()
        check_vector("b", b, self.discretization.rows)
        return b


def loaded_problem(
    assembler: Assembler, stabilizer: Stabilization, magnitudes: Magnitudes, actions: Actions
) -> LoadedProblem:
    """View of a problem under actions."""
    given = of_actions(assembler, magnitudes, actions)
    return LoadedProblem(assembler=assembler, stabilizer=stabilizer, magnitudes=magnitudes, **given)
