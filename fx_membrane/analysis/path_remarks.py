"""Warnings on points of a path that must be seen before its numbers: slack parts carry them."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import NamedTuple

from ..assembly.actions import between
from ..assembly.problem import Problem
from ..results.evaluation import StateEvaluator
from ..results.load_increments import Increment
from ..results.remarks import remarked
from ..results.told_states import UnstableStateWarning
from ..runtime.processes import together
from ..solvers.curvature import wrinkling_threshold
from ..solvers.progress import Pulse
from .path import EquilibriumPath


class _Carried(NamedTuple):
    """A point that slack parts carry: its number, and the remark on it."""

    number: int
    remark: str


def warn_of_slack_parts(problem: Problem, path: EquilibriumPath, pulse: Pulse, stacklevel: int) -> None:
    """Warns once, on every process, of the points of a path that slack or wrinkled parts carry; names the parts."""
    if not wrinkling_threshold(problem.structure):
        return  # nothing can be slack
    carried = list(_carried(problem, path, pulse))
    if not carried:
        return
    first = path.points[carried[0].number]
    with together(problem.comm):
        warnings.warn(
            f"The path of stage {path.name!r} has {len(carried)} of {len(path.points)} points that the structure does "
            f"not bear, the first at load factor {first.load_factor:.6g} (point {carried[0].number}). There "
            f"{carried[0].remark}",
            UnstableStateWarning,
            stacklevel=stacklevel + 1,
        )


def _carried(problem: Problem, path: EquilibriumPath, pulse: Pulse) -> Iterator[_Carried]:
    record = StateEvaluator(problem)
    for number, point in enumerate(path.points):
        pulse(f"looking for slack parts at point {number} of {len(path.points)}")
        loaded = problem.under(between(path.start, path.end, point.load_factor))
        loaded = loaded.without_compression_stiffness(point.compression_stiffness)
        x = problem.discretization.to_petsc(point.displacement)
        state = record(path.name, loaded, x, (Increment(point.load_factor, point.iterations),))
        for remark in remarked(state, None).remarks:
            if getattr(remark, "category", None) is UnstableStateWarning:
                yield _Carried(number, remark)
                break
