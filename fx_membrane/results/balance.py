"""Remark on a state that a solver took for equilibrium, with fewer balanced digits than its user relies on."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..assembly.rounding import meeting, prestresses, scales
from .states import StageResult
from .told_states import Remark

UNBALANCED = 1e-6  # of the loads
# Share of the forces that meet at a node, below which what is left of them is rounding. Stiffness does not count: where
# that of a part is so large that its force has no digits, the force itself is not.
FORCE_ROUNDING = 1e-13
SMALLER = "Let the solver stop at smaller unbalanced forces only: a smaller rtol, or the test of a solver of your own"
AT_REST = 10.0  # multiple of the rounding of a solver


class UnbalancedStateWarning(UserWarning):
    """Unbalanced forces above 1e-6 of the loads, or of the reactions where there are no loads.

    Rounding of the forces that meet at a node does not count.
    """


def balance_remarks(result: StageResult) -> Iterator[Remark]:
    """At most one, on unbalanced forces that are neither small beside the loads nor rounding of what meets there."""
    loads, reactions = _size(result.loads), _size(result.reactions)
    kind, forces = ("loads", loads) if loads else ("reactions", reactions)
    unbalanced = result.equilibrium.unbalanced
    if not loads and _at_rest(result):
        return
    off = unbalanced[unbalanced > np.maximum(UNBALANCED * forces, FORCE_ROUNDING * _acting(result))]
    if not len(off):
        return
    yield Remark(
        f"an unbalanced force of {off.max():.3g} is left beside {kind} of {forces:.3g}, "
        "which the tolerance of the solver or rounding allows; displacements, forces and stresses are off accordingly. "
        f"{SMALLER}; check units, and parts that are far stiffer or far more prestressed than the others: a stiffness "
        "of a thousand times theirs is rigid enough.",
        UnbalancedStateWarning,
    )


def _at_rest(result: StageResult) -> bool:
    """Return True if all reactions are rounding, as in a rigid motion without stress."""
    rounding = scales(result.structure, elastic=True, actions=result.actions).rounding(
        float(np.abs(result.displacement).max())
    )
    return bool((np.abs(result.reactions).max(axis=1) <= AT_REST * rounding).all())


def _acting(result: StageResult) -> NDArray[np.float64]:
    """Sizes of the forces of prestress, natural shape and state that meet at each node, shape (n,) [N].

    A prestress counts also where the state has lost it: what is left is the difference of the two.
    """
    given = prestresses(result.structure, result.actions)
    return meeting(
        result.structure,
        {name: given[name] + np.abs(part.principal).max(axis=1) for name, part in result.parts.items()},
    )


def _size(forces: NDArray[np.float64]) -> float:
    """Norm of the sum of nodal forces or, if they balance, of the forces themselves [N]."""
    return float(max(np.abs(forces.sum(axis=0)).max(), np.linalg.norm(forces)))
