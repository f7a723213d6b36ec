"""Places of free mast heads in which prescribed forces balance, where the steps of form finding find none.

A step takes the force of a mast for a force per length: its head runs away from its place of balance. Here the heads
are held while the rest takes steps. Newton's method moves them until nothing is left to hold. Slopes of the reactions
are difference quotients at first, with Broyden's updates from then on. The last step is free, with the forces of masts
as they are, of whatever length.

Source: C. G. Broyden, A class of methods for solving nonlinear simultaneous equations, Mathematics of Computation 19
(1965) 577-593.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from ufl import inner, sqrt

from ...checks import validation
from ...geometry.sizes import measures
from ...model.parts import Part
from ...model.structure import Structure
from .bar_balance import is_standing
from .bar_frame import format_force

Array = NDArray[np.float64]

# Half and double of these were tried on a sail of 14 m between two masts of given force: the heads move by less than
# 7 mm, 5e-4 of the size, and the stress there is off by 0.1 to 0.5 %: both end within the tolerance of a step. FIRST,
# FALL and HALVINGS move nothing there; with SETTLING = 1 the heads are lost.
FIRST = 12  # steps of the rest of the form before the first move of the heads
SETTLING = 3  # the same, after each
# Reaction at a head, relative to the largest force of a mast, from which on a free step is tried.
FREE_STEP_REACTION = 1e-5
DRIFT = 1e-2  # the same, below which it may come from the sliding of nodes, and no move is halved
DIFFERENCE_MOVE = 1e-3  # move of a head for a difference quotient, relative to the shortest mast
MAX_MOVE = 0.2  # the same, of a move at most
FALL = 0.1  # share by which a full move must reduce the reactions, or it is halved
HALVINGS = 5  # maximum number for a move: to 3 % of it
SINGULAR = 1e-8  # slope, relative to the largest, that counts as zero


@dataclass(frozen=True)
class Thrust:
    """Force of masts that does not change with their length."""

    part: str
    force: Any  # shape (cells, 1) [N]

    def energy(self, state: Any, parameters: Any) -> Any:
        """Force times change of length, per reference length [J/m]."""
        return parameters.force * (sqrt(inner(state.F, state.F)) - 1)


def with_thrusts(structure: Structure) -> Structure:
    """Structure with the prestress of its masts as terms."""
    masts = {name: part for name, part in structure.parts.items() if part.is_strut}
    terms = [Thrust(name, part.prestress_tensors()[:, :, 0]) for name, part in masts.items()]
    bare = {name: replace(part, prestress=0.0) for name, part in masts.items()}
    return replace(structure, parts={**structure.parts, **bare}, terms=[*structure.terms, *terms])


def free_heads(structure: Structure) -> NDArray[np.int64]:
    """Nodes with a free component where masts with a force end, shape (h,)."""
    loaded = [part.cells[part.prestress_tensors().ravel() != 0].ravel() for part in _masts(structure)]
    nodes = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *loaded]))
    return nodes[~structure.supported[nodes].all(axis=1)]


def balanced_heads(
    structure: Structure,
    step: Callable[[Array], tuple[Array, Array]],
    fits: Callable[[Array], bool],
    pulse: Callable[[str], None],
    moves: int,
    collapse: str,
) -> Array:
    """Find a shape in which the forces at all free mast heads balance, shape (n, 3) [m].

    It fits, unless the moves were too few.

    Args:
        structure: The first shape, with the forces prescribed.
        step: Step of form finding with the heads held where they are in a shape, with which it is called. It returns
            the next shape and the reactions, both of shape (n, 3); it raises RuntimeError where the shape collapses.
        fits: Tells of a shape if it stays, within the tolerance, in a step with the heads free.
        pulse: Told at each move how far the search is.
        moves: Limit of moves of the heads.
        collapse: Sentences on the collapse without the search.

    Raises:
        RuntimeError: The shape collapses with the heads in their first places, too; or no shape was found: the message
            tells of the collapse and of the force missing at a head.
    """
    points, reactions = structure.points, structure.points
    for _ in range(FIRST):
        points, reactions = step(points)
    reason = f"{collapse} {_missing(structure, points, reactions)}"
    try:
        found = _search(structure, points, step, fits, pulse, moves)
    except RuntimeError:
        found = None
    if found is None or not is_standing(structure, found):
        raise RuntimeError(reason)
    return found


def _search(
    structure: Structure,
    points: Array,
    step: Callable[[Array], tuple[Array, Array]],
    fits: Callable[[Array], bool],
    pulse: Callable[[str], None],
    moves: int,
) -> Array | None:
    """Move the heads until a shape fits, or after all moves is nearly in balance; None without success.

    The shape at the start is one in which the rest of the form has settled.
    """
    heads = free_heads(structure)
    rows, columns = np.nonzero(~structure.supported[heads])
    at, count = (heads[rows], columns), len(rows)
    force = max(np.abs(part.prestress_tensors()).max() for part in _masts(structure))
    length = min(measures(structure.points, part.cells).min() for part in _masts(structure))

    def settled(points: Array, move: Array) -> tuple[Array, Array]:
        moved, reactions = points.copy(), points
        moved[at] += move
        for _ in range(SETTLING):
            moved, reactions = step(moved)
        return moved, reactions[at] / force

    def slopes(points: Array) -> Array:
        base, small = settled(points, np.zeros(count))[1], DIFFERENCE_MOVE * length
        return np.stack([(settled(points, small * one)[1] - base) / small for one in np.eye(count)], axis=1)

    points, rest = settled(points, np.zeros(count))
    slope, fresh = slopes(points), True
    for number in range(moves):
        worst = np.abs(rest).max()
        pulse(f"move {number} of the mast heads, unbalanced share of the largest force of a mast {worst:.1e}")
        if worst <= FREE_STEP_REACTION and fits(points):
            return points
        way = np.linalg.lstsq(slope, -rest, rcond=SINGULAR)[0]
        way = way * min(1.0, MAX_MOVE * length / max(np.abs(way).max(), np.finfo(float).tiny))
        taken = _shortened(settled, points, way, rest)
        if taken is not None:
            move, points, left = taken
            if np.abs(left).max() > DRIFT:  # below, the update would learn from the sliding
                slope = slope + np.outer(left - rest - slope @ move, move) / (move @ move)
                fresh = False
            elif not fresh and np.linalg.norm(left) > np.linalg.norm(rest) / 2:
                slope, fresh = slopes(points), True
            rest = left
        elif fresh:
            break
        else:
            slope, fresh = slopes(points), True
    return points if np.abs(rest).max() <= DRIFT else None


def _shortened(
    settled: Callable[[Array, Array], tuple[Array, Array]], start: Array, way: Array, rest: Array
) -> tuple[Array, Array, Array] | None:
    """Halve a move of the heads until it reduces the reactions enough; None if no share does.

    Returns:
        The move, the shape after it, shape (n, 3) [m], and the reactions there.
    """
    for share in 0.5 ** np.arange(HALVINGS):
        try:
            points, left = settled(start, share * way)
        except RuntimeError:
            continue
        fallen = np.linalg.norm(left) <= (1 - FALL * share) * np.linalg.norm(rest)
        if fallen or np.abs(left).max() <= DRIFT:
            return share * way, points, left
    return None


def _missing(structure: Structure, points: Array, reactions: Array) -> str:
    """Sentence on the largest force that is missing at a head in its first place."""
    heads = free_heads(structure)
    left = np.where(structure.supported[heads], 0.0, reactions[heads])
    worst = int(np.linalg.norm(left, axis=1).argmax())
    where, vector = validation.format_point(points[heads[worst]]), format_force(left[worst])
    return (
        f"With all mast heads in their first places, the force {vector} is missing at node {heads[worst]}, {where}; no "
        "place was found near it without."
    )


def _masts(structure: Structure) -> list[Part]:
    return [part for part in structure.parts.values() if part.is_strut]
