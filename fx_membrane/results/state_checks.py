"""Checks of a state, each with its number, its limit and a verdict: a table to read before any other number."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..geometry.extremes import first_largest
from ..geometry.sizes import measures
from ..model.restraint import loose_ends
from ..solvers.outcome import Outcome
from .balance import SMALLER, UNBALANCED, UnbalancedStateWarning
from .check import Check, Verdict
from .crushed_gas import gas_checks
from .drains import drain_checks
from .limits import Limits, limit_checks
from .places import cell_place, node_place
from .screen_lines import wrapped
from .states import StageResult
from .strain_limits import LargeStrainWarning, largest_strain
from .told_states import UnstableStateWarning

BALANCE_TOLERANCE = 1e-8  # relative difference of sums of forces and moments
NAMES = 42  # columns of names, beside which numbers and limits have room
WRINKLED = 0.05  # share of the area of a membrane that may wrinkle or go slack without a word


def checks(result: StageResult, limits: Limits = Limits(), length: str = "") -> list[Check]:
    """Make the checks of a state: balance, convergence, stability, strains, slack parts, masts, loose ends, limits.

    Args:
        result: The state.
        limits: Limits of the design.
        length: Name of the unit of length.
    """
    return [
        *_balance(result),
        *_convergence(result),
        _stable(result),
        *_strain(result),
        *_slack(result),
        *_masts(result),
        *gas_checks(result, length),
        *_ends(result),
        *drain_checks(result, length),
        *limit_checks(result, limits, length),
    ]


def table(found: list[Check]) -> str:
    """Lines of checks, to print, limits of the design last; place and remedy follow in lines of their own."""
    width = min(max(len(check.name) for check in found), NAMES) + 2
    computed, designed = split(found)
    lines = [_line(check, width) for check in computed]
    if any(check.found for check in found):
        lines.insert(0, f"        {'check':{width}}{'found':>14}  limit")
    if designed:
        lines += ["  limits of the design:", *(_line(check, width) for check in designed)]
    return "\n".join(lines)


def split(found: list[Check]) -> tuple[list[Check], list[Check]]:
    """Split checks into those of the computation and limits of the design."""
    return [check for check in found if not check.design], [check for check in found if check.design]


def _line(check: Check, width: int) -> str:
    """Line of a check; a long name has lines of its own before the numbers."""
    numbers = f"{check.found:>14}  {check.limit}".rstrip()
    if not numbers:
        line = wrapped(f"{check.verdict.value}  {check.name}", 2, 8)
    elif len(check.name) + 2 <= width:
        line = f"  {check.verdict.value}  {check.name:{width}}{numbers}"
    else:
        line = wrapped(f"{check.verdict.value}  {check.name}", 2, 8) + f"\n{'':{8 + width}}{numbers}"
    return f"{line}\n{wrapped(check.advice, 8)}" if check.advice else line


def _judged(name: str, number: float, limit: float, remedy: str) -> Check:
    good = number <= limit
    return Check(name, f"{number:.1e}", f"{limit:.0e}", Verdict.PASS if good else Verdict.WARN, "" if good else remedy)


def _noted(name: str, found: str, limit: str, remedy: str, place: str = "") -> Check:
    """Check that warns if there is a remedy."""
    return Check(name, found, limit, Verdict.WARN if remedy else Verdict.PASS, remedy, place if remedy else "")


def _balance(result: StageResult) -> Iterator[Check]:
    balance, tiny = result.equilibrium, np.finfo(float).tiny
    forces = max(np.abs(result.reactions).sum(), np.abs(result.loads).sum(), tiny)
    reach = max(np.ptp(result.position, axis=0).max(), np.abs(result.position).max(), tiny)
    remedy = f"{SMALLER}; check units and parts far stiffer than others."
    difference = float(np.abs(balance.loads + balance.reactions).max() / forces)
    yield _judged("loads and reactions balance", difference, BALANCE_TOLERANCE, remedy)
    moment = float(np.abs(balance.load_moment + balance.reaction_moment).max() / (forces * reach))
    yield _judged("their moments balance", moment, BALANCE_TOLERANCE, remedy)
    largest = max(np.abs(result.loads).max(), np.abs(result.reactions).max(), tiny)
    told = any(remark.category is UnbalancedStateWarning for remark in result.remarks)
    found, limit = f"{balance.residual / largest:.1e}", f"{UNBALANCED:.0e}"
    place = node_place(result.structure, first_largest(balance.unbalanced))
    yield _noted("unbalanced nodal force / largest", found, limit, remedy if told else "", place)


def _convergence(result: StageResult) -> Iterator[Check]:
    count = len(result.increments)
    good = sum(increment.outcome.converged for increment in result.increments)
    verdict = Verdict.PASS if good == count else Verdict.FAIL
    remedy = "" if good == count else "Do not use this state: give smaller increments, or more iterations."
    yield Check("increments in equilibrium", f"{good} of {count}", f"{count}", verdict, remedy)
    snapped = [entry.load_factor for entry in result.increments if entry.outcome in (Outcome.SNAPPED, Outcome.FALLEN)]
    if snapped:
        remedy = f"It snapped before load factor {snapped[0]:.4g}; stay below, or add supports or prestress."
        yield _noted("increments that snapped", str(len(snapped)), "0", remedy)


def _stable(result: StageResult) -> Check:
    sentences = [str(remark) for remark in result.remarks if remark.category is UnstableStateWarning]
    if not sentences:
        return Check("stable", "yes", "", Verdict.PASS)
    words = f"No stable state, or held by slack parts: {sentences[0]}"
    return Check("stable", "no", "", Verdict.WARN, words)


def _strain(result: StageResult) -> Iterator[Check]:
    """Largest strain beside the limit of its law; none where the laws have no limit."""
    largest = largest_strain(result)
    if largest:
        sentences = [str(remark) for remark in result.remarks if remark.category is LargeStrainWarning]
        place = f"{largest.part!r}, {cell_place(result.structure, largest.part, largest.cell)}"
        found, limit = f"{100 * largest.strain + 0.0:.2g} %", f"{100 * largest.limit:g} %"
        yield _noted("largest strain", found, limit, sentences[0] if sentences else "", place)


def _slack(result: StageResult) -> Iterator[Check]:
    for name, found in result.parts.items():
        part = result.structure.parts[name]
        if part.carries_compression:
            continue
        if name in result.membranes:
            area = measures(result.structure.points, part.cells)
            share = float(area[~found.taut].sum() / area.sum())
            place = cell_place(result.structure, name, first_largest(np.where(found.taut, 0.0, area)))
            remedy = "Raise the prestress; tables and scenes tell the state of each cell." if share > WRINKLED else ""
            shown, limit = f"{100 * share:.3g} %", f"{100 * WRINKLED:g} %"
            yield _noted(f"wrinkled or slack area of {name!r}", shown, limit, remedy, place)
        else:
            count = int(found.slack.sum())
            place = cell_place(result.structure, name, int(found.slack.argmax()))
            remedy = "Raise the prestress if they are to carry." if count else ""
            yield _noted(f"slack cables of {name!r}", f"{count} of {len(found.slack)}", "0", remedy, place)


def _masts(result: StageResult) -> Iterator[Check]:
    for name, part in result.structure.parts.items():
        if part.is_strut:
            force = result.bars[name].force
            count = int((force > 0).sum())
            remedy = _tension_remedy(part.cells) if count else ""
            place = cell_place(result.structure, name, int(force.argmax()))
            yield _noted(f"masts in tension of {name!r}", str(count), "0", remedy, place)


def _tension_remedy(cells: NDArray[np.int64]) -> str:
    """Advice on masts in tension; those of a ring meet at all their nodes, and none has a foot."""
    if np.unique(cells, return_counts=True)[1].min() > 1:
        return "It is in tension, as in a ring that fabric pulls outwards; its joints must carry that."
    return "It is in tension: anchor its foot, if it stands on one."


def _ends(result: StageResult) -> Iterator[Check]:
    for name in result.structure.bars:
        ends = loose_ends(result.structure, name, result.actions.held)
        if ends:
            remedy = f"Cell {ends[0][0]} has a free end there; connect or support it."
            place = node_place(result.structure, ends[0][1])
            yield _noted(f"loose ends of {name!r}", str(len(ends)), "0", remedy, place)
