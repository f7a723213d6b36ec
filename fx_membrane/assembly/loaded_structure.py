"""Loads of given actions on a structure, as functions of the displacement."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from ..model.energy_terms import Acting
from ..model.natural_shape import inverse_less_identity
from ..model.structure import Structure
from ..runtime.processes import somewhere, summed
from .acting_integrals import integrals_of
from .actions import Actions
from .assembler import Assembler, CellData
from .discretization import Discretization
from .energy_terms import Terms, terms_of
from .fitting import check_vector
from .gas import ChamberResult
from .held_components import Constraints, constraints
from .integral_energies import IntegralEnergies
from .ropes import rope_data
from .rounding import Magnitudes


@dataclass(frozen=True, eq=False, repr=False)
class LoadedStructure:
    """Nodal loads of a structure under given actions, in any shape; the loads of a `LoadedProblem`.

    Attributes:
        actions: The actions.
        constraints: The constrained components, with operations on vectors and on the tangent.
        assembler: Sums over the parts.
        magnitudes: Typical forces and stiffnesses.
        symmetric: True if the tangent is symmetric: without follower pressure and terms without a potential.
        own_loads: Loads of fixed direction on the nodes of this process, in the order of a PETSc vector [N].
        cells: Pressures and compression stiffness of the cells of this process.
        terms: Energy terms of the structure and of the actions.
        integrals: Energies of one integral each, as of enclosed gas.
    """

    actions: Actions
    constraints: Constraints
    assembler: Assembler
    magnitudes: Magnitudes
    symmetric: bool
    own_loads: NDArray[np.float64]
    cells: CellData
    terms: Terms
    integrals: IntegralEnergies

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

    def loads(self, x: PETSc.Vec, total: PETSc.Vec) -> None:
        """Set a vector to all nodal loads in the shape x, those of pressures and energy terms included [N]."""
        self._following(x, total)
        self.terms.add_forces(self.terms.standing, total)
        total.array += self.own_loads
        self._settled_integrals(x).loads(x, total)

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

    def term_energies(self, x: PETSc.Vec) -> list[float]:
        """Energies of the energy terms in the shape x [J]; 0 for those without a potential."""
        self._update(x)
        own = np.array([self.terms.energy_of(acting) for acting in self.terms.all])
        return np.asarray(self.comm.allreduce(own)).tolist()

    def standing_norm(self, x: PETSc.Vec) -> float:
        """2-norm of the nodal forces of the structure's energy terms in the shape x [N]."""
        if not self.terms.standing:
            return 0.0
        self._update(x)
        with self.discretization.work(1) as (total,):
            return float(self.terms.forces(self.terms.standing, total).norm())

    def load_norm(self, x: PETSc.Vec) -> float:
        """2-norm of the nodal loads in the shape x [N]; energy terms of the structure are left out."""
        fixed = self._norm(self.own_loads)
        if not (self.actions.pressed or self.terms.applied or self.integrals.all):
            return fixed
        with self.discretization.work(1) as (total,):
            self._following(x, total)
            self._settled_integrals(x).loads(x, total)
            return fixed + float(total.norm())

    def unloaded(self) -> bool:
        """Return True if there are supports and prestress alone: no loads, prescribed displacements or changes."""
        loaded = bool(self.own_loads.any() or self.constraints.prescribed.any())
        following = self.actions.pressed or self.terms.applied or self.actions.changes_stress
        following = following or any(energy.is_load for energy in self.integrals.all)
        return not (following or somewhere(self.comm, loaded))

    def _norm(self, own: NDArray[np.float64]) -> float:
        """2-norm of a vector from the entries of this process."""
        with np.errstate(all="ignore"):  # of an iterate that diverges
            square = float(own @ own)
        return math.sqrt(summed(self.comm, square))

    def integral_loads(self, x: PETSc.Vec) -> NDArray[np.float64]:
        """Nodal forces of the integrals that are loads, as of enclosed gas, in the shape x, shape (n, 3) [N]."""
        with self.discretization.work(1) as (total,):
            total.set(0.0)
            self._settled_integrals(x).loads(x, total)
            return self.discretization.to_numpy(total)

    def chambers(self, x: PETSc.Vec) -> dict[str, ChamberResult]:
        """State of the gas in each chamber in the shape x."""
        if not self.structure.chambers:
            return {}
        return self.assembler.chambers.states(self.actions, self._settled_integrals(x), x)

    def _settled_integrals(self, x: PETSc.Vec) -> IntegralEnergies:
        """Energies of integrals with multipliers: their own, or those of the state."""
        if self.integrals.settled or not self.integrals.given:
            return self.integrals
        with self.discretization.work(1) as (b,):
            self._of_parts(x, b)
            self.integrals.add_gradient(x, b)
            return self.integrals.settle(x, b, self.constraints)

    def _of_parts(self, x: PETSc.Vec, b: PETSc.Vec) -> None:
        """Set a vector to the residual without the forces of integrals and of a stabilization [N]."""
        self._update(x)
        self.assembler.internal_forces(b)
        b.array -= self.own_loads
        self.terms.add_forces(self.terms.all, b, -1.0)

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


def of_actions(
    assembler: Assembler, magnitudes: Magnitudes, actions: Actions, compression: float = 1.0
) -> dict[str, Any]:
    """Fields of a view that belong to its actions, copied from them."""
    discretization = assembler.discretization
    pressures = {
        name: actions.pressures[name][part.mesh.cell_rows].astype(np.float64)
        for name, part in assembler.parts.items()
        if name in actions.pressures
    }
    assembler.allow_changes(actions.natural, actions.tensions)
    natural, prestress, tensions = {}, {}, {}
    for name, part in assembler.parts.items():
        if name in actions.natural:
            natural[name] = inverse_less_identity(actions.natural[name][part.mesh.cell_rows])
        if name in actions.tensions:
            tensions[name] = actions.tensions[name][part.mesh.cell_rows]
        if name in actions.prestress:
            factors, own = actions.prestress[name], part.mesh.part.prestress_tensors()
            prestress[name] = (factors[:, None, None] * own)[part.mesh.cell_rows]
    ropes = rope_data(discretization.structure, actions, magnitudes.elastic)
    terms = terms_of(assembler.terms, actions.terms)
    return {
        "actions": actions,
        "magnitudes": magnitudes.under(discretization.structure, discretization.owned_nodes, actions),
        "constraints": constraints(discretization, actions, magnitudes.stiffness),
        "symmetric": not (actions.pressed or terms.without_potential),
        "own_loads": actions.loads[discretization.owned_nodes].ravel(),
        "cells": CellData(pressures, compression, natural, prestress, ropes, tensions),
        "terms": terms,
        "integrals": integrals_of(assembler, actions),
    }
