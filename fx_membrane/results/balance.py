"""Remark where a state that a solver took for equilibrium is not in balance to the digits that its user relies on."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..assembly.rounding import prestress_force
from .states import Remark, StageResult

UNBALANCED = 1e-6  # of the loads
LOST = 1e-9  # share of the prestress that counts as none


class UnbalancedStateWarning(UserWarning):
    """Unbalanced forces above 1e-6 of the loads, or of the reactions where there are no loads."""


class _Unbalanced(Remark):
    category = UnbalancedStateWarning


def balance_remarks(result: StageResult) -> Iterator[Remark]:
    """At most one, on unbalanced forces that are not small beside the loads."""
    loads, reactions = _size(result.loads), _size(result.reactions)
    kind, forces = ("loads", loads) if loads else ("reactions", reactions)
    residual = result.equilibrium.residual
    # Where prestress has vanished without a load, reactions are rounding themselves.
    if (
        not residual > UNBALANCED * max(forces, 0.0 if loads else LOST * prestress_force(result.structure))
        or not forces
    ):
        return
    yield _Unbalanced(
        f"an unbalanced force of {residual:.3g} is left beside {kind} of {forces:.3g}, "
        "which the tolerance of the solver or rounding allows; displacements, forces and stresses are off accordingly. "
        "Give the solver a smaller rtol; check units, and parts that are far stiffer or far more prestressed than the "
        "others: a stiffness of a thousand times theirs is rigid enough."
    )


def _size(forces: NDArray[np.float64]) -> float:
    """Size of nodal forces, of their sum or, where they balance each other, their 2-norm [N]."""
    return float(max(np.abs(forces.sum(axis=0)).max(), np.linalg.norm(forces)))
