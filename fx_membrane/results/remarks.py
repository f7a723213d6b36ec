"""Remarks on a state that a user must see before its numbers: unstable, fallen, held by slack parts, strained too far.

All warnings on a state are issued from them. They follow from the result and the start of its stage. So they are the
same on every process, after a restart and wherever they are shown: in `report`, on the result itself.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..assembly.actions import unloaded
from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..model.cell_tensors import once
from ..model.parts import Cable, Mast
from ..model.structure import Structure
from ..solvers.outcome import Outcome
from .balance import UnbalancedStateWarning, balance_remarks
from .crushed_gas import gas_remarks
from .initial_stress import reference_stress
from .mast_freedom import Loose, loose_masts
from .motions import Motion, motion_of
from .principal import principal_values
from .shear_signs import ShearSignWarning, shear_remarks
from .slack_forces import Push, pushes
from .states import StageResult
from .strain_limits import LargeStrainWarning, strain_remarks
from .told_states import CrushedGasWarning, LostPrestressWarning, Remark

LEFT = 0.01  # share of its prestress, below which a part has lost it
SHOWN = 3  # load factors and parts that are named
TOLD_ONCE = (CrushedGasWarning, LargeStrainWarning, UnbalancedStateWarning, ShearSignWarning)  # by one process for all


def remarked(result: StageResult, start: NDArray[np.float64] | None, loaded: bool = True) -> StageResult:
    """Add the remarks to a result.

    Args:
        result: A state.
        start: Displacements at the start of its stage, shape (n, 3) [m]; None where motion is not to be judged.
        loaded: False if its loads are rounding; its balance is then not judged.
    """
    found = [*_remarks(result, start), *gas_remarks(result), *strain_remarks(result), *shear_remarks(result)]
    if loaded and result.increments:  # a start is no equilibrium that a solver has found
        found += balance_remarks(result)
    return replace(result, remarks=tuple(found))


def warn_of_remarks(result: StageResult, comm: MPI.Intracomm, stacklevel: int) -> None:
    """Warns of each remark; where one process is enough to tell it, the first does."""
    for remark in result.remarks:
        if comm.rank == 0 or remark.category not in TOLD_ONCE:
            warnings.warn(f"Stage {result.name!r}: {remark}", remark.category, stacklevel=stacklevel)


def held_by_slack_parts(result: StageResult) -> str:
    """Sentence on masts, or else a node, that slack parts alone hold; empty if there are none."""
    for push in pushes(result):
        return f"{_hanging(result.structure, push)}, held by slack parts alone ({_listed(list(push.compression))})"
    for loose in filter(lambda loose: loose.slack, loose_masts(result)):
        return f"{_standing(result.structure, [loose.node])}, held by slack parts alone ({_slack_at(result, loose)})"
    return ""


def _remarks(result: StageResult, start: NDArray[np.float64] | None) -> Iterator[Remark]:
    factors = [entry.load_factor for entry in result.increments if entry.outcome is Outcome.UNSTABLE]
    if factors:
        shown = ", ".join(f"{factor:.6g}" for factor in factors[:SHOWN]) + ", ..." * (len(factors) > SHOWN)
        yield Remark(
            f"the equilibrium found at load factor {shown} is not stable, and none that is was found from there; "
            "stability(state) shows how it gives way. Add supports, members or prestress against that."
        )
    motion = motion_of(result, start)
    told = [*_snapped(result, motion), *_carried(result)]
    if str(motion) and not any(increment.outcome.lost_stability for increment in result.increments):
        told.insert(0, Remark(_far(result, motion)))
    yield from told
    lost = [name for name in result.parts if _has_lost_its_prestress(result, name)]
    if lost:
        yield Remark(_loss(result, lost, stands=not (factors or told)), LostPrestressWarning)


def _far(result: StageResult, motion: Motion) -> str:
    reached = f"up to load factor {result.increments[-1].load_factor:.6g}" if result.increments else "in this state"
    far = f"{motion.moved}, more than half the size of what is connected with it" if motion.moved else ""
    return (
        f"{reached} {', and '.join(filter(None, (far, motion.tilted)))}: it has fallen, snapped, hung down or been "
        "stretched into quite another shape. If that is not meant, check units, stiffness, the stays of every mast, "
        "and whether something is slack or missing; `equilibrium_path` shows the way there."
    )


def _snapped(result: StageResult, motion: Motion) -> Iterator[Remark]:
    before = 0.0
    for increment in result.increments:
        if increment.outcome is Outcome.FALLEN:
            yield Remark(
                f"{increment.fallen}, falls{str(motion) and f': {motion}'}. It carries nothing but by the small "
                "stiffness that slack parts keep (compression_stiffness): no load is safe. Add cables, masts or "
                "supports that hold it."
            )
        elif increment.outcome is Outcome.SNAPPED:
            yield Remark(
                f"between load factors {before:.6g} and {increment.load_factor:.6g} the structure lost its stability: "
                f"it has snapped or buckled into another shape{motion.tilted and f' ({motion.tilted})'}. Stay below "
                "that load, or add supports, members or prestress, if that is not meant; `equilibrium_path` shows the "
                "limit point."
            )
        before = increment.load_factor


def _carried(result: StageResult) -> Iterator[Remark]:
    """Remarks on slack parts that carry, and on masts that only slack parts could hold."""
    found = pushes(result)
    for push in found:
        membranes = all(name in result.membranes for name in push.compression)
        largest = "principal stress of membranes" if membranes else "force of cables and masts"
        forces = " and ".join(
            f"{name!r} is compressed by {force:.3g} in cell {cell}"
            for name, (cell, force) in list(push.compression.items())[:SHOWN]
        )
        share = max(force for _, force in push.compression.values()) / max(push.largest, 1e-300)
        size = f"{100 * share:.2g} % of" if share < 1 else "no less than"
        masts = _standing(result.structure, push.nodes)
        hanging = masts or f"node {push.nodes[0]}"
        falls = "is not held, and falls or takes another shape" if masts or not membranes else "stays there by it alone"
        yield Remark(
            f"slack or wrinkled parts carry the structure: {forces}, {size} the largest {largest} there, by the share "
            f"of stiffness that is kept there (compression_stiffness). Fabric and cables carry no compression: "
            f"{hanging} {falls}. Add cables, masts or supports that hold it by tension, or prestress; if the part is "
            "meant to be slack there, a smaller compression_stiffness."
        )
    told = {int(node) for push in found for node in push.nodes}
    loose = [entry for entry in loose_masts(result) if entry.node not in told]
    if loose:
        first = loose[0]
        axis = ", ".join(f"{component:.3g}" for component in np.round(first.direction, 9) + 0.0)
        why = (
            f"all that could hold it there is slack ({_slack_at(result, first)})"
            if first.slack
            else "it moves without resistance (a mechanism), as where a mast and its guys lie in one plane"
        )
        same = [entry.node for entry in loose if entry.slack == first.slack]
        yield Remark(
            f"{_standing(result.structure, same)} is not held in the direction ({axis}): {why}. Add cables, masts or "
            "supports against that, or prestress."
        )


def _loss(result: StageResult, lost: Sequence[str], stands: bool) -> str:
    """Sentence on the parts that have lost their prestress, and on the motion of their nodes.

    Cables that are slack beside others which hold the structure are ordinary: they ask for no advice.
    """
    structure = result.structure
    nodes = np.unique(np.concatenate([structure.parts[name].cells.ravel() for name in lost]))
    motion = np.linalg.norm(result.displacement[nodes], axis=1)
    whole = all(name in lost for name in structure.parts if _given(result, name) > 0)
    farthest = nodes[first_largest(motion)]
    left = (
        f"no cell of {_listed(lost)} has more than {100 * LEFT:g} % of it left, and node {farthest} has "
        f"moved by {motion.max():.3g} from the reference shape."
    )
    cables = set(lost) <= set(structure.parts_of(Cable))
    if stands and cables and not whole:
        return (
            f"prestress is lost: {left} The rest holds the structure without these cables, which are slack under this "
            "load, as leeward guys may be."
        )
    masts = bool(structure.parts_of(Mast))
    return (
        f"{'all ' * whole}prestress is lost: {left} If that is not meant, check that "
        f"{'every mast has its stays, ' * masts}every edge has its supports, and shape and prestress belong together."
    )


def _has_lost_its_prestress(result: StageResult, name: str) -> bool:
    """Return True if a part that was given tension has almost none left."""
    given = _given(result, name)
    part = result.parts[name]
    return bool(given > 0 and (part.slack | (part.principal[:, 0] <= LEFT * given)).all())


def _given(result: StageResult, name: str) -> float:
    """Largest tension that a part was given in the reference shape, as built or by stages [N/m or N]; none of masts."""
    if result.structure.parts[name].is_strut:  # cooled or short, it still stands by compression
        return 0.0
    changed = result.actions
    built = replace(changed, natural=unloaded(result.structure).natural)  # before its natural shape was changed
    found = [reference_stress(result.structure, name, actions) for actions in (built, changed)]
    return max(float(principal_values(once(stress)).max()) for stress in found)


def _hanging(structure: Structure, push: Push) -> str:
    """Name the masts that slack parts hold, or else the node."""
    return _standing(structure, push.nodes) or f"node {push.nodes[0]}"


def _standing(structure: Structure, nodes: Sequence[int] | NDArray[np.int64]) -> str:
    """Name the masts at nodes: the first cell of each part, and the node."""
    said = []
    for name, part in structure.parts_of(Mast).items():
        ends = np.isin(part.cells, nodes)
        if ends.any():
            cell, end = np.argwhere(ends)[0]
            said.append(f"mast {name!r} (cell {cell}, at node {part.cells[cell, end]})")
    return " and ".join(said[:SHOWN])


def _slack_at(result: StageResult, loose: Loose) -> str:
    parts = result.structure.parts
    return _listed([name for name, part in result.parts.items() if (parts[name].cells[part.slack] == loose.node).any()])


def _listed(names: Sequence[str]) -> str:
    return ", ".join(map(repr, names[:SHOWN])) + f" and {counted(len(names) - SHOWN, 'more part')}" * (
        len(names) > SHOWN
    )
