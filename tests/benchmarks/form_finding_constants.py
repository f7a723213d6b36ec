"""Ranges of the numeric constants of form finding: each is varied, and forms and words are compared.

    .venv/bin/python tests/benchmarks/form_finding_constants.py [part of a module [part of a name]]

A constant is divided and multiplied by 3 and by 10; numbers of steps are rounded up. For each value the table gives the
largest motion of a form over its size. It names the cases whose verdict, words or failure change. Digits in words do
not count. The comments beside the constants have their ranges from this table.
"""

import os
import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from form_finding_cases import GROUPS, Case  # type: ignore[import-not-found]

PACKAGE = "fx_membrane.form_finding."
FACTORS = (0.1, 10.0, 1 / 3, 3.0)
STILL = 1e-9  # motion that is none


class Answer(NamedTuple):
    """Answer of a case: points over their size, its words without digits, and the number of steps."""

    points: Any
    words: str
    steps: int


CONSTANTS = [
    (
        "masts.bar_balance",
        (
            "BALANCED_FORCE",
            "SHRUNK_LENGTH",
            "NUMBERS_OF_STEPS",
            "MAX_EVALUATIONS",
            "EPS",
            "FOLLOWED",
            "ZERO_COORDINATE",
        ),
        ("bars",),
    ),
    (
        "constraints.bodies",
        (
            "ACCEPTED_ERROR",
            "STAGNANT_ERROR",
            "REPEATS",
            "NEWTON_SLOPE",
            "MAX_DESCENT_STEPS",
            "START_DISTANCE",
            "UNSTABLE",
            "NEUTRAL_CURVATURE",
        ),
        ("bodies", "masts"),
    ),
    ("constraints.motions", ("ROUND_DISTANCE", "ZERO_EXTENT"), ("bodies",)),
    ("constraints.motions", ("ZERO_EXTENT", "AXIS"), ("slides",)),
    (
        "constraints.cable_targets",
        ("TARGET_ERROR", "TOLD_FORCE_ERROR", "MAX_FORCE_FACTOR", "FLOOR", "RANGE"),
        ("cables",),
    ),
    ("constraints.hand_over", ("BALANCED_FORCE",), ("bodies", "masts")),
    ("balance.constrained_balance", ("MAX_SOLVES", "MAX_DENSITY_FACTOR", "UNBOUNDED", "SETTLED_FORCE"), ("cables",)),
    ("nearest_stress.state", ("MIN_STRESS_SHARE",), ("wishes",)),
    ("nearest_stress.guide", ("SLIDES", "NEUTRAL", "DIFFERENCE_LENGTH"), ("bodies",)),
]


@contextmanager
def changed(module: str, name: str, value: Any) -> Iterator[None]:
    """Give a constant another value in its module and in those that import it."""
    first = getattr(import_module(PACKAGE + module), name)
    places = [
        each
        for key, each in list(sys.modules.items())
        if key.startswith(PACKAGE) and (key == PACKAGE + module or imports(each, module, name))
    ]
    for place in places:
        setattr(place, name, value)
    try:
        yield
    finally:
        for place in places:
            setattr(place, name, first)


def imports(place: Any, module: str, name: str) -> bool:
    """Tell if a module takes a constant from another."""
    source = Path(place.__file__).read_text() if getattr(place, "__file__", None) else ""
    return bool(re.search(rf"from [.\w]*\b{module.rpartition('.')[2]} import [^\n]*\b{name}\b", source))


def answer(case: Case) -> Answer:
    """Answer of a case."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        try:
            form = case()
        except (RuntimeError, ValueError, np.linalg.LinAlgError) as refusal:
            return Answer(None, f"{type(refusal).__name__} {without_digits(str(refusal))}", 0)
    if isinstance(form, np.ndarray):
        return Answer(form, "", 0)
    said = [str(each.message) for each in told] + list(form.remarks)
    return Answer(form.points, f"{form.converged} {without_digits(' '.join(said))}", len(form.steps))


def without_digits(words: str) -> str:
    """Words with each number as one sign."""
    return re.sub(r"-?\d[\d.]*(e[-+]?\d+)?", "#", words)


def compared(group: str, cases: dict[str, Case], before: dict[str, Answer]) -> tuple[float, list[str], int, float]:
    """Largest motion, names of changed cases, number of steps, and time [s]."""
    largest, other, steps, start = 0.0, list[str](), 0, process_time()
    for name, case in cases.items():
        found, first = answer(case), before[name]
        steps += found.steps
        if found.words != first.words:
            other.append(f"{group}: {name}")
        elif found.points is not None:
            largest = max(largest, float(np.abs(found.points - first.points).max() / np.ptp(first.points)))
    return largest, other, steps, process_time() - start


def varied(value: Any, factor: float) -> Any:
    """Multiply a constant by a factor; numbers are whole and at least one."""
    if isinstance(value, tuple):
        return tuple(max(1, round(factor * each)) for each in value)
    return max(1, int(np.ceil(factor * value))) if isinstance(value, int) else factor * value


def main() -> None:
    """Print the table."""
    of_module, of_name = [*sys.argv[1:3], "", ""][:2]
    made = {name: dict(group()) for name, group in GROUPS.items()}
    first: dict[str, dict[str, Answer]] = {}
    for module, names, groups in CONSTANTS:
        for name in names:
            if of_module not in module or of_name not in name:
                continue
            for group in groups:
                if group not in first:
                    start = process_time()
                    first[group] = {case: answer(find) for case, find in made[group].items()}
                    print(f"{group}: {len(made[group])} cases, {process_time() - start:.1f} s", flush=True)
            value, moved = getattr(import_module(PACKAGE + module), name), dict[int, bool]()
            for factor in FACTORS:
                if abs(np.log(factor)) < 2 and not moved[int(factor > 1)]:
                    continue  # the farther value changes nothing
                other, words = varied(value, factor), f"x {factor:.3g}"
                with changed(module, name, other):
                    results = [compared(group, made[group], first[group]) for group in groups]
                motion, steps = max(each[0] for each in results), sum(each[2] for each in results)
                moved[int(factor > 1)] = motion > STILL or any(each[1] for each in results)
                cases = [case for each in results for case in each[1]]
                line = f"{module}.{name} {value} {words}: moves {motion:.0e}, {steps} steps"
                print(f"{line}{', other words: ' + '; '.join(cases) if cases else ''}", flush=True)


if __name__ == "__main__":
    main()
