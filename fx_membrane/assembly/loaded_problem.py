"""A problem under given actions: energy, residual, tangent and their derivatives as functions of the displacement."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray
from petsc4py import PETSc

from ..model.energy_terms import Acting
from ..model.fingerprints import of_settings
from ..model.structure import Structure
from ..runtime.processes import refuse_differences, together
from . import parameters
from .actions import Actions, change
from .assembler import Assembler, CellData
from .constraints import Constraints, constraints
from .discretization import Discretization
from .energy_terms import Terms, terms_of
from .fitting import check_actions, check_matrix, check_vector
from .rounding import UNIT, Magnitudes
from .stabilization import Stabilization
from .work import work


@dataclass(frozen=True, eq=False, repr=False)
class LoadedProblem:
    """Energy, residual and tangent of a structure under given actions; made by `Problem.under`.

    It is a frozen view: results depend on the displacement x alone, a PETSc vector in the numbering of the `Problem`.
    Methods are collective. They refuse a vector or matrix of another problem, with a ValueError.

    Residual, tangent and derivatives are those of the structure without its constraints: rows of constrained components
    hold reactions and their derivatives. For a linear system, `constraints` replaces these rows: those of a right-hand
    side by `zero_constrained` or `constrain_residual`, those of the tangent, and its columns, by `constrain_tangent`.

    Attributes:
        actions: The actions.
        constraints: The constrained components, with operations on vectors and on the tangent.
        assembler: Sums over the parts.
        stabilizer: Stabilization of unit shift.
        magnitudes: Typical forces and stiffnesses.
        symmetric: True if the tangent is symmetric: without follower pressure and terms without a potential.
        own_loads: Dead loads on the nodes of this process, in the order of a PETSc vector [N].
        cells: Pressures and compression stiffness of the cells of this process.
        terms: Energy terms of the structure and of the actions.
        shift: Stabilization: artificial tension in all parts, as a strain, times the stiffness of each. It is in the
            energy, the residual and the tangent; nonzero only during a homotopy.
    """

    actions: Actions
    constraints: Constraints
    assembler: Assembler
    stabilizer: Stabilization
    magnitudes: Magnitudes
    symmetric: bool
    own_loads: NDArray[np.float64]
    cells: CellData
    terms: Terms
    shift: float = 0.0

    def __repr__(self) -> str:
        return f"LoadedProblem({self.structure}, {np.count_nonzero(self.actions.held)} constrained components)"

    @property
    def discretization(self) -> Discretization:
        """The meshes and their common numbering."""
        return self.assembler.discretization

    @property
    def structure(self) -> Structure:
        """The structure."""
        return self.discretization.structure

    @property
    def comm(self) -> MPI.Intracomm:
        """The processes that share the work."""
        return self.discretization.comm

    def under(self, actions: Actions) -> "LoadedProblem":
        """View of the same problem under other actions, the same on all processes; not collective."""
        check_actions("actions", actions, self.structure)
        return replace(self, **_of_actions(self.assembler, self.magnitudes, actions, self.cells.compression))

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
        """Strain energy less the work of the dead loads, and energy terms [J], Gil (70); without pressures.

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
        forces up to the fourth power of the displacement, and a good estimate of others.
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
        """Residual: internal minus external nodal forces [N], Gil (50); at constrained components, the reaction.

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
        """Add a shift, an artificial tension given as a strain, to a constrained tangent."""
        self.stabilizer.add_tangent(shift, A)
        self.constraints.constrain_tangent(x, A, b)

    # Derivatives by parameters

    def derivative(
        self, x: PETSc.Vec, part: str, parameter: str, direction: ArrayLike = 1.0, b: PETSc.Vec | None = None
    ) -> PETSc.Vec:
        """Differentiate the residual by a parameter of a part, at a fixed displacement [N per unit of the parameter].

        Dead loads and the artificial tension of a stabilization do not follow the parameter.

        Args:
            x: Displacement [m].
            part: Name of the part.
            parameter: "prestress"; "pressure", of a membrane; or a number of the material: "axial_stiffness" of cables
                and masts, "Et" and "nu" of a `Fabric`, "Et_warp", "Et_weft", "nu" and "Gt" of an `OrthotropicFabric`,
                or another field of a law.
            direction: Change of the parameter: a prestress in one of the forms that the part takes, a pressure for all
                cells or for each, shape (cells,), or a number. The result is linear in it.
            b: Vector for the result; a new one if None.

        Raises:
            ValueError: There is no such part or parameter, or the direction has another shape, or they are not the
                same on all processes.
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
        `rate = loaded.under(change(start, loaded.actions))` and the zero vector,
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
        rate = self if start is None else self.under(change(start, self.actions))
        rate._following(x, b)
        b.array += rate.own_loads
        b.scale(-1.0)
        return b

    # Loads

    def loads(self, x: PETSc.Vec, total: PETSc.Vec) -> None:
        """Set a vector to the nodal loads in the shape x: dead loads, pressures and all energy terms [N]."""
        self._following(x, total)
        self.terms.add_forces(self.terms.standing, total)
        total.array += self.own_loads

    def pressure_loads(self, x: PETSc.Vec) -> NDArray[np.float64]:
        """Convert the pressures to nodal forces in the shape x, shape (n, 3) [N]."""
        with self.discretization.work(1) as (total,):
            return self.discretization.to_numpy(self._pressure_forces(x, total))

    def term_forces(self, x: PETSc.Vec) -> list[tuple[Acting, NDArray[np.float64]]]:
        """Energy terms, and their nodal forces in the shape x, shape (n, 3) [N]."""
        self._update(x)
        with self.discretization.work(1) as (total,):
            gather = self.discretization.to_numpy
            return [(acting, gather(self.terms.forces([acting], total))) for acting in self.terms.all]

    def standing_norm(self, x: PETSc.Vec) -> float:
        """2-norm of the nodal forces of the structure's energy terms in the shape x [N]."""
        if not self.terms.standing:
            return 0.0
        self._update(x)
        with self.discretization.work(1) as (total,):
            return float(self.terms.forces(self.terms.standing, total).norm())

    def load_norm(self, x: PETSc.Vec) -> float:
        """2-norm of the nodal loads in the shape x: dead loads, pressures, energy terms of the actions [N]."""
        dead = self._norm(self.own_loads)
        if not (self.actions.pressed or self.terms.applied):
            return dead
        with self.discretization.work(1) as (total,):
            return dead + float(self._following(x, total).norm())

    def unloaded(self) -> bool:
        """Return True if there are supports and prestress alone, without loads or prescribed displacements."""
        loaded = bool(self.own_loads.any() or self.constraints.prescribed.any())
        following = self.actions.pressed or self.terms.applied
        return not (following or self.comm.allreduce(loaded, MPI.LOR))

    def beyond_rounding(self, x: PETSc.Vec, b: PETSc.Vec) -> float:
        """Norm (2-norm) of a constrained residual in the state x beyond the rounding of each entry [N]."""
        displacement = float(x.norm(PETSc.NormType.NORM_INFINITY))
        rounding = self.magnitudes.scales.rounding(displacement)
        rounding[self.constraints.rows] = UNIT * self.magnitudes.stiffness * displacement
        beyond = np.maximum(np.abs(b.array_r) - rounding, 0.0)
        return self._norm(beyond)

    def _norm(self, own: NDArray[np.float64]) -> float:
        """2-norm of a vector from the entries of this process."""
        with np.errstate(all="ignore"):  # of an iterate that diverges
            square = float(own @ own)
        return math.sqrt(self.comm.allreduce(square))

    def _vector(self, b: PETSc.Vec | None) -> PETSc.Vec:
        """Vector for a result: the given one, or a new one."""
        if b is None:
            return self.discretization.create_vector()
        check_vector("b", b, self.discretization.rows)
        return b

    def _update(self, x: PETSc.Vec) -> None:
        check_vector("x", x, self.discretization.rows)
        self.assembler.update(x, self.cells)

    def _pressure_forces(self, x: PETSc.Vec, total: PETSc.Vec) -> PETSc.Vec:
        self._update(x)
        if not self.actions.pressed:
            total.set(0.0)
            return total
        return self.assembler.vector(lambda part: part.pressure, total)

    def _following(self, x: PETSc.Vec, total: PETSc.Vec) -> PETSc.Vec:
        """Set a vector to the nodal loads that depend on the shape, of the actions [N]."""
        self._pressure_forces(x, total)
        self.terms.add_forces(self.terms.applied, total)
        return total


def loaded_problem(
    assembler: Assembler, stabilizer: Stabilization, magnitudes: Magnitudes, actions: Actions
) -> LoadedProblem:
    """View of a problem under actions."""
    given = _of_actions(assembler, magnitudes, actions)
    return LoadedProblem(assembler=assembler, stabilizer=stabilizer, magnitudes=magnitudes, **given)


def _of_actions(
    assembler: Assembler, magnitudes: Magnitudes, actions: Actions, compression: float = 1.0
) -> dict[str, Any]:
    """Fields of a view that belong to its actions, copied from them."""
    discretization = assembler.discretization
    pressures = {
        name: actions.pressures[name][part.mesh.cell_rows].astype(np.float64)
        for name, part in assembler.parts.items()
        if name in actions.pressures
    }
    terms = terms_of(assembler.terms, actions.terms)
    return {
        "actions": actions,
        "constraints": constraints(discretization, actions, magnitudes.stiffness),
        "symmetric": not (actions.pressed or terms.without_potential),
        "own_loads": actions.loads[discretization.owned_nodes].ravel(),
        "cells": CellData(pressures, compression),
        "terms": terms,
    }
