"""The equilibrium problem: total potential energy, residual and tangent of all parts together.

    Pi(u) = sum of strain energies - f . u,    R = dPi/du - f_p(u),    K = dR/du        Gil (50), (51), (68)-(71)

with loads f of fixed direction and follower pressures f_p, which in general have no potential. Loads, constraints and
their displacements change from stage to stage as data: nothing is compiled twice.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import replace
from itertools import count
from typing import NoReturn

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..checks import validation
from ..model import natural_shape
from ..model.digests import fingerprints, of_settings
from ..model.stages import Stage, check_stages
from ..model.structure import Structure
from ..runtime.processes import refuse_differences, together
from . import gas, load_cases
from .actions import Actions, unloaded
from .assembler import Assembler
from .discretization import Discretization
from .fitting import check_actions, check_matrix, check_vector, nodal_values
from .forms_of_parts import PartForms, part_forms
from .loaded_structure import of_actions
from .matrix_forms import mass_form
from .problem_under_actions import LoadedProblem
from .rounding import magnitudes
from .stabilization import Stabilization

NO_MASS = "No part has mass; give mass=... to membranes [kg/m2], cables or masts [kg/m]."
_number = count()


class Problem:
    """Meshes and compiled forms of a structure: the owner of everything that is computed from it.

    One problem serves an analysis, its states, paths and modes, and a researcher's own use. All methods are collective,
    but for those that say so.

    A PETSc vector or matrix has three rows, x, y and z, for each node that a part uses: component c of a node is row
    3 block_of_node[node] + c. `to_petsc` and `to_numpy` translate vectors. Matrices are sparse (AIJ, block size 3),
    with the pattern of all parts together. Processes own consecutive rows.

    Args:
        structure: The structure.
        comm: The processes that share the work; each must give the same structure.
        elastic: False keeps the prestress as the only stress at any strain: for form finding.

    Raises:
        ValueError: An argument is of another kind, or is not the same on all processes.

    Attributes:
        structure: The structure.
        comm: The processes.
        discretization: The meshes and their common numbering.
        parts: Forms of the parts of which this process has cells.
        magnitudes: Typical forces and stiffnesses.
        number: Number of this problem, equal on all its processes.

    Example:
        Derivative of the displacement by the stiffness of the cable, at a state:

        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> state = Analysis(rope).run([pull])["pull"]
        >>> problem = state.problem
        >>> loaded, x = problem.under(state.actions), problem.to_petsc(state.displacement)
        >>> K, dR = loaded.tangent(x), loaded.derivative(x, "rope", "axial_stiffness")
        >>> loaded.constraints.zero_constrained(dR)
        >>> loaded.constraints.constrain_tangent(x, K, dR)
        >>> du = -np.linalg.solve(K.getValues(range(9), range(9)), dR.array)  # K du = -dR
        >>> round(1e9 * float(du.max()), 3)  # nm for each N
        0.174
    """

    def __init__(self, structure: Structure, comm: MPI.Intracomm = MPI.COMM_WORLD, elastic: bool = True):
        validation.communicator("Problem comm", comm)
        with together(comm):
            validation.instance("Problem structure", structure, Structure)
            elastic = validation.truth("Problem elastic", elastic)
            if not elastic:
                natural_shape.refuse("Problem structure without elasticity", structure.parts)
        refuse_differences(comm, lambda: fingerprints(structure) | of_settings({"elastic": elastic}))
        _dolfinx.free_dropped(comm)
        self.structure, self.comm = structure, comm
        self.number = int(comm.bcast(next(_number)))
        self.discretization = Discretization(structure, comm)
        self.parts: dict[str, PartForms] = {
            name: part_forms(mesh, structure, elastic) for name, mesh in self.discretization.parts.items()
        }
        self.magnitudes = magnitudes(structure, elastic, self.discretization.owned_nodes)
        self._assembler = Assembler(self.discretization, self.parts)
        self._stabilizer = Stabilization(self._assembler)

    def under(self, actions: Actions | None = None) -> LoadedProblem:
        """View of the problem under actions, those of the supports alone if None; not collective.

        It copies the actions, and stays as it is whatever else is asked of this problem. Actions must be the same on
        all processes. That is not checked: from different ones, results mix the loads of all processes.

        Args:
            actions: As of `StageResult.actions` or `actions_of`; the same on all processes.

        Raises:
            ValueError: An array of the actions does not have the shape of the structure.
        """
        actions = unloaded(self.structure) if actions is None else actions
        check_actions("actions", actions, self.structure)
        fields = of_actions(self._assembler, self.magnitudes, actions)
        return LoadedProblem(assembler=self._assembler, stabilizer=self._stabilizer, **fields)

    def allow_natural_shapes(self, parts: Iterable[str], given: Iterable[str] = ()) -> None:
        """Compile the forms of a natural shape for some parts, which else happens when one is first met.

        Args:
            parts: Names of the parts.
            given: Names of cables that get a given force, too.
        """
        self._assembler.allow_changes(set(parts), set(given))

    def actions_of(self, stage: Stage, start: Actions | None = None, shape: ArrayLike | None = None) -> Actions:
        """Actions at the end of a stage.

        Args:
            stage: The stage; its `after` and `increments` have no effect.
            start: Actions at its start; those of the supports if None.
            shape: Displacement at its start, shape (n, 3) [m]: a `FixedLength` needs it.

        Raises:
            ValueError: An argument is of another kind, does not fit the structure, or is not the same on all processes.
        """
        start = unloaded(self.structure) if start is None else start
        with together(self.comm):
            validation.plain("actions_of stage", stage, Stage)
            check_stages(self.structure, [replace(stage, after=None)])
            check_actions("actions_of start", start, self.structure)
            known = None if shape is None else nodal_values("actions_of shape", shape, self.structure)
        given = {
            f"{name} of stage {stage.name!r}": getattr(stage, name) for name in ("loads", "displacements", "changes")
        }
        refuse_differences(self.comm, lambda: of_settings(given | {"start": start, "shape": known}))
        return load_cases.at_end(self.structure, self._assembler.nodal_loads, stage, start, known)

    def with_gas_of_start(
        self, start: Actions, end: Actions, displacement: NDArray[np.float64], stage: str
    ) -> tuple[Actions, Actions]:
        """Actions at both ends of a stage, with gas of equal kinds, which a load factor can join.

        The amount of gas that a stage seals is that in its chamber at the start.

        Args:
            start: Actions at the start of the stage.
            end: Actions at its end.
            displacement: Displacement at the start, shape (n, 3) [m].
            stage: Name of the stage.

        Raises:
            ValueError: A chamber is sealed that has no volume.
        """
        if not end.gas and end.air is start.air:
            return start, end
        x = self.discretization.to_petsc(displacement)
        return gas.at_start(start, end, lambda: self.under(start).chambers(x), self.structure.chambers, stage)

    def mass(self, A: PETSc.Mat | None = None) -> PETSc.Mat:
        """Consistent mass matrix [kg], independent of the state.

        Args:
            A: Matrix for the result; a new one if None.

        Raises:
            ValueError: Its rows are not those of this problem in number or distribution.

        Warns:
            UserWarning: No part has mass: all entries are zero.
        """
        if A is not None:
            check_matrix("A", A, self.discretization.rows)
        if not any(part.mass for part in self.structure.parts.values()) and self.comm.rank == 0:
            warnings.warn(f"The mass matrix is zero. {NO_MASS}", stacklevel=2)
        return self._assembler.matrix(mass_form, self.create_matrix() if A is None else A)

    # Numbering and transfer

    @property
    def block_of_node(self) -> NDArray[np.int64]:
        """Block of each node in PETSc objects, shape (n,): entries 3 block + component; -1 for nodes of no part."""
        return self.discretization.block_of_node

    def to_petsc(self, values: ArrayLike) -> PETSc.Vec:
        """Vector of nodal values, shape (n, 3), in the user's order on every process.

        Raises:
            ValueError: The values have another shape, are not finite, or are not the same on all processes.
        """
        with together(self.comm):
            checked = nodal_values("to_petsc values", values, self.structure)
        refuse_differences(self.comm, lambda: of_settings({"values": checked}))
        return self.discretization.to_petsc(checked)

    def to_numpy(self, vector: PETSc.Vec) -> NDArray[np.float64]:
        """Nodal values in the user's order on every process, shape (n, 3); zero at nodes that no part uses.

        Raises:
            ValueError: Its rows are not those of this problem in number or distribution. A vector of another problem
                with as many rows is not told apart.
        """
        check_vector("to_numpy vector", vector, self.discretization.rows)
        return self.discretization.to_numpy(vector)

    def create_vector(self) -> PETSc.Vec:
        """Vector of nodal values, zero."""
        return self.discretization.create_vector()

    def create_matrix(self) -> PETSc.Mat:
        """Matrix with the sparsity pattern of all parts together, exactly preallocated."""
        return self.discretization.create_matrix()

    def __deepcopy__(self, memo: object) -> Problem:
        """Return the same problem: meshes and PETSc objects have no copies."""
        return self

    def __reduce__(self) -> NoReturn:
        raise TypeError("A Problem cannot be pickled; send its structure, and make the problem again from that.")
