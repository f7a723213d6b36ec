"""Generated plans of tents, each with every method of form finding: found or refused, and how well.

    .venv/bin/python tests/benchmarks/form_finding_plans.py [first plan [last plan [file of the table]]]

A plan has 3 to 8 corners at heights of their own; edges that are held, or have cables along the curves that balance
the stress; one to three high points, which are held rings or high corners; and valley cables from rings to corners.
Prestress goes from 1 : 1 to 4 : 1. Every fourth plan has a flaw: edge cables with a quarter of that force, or a ring
far too high for a film.

For each method the table gives: found, unsettled (a form that is reported not to have what was asked for) or refused;
steps; processor time [s]; largest error of the stress; displacement of the form when it is analysed as handed over,
over its size; and the reason in words. These are defects, and the exit status is 1 then: more than a minute of
processor time; a form that moves by more than 1e-12 of its size, or is not the one asked for without a word; a flaw
that is found or has no word on it; a plan without a flaw that stress in projection does not find.

Rows of the table beside this script are added to a file, if one is given.
"""

import re
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import process_time
from typing import NamedTuple

import numpy as np
from tent_plans import Tent, tent  # type: ignore[import-not-found]

import fx_membrane
from fx_membrane import Analysis, Form, Stage, UnsettledFormWarning, projected_stress, updated_reference

PLANS, LIMIT, STILL = 40, 60, 1e-12
WORDS = {"weak edges": "dge cables? .*too weak", "high ring": "ring is too far"}  # regular expressions
REASONS = {  # of the table: the first that is found in the words
    "edges too weak": WORDS["weak edges"],
    "ring too far": WORDS["high ring"],
    "unequal stress": "times as large in one direction",
}


class Line(NamedTuple):
    """Line of the output for a method, its defect, empty without one, and its cell of the table."""

    text: str
    defect: str
    cell: str


@contextmanager
def limited(seconds: int) -> Iterator[None]:
    """Raise TimeoutError after some seconds of processor time, which other work on the machine does not change."""

    def stop(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def methods(case: Tent) -> Iterator[tuple[str, Callable[[], Form]]]:
    """Give the methods by name; those that need a shape in space start from that of stress in projection."""
    structure = case.structure
    yield "projection", partial(projected_stress, structure)
    yield "projection, forces", partial(projected_stress, structure, cables="force")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnsettledFormWarning)
        lifted = replace(structure, points=projected_stress(structure, max_iterations=1).points)
    yield "updated reference", partial(updated_reference, lifted)
    yield "natural densities", partial(fx_membrane.natural_force_density, lifted)
    yield "natural densities, 5", partial(fx_membrane.natural_force_density, lifted, iterations=5)
    if hasattr(fx_membrane, "prescribed_stress"):
        yield "prescribed stress", partial(fx_membrane.prescribed_stress, lifted)


def judged(case: Tent, method: str, find: Callable[[], Form]) -> Line:
    """Judge a method."""
    start, words = process_time(), ""
    try:
        with limited(LIMIT), warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            form = find()
            words = " ".join(str(entry.message) for entry in told if issubclass(entry.category, UnsettledFormWarning))
    except TimeoutError:
        return Line("", f"longer than {LIMIT} s", "none in time")
    except (RuntimeError, ValueError) as refusal:
        line = f"{'refused':>10}{'':6}{process_time() - start:8.2f}{'':18}  {refusal}"
        return Line(line, _unexpected(case, method, False, str(refusal)), f"refused{_reason(str(refusal))}")
    time = process_time() - start
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        moved = Analysis(form.structure, progress=False).run([Stage("form")])["form"].largest_displacement
    moved /= np.ptp(form.points, axis=0).max()
    error = form.steps[-1].stress_error if form.steps else np.nan  # no step came nearer
    verdict = "found" if form.converged else "unsettled"
    line = f"{verdict:>10}{len(form.steps):6}{time:8.2f}{error:9.1e}{moved:9.1e}  {words}"
    defect = _unexpected(case, method, form.converged, words)
    if moved > STILL:
        defect = "moves"
    elif not form.converged and not words and "natural" not in method:  # these say how far they are by their error
        defect = "not a word"
    return Line(line, defect, f"{verdict} {error:.0e}{'' if form.converged else _reason(words)}")


def _reason(words: str) -> str:
    """Reason that words give, in brackets."""
    return next((f" ({reason})" for reason, pattern in REASONS.items() if re.search(pattern, words)), "")


def _unexpected(case: Tent, method: str, found: bool, words: str) -> str:
    """Tell of a result that does not fit a plan; high rings are no flaw in projection, nor in few steps from there."""
    if case.flaw == "weak edges" and "natural" not in method and (found or not re.search(WORDS[case.flaw], words)):
        return "weak edges without a word"
    if case.flaw == "high ring" and method == "updated reference" and (found or not re.search(WORDS[case.flaw], words)):
        return "high ring without a word"
    if method == "updated reference" and not (case.flaw or found) and " 1:1" in case.words:
        return "a soap film exists"
    if method == "updated reference" and not found and "collapses" in words and "There is none where" in words:
        return "no definite reason"
    if method == "projection" and case.flaw != "weak edges" and not found:
        return "a form exists"
    return ""


def main() -> None:
    """Print the table."""
    first, last = [*map(int, sys.argv[1:3]), *[0, PLANS - 1][len(sys.argv) - 1 :]][:2]
    table = Path(sys.argv[3]) if len(sys.argv) > 3 else None
    defects = 0
    print(f"{'method':24}{'':>10}{'steps':>6}{'time':>8}{'stress':>9}{'moved':>9}")
    for number in range(first, last + 1):
        case = tent(number)
        count = len(case.structure.parts["film"].cells)
        print(f"{number}: {case.words}, {count} cells{', flaw: ' + case.flaw if case.flaw else ''}", flush=True)
        cells = [f"{number}: {case.words}", case.flaw]
        for name, find in methods(case):
            line = judged(case, name, find)
            defects += bool(line.defect)
            cells += [line.cell] if name != "natural densities" else []
            print(f"    {name:20}{line.text}{'  DEFECT: ' + line.defect if line.defect else ''}", flush=True)
        if table:
            with table.open("a") as file:
                file.write(f"| {' | '.join(cells)} |\n")
    sys.exit(f"{defects} defects" if defects else 0)


if __name__ == "__main__":
    main()
