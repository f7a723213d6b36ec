"""Masts of given length that stand in stays of given force, where the steps of form finding lay them down.

Cables whose force does not change with their length balance an upright mast, but do not bring it back: its place is no
least energy, which steps go to. Real stays, with their stiffness, hold it. Here the heads are held while the method
finds the rest. Powell's method moves them on spheres around their feet until no force is left across a mast.

Source: M. J. D. Powell, A hybrid method for nonlinear equations, in: P. Rabinowitz (ed.), Numerical Methods for
Nonlinear Algebraic Equations, Gordon and Breach 1970, 87-114, as `scipy.optimize.root(method="hybr")`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.optimize import root

from ...checks.values import format_point
from ...model.parts import Bar
from ...model.structure import Structure
from ...model.supports import Support
from ..constraints.kinds import RigidBody
from ..form import Form
from .bar_balance import MAX_TURN
from .bar_frame import BarFrame, format_force

Array = NDArray[np.float64]
Find = Callable[..., Form]  # of a structure, and constraints by that name

# Half and double of each were tried on a hypar in projection, on two masts in stays of unequal force: no node moves by
# more than 1e-13 of the size: the search is Newton's, and ends far below ACROSS.
ACROSS = 1e-4  # force across masts over the largest reaction at a head, which the forces of stays take up afterwards
SETTLED_TURN = 1e-9  # change of turns at which the search ends: the forces across are below the limit long before
SLOPE = 1e-3  # turn for a difference quotient [rad]: far above rounding, far below any turn that bends the forces
REACH = 0.3  # first move of all heads at most [rad]: a third of the way to the turn that counts as fallen
MAX_MOVES = 20  # maximum number of moves of the heads, of which some five are needed
# Accepted difference of stays from their forces, over the largest: ten times what is left across masts.
WANTED_FORCE_ERROR = 1e-3
LOST_FORCE = 10.0  # force across a mast, over the largest reaction at a head, that stands for a place without a form


@dataclass(frozen=True)
class _Masts:
    """Masts of given length from a held foot to a free head: their nodes, shape (m,), and their rigid bodies."""

    feet: NDArray[np.int64]
    heads: NDArray[np.int64]
    bodies: tuple[RigidBody, ...]


def has_masts(structure: Structure, constraints: Sequence[Any]) -> bool:
    """Return True if rigid bodies are masts of given length, from a held foot to a free head."""
    return bool(len(_rigid_masts(structure, constraints).heads))


def stand(
    find: Find,
    structure: Structure,
    constraints: Sequence[Any],
    fallen: Form,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
    guide: Find | None = None,
    ended: bool = False,
) -> tuple[Form | None, str]:
    """Find the form in which masts of given length stand; collective.

    Args:
        find: The method, called with another structure and with other `constraints`.
        structure: The first shape.
        constraints: Those of the method; rigid bodies of a held foot and a free head are masts.
        fallen: The form of the method, in which some may have fallen.
        comm: The processes that share the work.
        guide: A cheaper method, whose forms tell how the forces change with the places of the heads.
        ended: True if the steps towards the form ended early, so that the masts may have been falling.

    Returns:
        The form, after the warnings of the method in it. None, with an empty text, if no mast has fallen; None, with
        the missing force in words, if no place of the heads was found.
    """
    masts = _rigid_masts(structure, constraints)
    if not len(masts.heads) or not (ended or _turned(masts, structure.points, fallen.points)):
        return None, ""
    others = [each for each in constraints if not any(each is body for body in masts.bodies)]
    held, told = Support(masts.heads), list[warnings.WarningMessage]()

    def form_at(points: Array, method: Find = find) -> Form:
        nonlocal told
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            return method(replace(structure, points=points, supports=[*structure.supports, held]), constraints=others)

    try:
        first = form_at(structure.points)
    except (RuntimeError, ValueError):
        return None, ""
    heads = _Heads(masts, structure.points, first)

    def across(turns: Array, method: Find = find) -> Array:
        return np.asarray(comm.bcast(heads.across(lambda points: form_at(points, method), turns)))

    def slopes(turns: Array) -> Array:
        for method in (guide or find, find):
            if (base := across(turns, method)).max() < LOST_FORCE:
                break
        return np.stack([across(turns + SLOPE * one, method) - base for one in np.eye(len(turns))], axis=1) / SLOPE

    start = np.ones(2 * len(masts.heads))
    options = {"factor": REACH / np.sqrt(len(start)), "maxfev": MAX_MOVES, "xtol": SETTLED_TURN}
    found = root(across, start, jac=slopes, method="hybr", options=options)
    if np.abs(found.fun).max() > ACROSS:
        return None, heads.missing(first)
    try:
        standing = _released(form_at(heads.placed(found.x)), masts, held)
    except (RuntimeError, ValueError) as unbalanced:
        return None, str(unbalanced)
    for record in told:
        warnings.warn(record.message, stacklevel=3)
    return standing, ""


class _Heads:
    """Places of mast heads by turns of their masts, and the forces across these."""

    def __init__(self, masts: _Masts, points: Array, first: Form) -> None:
        way = points[masts.heads] - points[masts.feet]
        self.masts, self.points = masts, points
        self.length = np.linalg.norm(way, axis=1, keepdims=True)
        self.upright = way / self.length
        self.axes = np.stack([np.linalg.svd(direction[None])[2][1:] for direction in self.upright])
        self.force = max(float(np.abs(first.reactions[masts.heads]).max()), np.finfo(float).tiny)

    def placed(self, turns: Array) -> Array:
        """First shape with the heads where turns of their masts, one without any, put them, shape (n, 3)."""
        turned = self.upright + np.einsum("mk,mkc->mc", turns.reshape(-1, 2) - 1, self.axes)
        points = self.points.copy()
        points[self.masts.heads] = points[self.masts.feet] + self.length * turned / np.linalg.norm(
            turned, axis=1, keepdims=True
        )
        return points

    def across(self, form_at: Callable[[Array], Form], turns: Array) -> Array:
        """Return forces across the masts along two axes of each, over the largest reaction, shape (2 m,)."""
        points = self.placed(turns)
        if _turned(self.masts, self.points, points):
            return np.full(turns.shape, LOST_FORCE)
        try:
            form = form_at(points)
        except (RuntimeError, ValueError):
            return np.full(turns.shape, LOST_FORCE)
        return np.einsum("mc,mkc->mk", self._rest(form), self.axes).ravel() / self.force

    def missing(self, first: Form) -> str:
        """Tell of the largest force that is missing across a mast in its first place."""
        rest = self._rest(first)
        worst = int(np.linalg.norm(rest, axis=1).argmax())
        node = self.masts.heads[worst]
        return (
            f"With all mast heads in their first places, the force {format_force(rest[worst])} is missing across the "
            f"mast at node {node}, {format_point(self.points[node])}; no place was found near them without."
        )

    def _rest(self, form: Form) -> Array:
        heads = self.masts.heads
        reaction = form.reactions[heads]
        along = form.points[heads] - form.points[self.masts.feet]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        return np.asarray(reaction - np.sum(reaction * along, axis=1, keepdims=True) * along)


def _rigid_masts(structure: Structure, constraints: Sequence[Any]) -> _Masts:
    """Rigid bodies of two nodes, a held foot and a free head."""
    held, used = structure.supported, structure.used
    found = []
    for body in (each for each in constraints if isinstance(each, RigidBody)):
        nodes = np.asarray(body.nodes)
        feet, heads = nodes[held[nodes].all(axis=1)], nodes[~held[nodes].any(axis=1)]
        if len(nodes) == 2 and len(feet) == len(heads) == 1 and used[nodes].all():
            found.append((feet[0], heads[0], body))
    feet, heads, bodies = zip(*found, strict=True) if found else ((), (), ())
    return _Masts(np.array(feet, dtype=np.int64), np.array(heads, dtype=np.int64), bodies)


def _turned(masts: _Masts, before: Array, now: Array) -> bool:
    """Return True if one has turned by more than 45 degrees."""
    first, last = before[masts.heads] - before[masts.feet], now[masts.heads] - now[masts.feet]
    sizes = np.linalg.norm(first, axis=1) * np.linalg.norm(last, axis=1)
    return bool((np.sum(first * last, axis=1) < np.cos(np.radians(MAX_TURN)) * sizes).any())


def _released(form: Form, masts: _Masts, held: Support) -> Form:
    """Release the heads of a form: masts take the thrust, and stays what is left across them.

    Raises:
        ValueError: A mast would be in tension; no forces of masts and stays balance, or others than those given.
    """
    made = form.structure
    bars, cells = _bars(made, masts)
    free = np.zeros(form.points.shape, dtype=bool)
    borne = [head for foot, head in zip(masts.feet, masts.heads, strict=True) if _is_borne(bars, foot, head)]
    free[borne] = True
    frame = BarFrame(bars, form.points, free)
    now = np.concatenate([form.forces[name][numbers] for name, numbers in cells.items()])
    carried = form.reactions + frame.pulls(now)
    balanced = frame.balance(np.where(free, carried, 0.0))
    if unmet := frame.unmet(balanced, WANTED_FORCE_ERROR):
        raise ValueError(unmet)
    forces, parts = dict(form.forces), dict(made.parts)
    bounds = np.cumsum([len(numbers) for numbers in cells.values()])[:-1]
    for (name, numbers), each in zip(cells.items(), np.split(balanced, bounds), strict=True):
        forces[name] = forces[name].copy()
        forces[name][numbers] = each
        parts[name] = replace(parts[name], prestress=forces[name])
    supports = [each for each in made.supports if each != held]
    kept = np.setdiff1d(masts.heads, borne)
    return replace(
        form,
        forces=forces,
        reactions=np.where(free, 0.0, carried - frame.pulls(balanced)),
        made=replace(made, parts=parts, supports=[*supports, *([Support(kept)] if len(kept) else [])]),
    )


def _bars(structure: Structure, masts: _Masts) -> tuple[dict[str, Bar], dict[str, NDArray[np.intp]]]:
    """Masts without a given force, and stays between heads and held nodes, by part, with the numbers of their cells."""
    fixed = structure.supported.all(axis=1)
    bars: dict[str, Bar] = {}
    cells: dict[str, NDArray[np.intp]] = {}
    pairs = {frozenset(pair) for pair in zip(masts.feet.tolist(), masts.heads.tolist(), strict=True)}
    for name, part in structure.parts_of(Bar).items():
        at_head = np.isin(part.cells, masts.heads).any(axis=1) & fixed[part.cells].all(axis=1)
        own = np.array([frozenset(pair) in pairs for pair in part.cells.tolist()], dtype=bool)
        force = part.prestress_tensors().ravel()
        numbers = np.flatnonzero(own if part.is_strut else at_head & (force > 0))
        if len(numbers):
            cells[name] = numbers
            wanted = np.zeros(len(numbers)) if part.is_strut else force[numbers]
            bars[name] = replace(part, cells=part.cells[numbers], prestress=wanted)
    return bars, cells


def _is_borne(bars: dict[str, Bar], foot: int, head: int) -> bool:
    """Return True if a mast stands between two nodes."""
    ends = sorted((foot, head))
    return any(part.is_strut and (np.sort(part.cells, axis=1) == ends).all(axis=1).any() for part in bars.values())
