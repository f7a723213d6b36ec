"""Net of force densities under constraints, step by step towards the forces and the geometry of its branches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..model.parts import Cable
from ..model.structure import Structure
from ..model.supports import Support
from .balance.cable_forces import difference
from .balance.constrained_balance import ConstrainedBalance, shortfall
from .balance.membrane_balance import collapse_of
from .constraints.cable_targets import TARGET_ERROR
from .constraints.hand_over import handed_over
from .constraints.kinds import Constraint
from .form import Form

Array = NDArray[np.float64]


def constrained_net(
    points: Array,
    branches: NDArray[np.int64],
    densities: Array,
    fixed: Sequence[Support],
    force: Array,
    constraints: Sequence[Constraint],
    tolerance: float,
    max_iterations: int,
) -> tuple[Form, str]:
    """Form of a net, and the reason for which its constraints are not met, in words; empty if they are.

    Args:
        points: First shape, with sliding nodes, rings and rigid bodies in their first places, shape (n, 3) [m].
        branches: Pairs of node numbers, shape (b, 2).
        densities: Force densities, of branches without a constraint, shape (b,) [N/m].
        fixed: Supports.
        force: Loads on the nodes, shape (n, 3) [N].
        constraints: Constraints of branches, as cable "net", and of nodes.
        tolerance: Accepted relative difference of forces [-].
        max_iterations: Maximum number of steps.

    Raises:
        ValueError, RuntimeError: A constraint does not fit the net, or the first step has no shape.
    """
    net = Structure(points, {"net": Cable(branches, 1.0, densities)}, fixed)  # of any stiffness: no strain here
    balance = ConstrainedBalance(
        net, [force], constraints, np.eye(3), "force density", lambda shape, _: collapse_of(net, shape)
    )
    following, accelerated = balance.start({}), balance.acceleration()
    kept, trouble = None, ""
    for number in range(1, max_iterations + 1):
        found = balance(points, {}, following, number)
        if isinstance(found, str):
            trouble = found
            break
        kept, points = found, found.points
        miss, words = balance.targets.miss(points, following, found.wanted)
        error = difference(following, found.wanted)
        if error <= tolerance and miss <= TARGET_ERROR:
            break
        following = accelerated(following, found.wanted)
    if kept is None:
        raise RuntimeError(f"The net has no shape in the first step: {trouble}")
    trouble = trouble or shortfall(error, tolerance, number, miss, words) or balance.motions.turned(kept.points)
    forces = kept.densities["net"] * np.linalg.norm(np.diff(kept.points[branches], axis=1)[:, 0], axis=1)
    made = {"net": Cable(branches, 1.0, forces)}, {"net": forces}
    form = handed_over(net, balance.motions, kept.points, made, kept.reactions, (), not trouble)
    return replace(form, made=None, supports=tuple(form.structure.supports)), trouble
