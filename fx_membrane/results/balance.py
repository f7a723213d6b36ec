"""Warning of unbalanced forces in a state that a solver took for equilibrium."""

import warnings

import numpy as np
from numpy.typing import NDArray

from ..assembly.rounding import prestress_force
from .states import StageResult

UNBALANCED = 1e-6  # fraction of the loads
LOST = 1e-9  # fraction of the prestress that counts as zero


class UnbalancedStateWarning(UserWarning):
    """Unbalanced forces above 1e-6 of the loads, or of the reactions where there are no loads."""


def warn_of_unbalance(result: StageResult, stacklevel: int) -> None:
    """Warn of unbalanced forces that are not small beside the loads."""
    loads, reactions = _size(result.loads), _size(result.reactions)
    kind, forces = ("loads", loads) if loads else ("reactions", reactions)
    residual = result.equilibrium.residual
    # If prestress has vanished without a load, reactions are rounding themselves.
    if (
        not residual > UNBALANCED * max(forces, 0.0 if loads else LOST * prestress_force(result.structure))
        or not forces
    ):
        return
    warnings.warn(
        f"Stage {result.name!r}: an unbalanced force of {residual:.3g} is left beside {kind} of {forces:.3g}, "
        "which the tolerance of the solver or rounding allows; displacements, forces and stresses are off accordingly. "
        "Give the solver a smaller rtol; check units, and parts that are far stiffer or far more prestressed than the "
        "others: a stiffness of a thousand times theirs is rigid enough.",
        UnbalancedStateWarning,
        stacklevel=stacklevel,
    )


def _size(forces: NDArray[np.float64]) -> float:
    """Norm of the sum of nodal forces or, if they balance, of the forces themselves [N]."""
    return float(max(np.abs(forces.sum(axis=0)).max(), np.linalg.norm(forces)))
