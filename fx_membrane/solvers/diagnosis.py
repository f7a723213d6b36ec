"""Diagnosis of a failed solve: sentences on its cause and remedy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from petsc4py import PETSc

from ..assembly.discretization import matrix_kind
from ..assembly.problem_under_actions import LoadedProblem
from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..geometry.sizes import measures
from ..model.parts import Mast
from ..model.structure import Structure
from ..runtime.processes import everywhere
from .base import max_norm
from .curvature import MODES, lowest_mode


@dataclass(frozen=True)
class DiagnosisLimits:
    """Limits of a diagnosis.

    Attributes:
        collapsed: Fraction of its size to which a cell has shrunk that has collapsed.
        moving: Fraction of the largest displacement in a motion, above which a node moves with it.
        swung: Angle by which a mast has swung far without loads [rad].
        swung_loaded: Angle by which a mast has swung far with loads [rad].
        named: Number of masts and parts that are named.
    """

    collapsed: float = 1e-6
    moving: float = 0.1
    swung: float = 0.1
    swung_loaded: float = 0.5
    named: int = 3


LIMITS = DiagnosisLimits()


def linear_failure(problem: LoadedProblem, A: PETSc.Mat) -> str:
    """Sentence on why the linear system could not be solved."""
    loose = loose_nodes(problem, A)
    if loose:
        node, direction = loose[0]
        also = f" (and {counted(len(loose) - 1, 'more node')})" if len(loose) > 1 else ""
        axis = ", ".join(f"{component + 0.0:.3g}" for component in direction)
        return (
            f"the tangent stiffness is singular: nothing holds node {node}{also} in the direction ({axis}). "
            + _why_loose(problem.structure, node)
        )
    less = "" if problem.unloaded() else ", or apply less load per increment"
    return (
        "the tangent stiffness is singular: parts of the structure can move without resistance (a mechanism, or the "
        f"point where it buckles). Add prestress, supports or members{less}."
    )


def _why_loose(structure: Structure, node: int) -> str:
    """Sentence on the parts without stiffness at a node, and on the remedy."""
    there = {name: part for name, part in structure.parts.items() if (part.cells == node).any()}
    here, cables = there.values(), [there[name] for name in there if name in structure.bars]
    if all(part.is_strut for part in here):
        return (
            "A joint between masts in line, or of a frame without bracing, has no stiffness across; add masts or "
            "cables that brace it, or supports."
        )
    kinds = {
        "a flat membrane": len(cables) < len(there),
        "a straight cable": any(not part.is_strut and not part.shares_tension for part in cables),
        "a straight rope": any(part.shares_tension for part in here),
    }
    what = " or ".join(words for words, found in kinds.items() if found)
    slides = " A rope slides over its nodes: hold them along it." if kinds["a straight rope"] else ""
    return (
        f"{what[0].upper()}{what[1:]} without prestress has no stiffness across; give it a small prestress to begin "
        f"with (prescribed displacements can bring the rest), a curved shape, or supports.{slides}"
    )


class Mechanism(NamedTuple):
    """Motion without resistance.

    Attributes:
        motion: Displacements of the nodes, the largest of size one, shape (n, 3).
        words: Sentence on the nodes that move, their places and the remedy.
    """

    motion: NDArray[np.float64]
    words: str


def mechanism(problem: LoadedProblem, x: PETSc.Vec) -> Mechanism | None:
    """Free motion of a structure in a state; None if every motion meets resistance."""
    found = lowest_mode(problem, x, MODES.free)
    # Written so that NaN is not taken for a mechanism.
    if not abs(found.stiffness) < MODES.free:
        return None
    free = _mechanism(problem.discretization.to_numpy(found.motion))
    return free._replace(words=f"{free.words} Add supports, members or prestress that hold it.")


def mechanism_or_too_few(found: Mechanism, most: int, residual: float) -> str:
    """Sentences on a solve whose iterations ran out; a load may yet stiffen the free motion of its start.

    Args:
        found: The free motion.
        most: Maximum number of iterations.
        residual: The largest unbalanced force [N].
    """
    return (
        f"the iterations ran out (at most {most} are allowed) with a largest unbalanced force of {residual:.3g}; "
        "allow more iterations (Newton(max_iterations=...)), or give a small prestress to begin with. If neither "
        f"helps, {found.words}"
    )


def slack_mechanism(problem: LoadedProblem, x: PETSc.Vec) -> Mechanism | None:
    """Free motion of masts that only the compression stiffness of slack parts resists, or None."""
    structure = problem.structure
    masts = np.zeros(len(structure.points), dtype=bool)
    for mast in structure.parts_of(Mast).values():
        masts[mast.cells] = True
    if not masts.any() or not np.isfinite(x.norm()):
        return None
    # Slack fabric may be softer than a mast that falls: masts move alone, too.
    for moving in (np.ones_like(masts), masts):
        found = lowest_mode(problem.without_compression_stiffness(), x, MODES.free, moving)
        motion = problem.discretization.to_numpy(found.motion)
        # Fabric that is slack here and there is not the structure.
        if found.stiffness < MODES.free and masts[np.linalg.norm(motion, axis=1).argmax()]:
            return _slack_mechanism(structure, _mechanism(motion, " but for the small stiffness that slack parts keep"))
    return None


def _slack_mechanism(structure: Structure, found: Mechanism) -> Mechanism:
    """Describe a mechanism of masts: those that fall, and the parts that meet them."""
    moving = np.linalg.norm(found.motion, axis=1) > LIMITS.moving
    falling, beside = [], []
    for name, part in structure.parts.items():
        cells = np.flatnonzero(moving[part.cells].any(axis=1))
        if part.is_strut:
            falling += [f"mast {name!r} (cell {cell})" for cell in cells]
        elif len(cells):
            beside.append(repr(name))
    more = f" and {len(falling) - LIMITS.named} more" * (len(falling) > LIMITS.named)
    tension = f" by the tension of {' or '.join(beside[: LIMITS.named])}" if beside else ""
    words = (
        f"{found.words} Nothing holds {', '.join(falling[: LIMITS.named])}{more}{tension}: no load is safe. Add "
        "cables, masts or supports that hold it by tension, or prestress that balances."
    )
    return found._replace(words=words)


def _mechanism(motion: NDArray[np.float64], but: str = "") -> Mechanism:
    """Mechanism from a motion of any size, with its sentence."""
    sizes = np.linalg.norm(motion, axis=1)
    most = first_largest(sizes)
    motion /= sizes[most]
    direction = ", ".join(f"{component + 0.0:.3g}" for component in motion[most])
    also = int((sizes > LIMITS.moving * sizes[most]).sum()) - 1
    words = f"the structure is a mechanism{but}: node {most} moves freely in the direction ({direction})" + (
        f", and {counted(also, 'more node')} with it." if also else "."
    )
    return Mechanism(motion, words)


def collapsed(problem: LoadedProblem, x: PETSc.Vec) -> bool:
    """Return True if a cell has shrunk to nothing: stabilization collapses an unsupported structure."""
    structure = problem.structure
    shape = structure.points + problem.discretization.to_numpy(x)
    cells = [part.cells for part in structure.parts.values()]
    return any((measures(shape, c) < LIMITS.collapsed * measures(structure.points, c)).any() for c in cells)


def unlikely_units(problem: LoadedProblem, x: PETSc.Vec) -> str:
    """Sentence on loads that would strain the structure far too much, as with wrong units; else empty."""
    share = problem.load_norm(x) / (problem.magnitudes.stiffness * problem.structure.size)
    if not share > 1:
        return ""
    return (
        f" The loads are {share:.2g} times the force that doubles the structure's length: check that loads, stiffness "
        "and lengths are in the same system of units."
    )


def stagnation_message(
    problem: LoadedProblem, x: PETSc.Vec, iterations: int, residual: float, at_rounding: bool, solver: str = "Newton"
) -> str:
    """Sentence on why the iteration did not converge.

    Args:
        problem: The problem.
        x: The last iterate.
        iterations: Number of iterations.
        residual: The largest unbalanced force [N].
        at_rounding: True if the residual is small, but above the tolerance.
        solver: Name of the solver's settings.
    """
    if at_rounding:
        return (
            f"the unbalanced forces ({residual:.3g}) are small but do not fall below the tolerance. It may ask for "
            f"more digits than rounding leaves; allow a larger one ({solver}(rtol=...)) or more iterations "
            f"({solver}(max_iterations=...))."
        )
    size = problem.structure.size
    displacement = max_norm(x)
    swung = swung_masts(problem, x, LIMITS.swung if problem.unloaded() else LIMITS.swung_loaded, "tried")
    if problem.unloaded():
        advice = (
            "nothing is applied that could come in more increments: give a prestress that the shape can balance, "
            "as form finding does (force_density, updated_reference), or a load that slack parts hang by"
        )
    else:
        advice = "apply the loads in more increments, give more prestress, start from a shape nearer to balance"
    advice += f", or allow more iterations ({solver}(max_iterations=...))"
    if not displacement <= 10 * size:
        return (
            f"the iteration diverged: displacements of {displacement:.3g} in a structure of size {size:.3g}. "
            f"Check that loads, stiffness and lengths are in the same system of units; then {advice}."
        )
    after = f"after {counted(iterations, 'iteration')} the largest unbalanced force is still {residual:.3g}; {advice}."
    return f"{swung} A{after[1:]}" if swung else after


def first_order_advice(at_rounding: bool, steepest: bool, divided: bool) -> str:
    """Sentence on what may converge where a first-order method ran out of iterations.

    Args:
        at_rounding: True if the energy no longer changes but by rounding.
        steepest: True for steepest descent.
        divided: True with the tangent as preconditioner.
    """
    if at_rounding:
        return " The energy, which first-order methods go by, falls by rounding only; Newton() may get closer."
    perhaps = " or ".join(["ConjugateGradient()"] * steepest + ['preconditioner="tangent"'] * (not divided))
    return " First-order methods are slow; Newton() needs fewer iterations as a rule" + (
        f", and {perhaps} may." if perhaps else "."
    )


def swung_masts(problem: LoadedProblem, x: PETSc.Vec, limit: float, kind: str) -> str:
    """Name the mast that has turned most, in a sentence; empty if none has by more than a limit.

    Args:
        problem: The problem.
        x: A state.
        limit: The angle [rad].
        kind: How the state came about: "found" or "tried".
    """
    structure, moved = problem.structure, problem.discretization.to_numpy(x)
    found = []
    for name, part in structure.parts_of(Mast).items():
        before, after = (
            np.diff(shape[part.cells], axis=1)[:, 0] for shape in (structure.points, structure.points + moved)
        )
        turned = np.arctan2(np.linalg.norm(np.cross(before, after), axis=1), (before * after).sum(axis=1))
        cell = first_largest(turned)
        node = part.cells[cell, first_largest(np.linalg.norm(moved[part.cells[cell]], axis=1))]
        found.append((float(turned[cell]), name, cell, int(node)))
    angle, name, cell, node = max(found, default=(0.0, "", 0, 0))
    if not angle > limit:
        return ""
    return (
        f"mast {name!r} (cell {cell}, at node {node}) has turned by {np.degrees(angle):.3g} degrees in the last state "
        f"{kind}: it falls, or hangs; check that it has all its stays, and that what pulls at it is in balance."
    )


def loose_nodes(problem: LoadedProblem, A: PETSc.Mat) -> list[tuple[int, list[float]]]:
    """Nodes, in the user's numbering, without stiffness in some direction, and that direction."""
    discretization = problem.discretization
    first = A.getOwnershipRange()[0]
    A = A if matrix_kind(A) == "aij" else A.convert("aij", PETSc.Mat())
    pointers, columns, values = A.getValuesCSR()
    rows = np.repeat(np.arange(len(pointers) - 1), np.diff(pointers))
    same_node = (columns - first) // 3 == rows // 3
    blocks = np.zeros((len(discretization.owned_nodes), 3, 3))
    blocks[rows[same_node] // 3, rows[same_node] % 3, (columns[same_node] - first) % 3] = values[same_node]
    if not everywhere(discretization.comm, bool(np.isfinite(blocks).all())):
        return []  # all processes return together: eigh would fail on some only
    stiffness, directions = np.linalg.eigh(blocks)
    limit = 1e-13 * np.minimum(
        np.abs(blocks).max(axis=(1, 2)), problem.magnitudes.stiffness
    )  # neither another node nor a support
    weakest = np.argmin(np.abs(stiffness), axis=1)
    loose = np.flatnonzero(np.abs(stiffness).min(axis=1) <= limit)
    found = [(int(discretization.owned_nodes[i]), directions[i, :, weakest[i]].tolist()) for i in loose]
    return sorted(entry for part in discretization.comm.allgather(found) for entry in part)
