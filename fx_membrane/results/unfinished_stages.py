"""Stages that a run did not bring to equilibrium, as checks that fail."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from .check import Check, Verdict

if TYPE_CHECKING:
    from .states import StageResult, StageResults


class Failure(NamedTuple):
    """End of a run before its last stage was complete.

    Attributes:
        stage: Name of the stage that failed.
        factor: Load factor at which no equilibrium was found; that of the last one found where the run was stopped.
        last: Load factor of the last equilibrium found.
        reason: Sentences on the reason and the remedy.
    """

    stage: str
    factor: float
    last: float
    reason: str

    @property
    def message(self) -> str:
        """Message of the error that ends the run."""
        return (
            f"Stage {self.stage!r} found no equilibrium at load factor {self.factor:.6g} "
            f"(the last found is at {self.last:.6g}): {self.reason}"
        )


def last_found(failure: Failure, last: StageResult, results: StageResults) -> StageResult | None:
    """Name the last state of the stage that failed by its load factor; None where it is that of a stage before."""
    if failure.last > 0:
        return replace(last, name=f"{failure.stage}, up to load factor {failure.last:.6g}")
    return None if results else replace(last, name=f"{failure.stage}, at its start")


def unfinished(results: StageResults) -> list[Check]:
    """Make checks of the stage that failed and of those not computed; none for a complete run."""
    failure = results.failure
    if failure is None:
        return []
    words = f"{failure.stage}: no equilibrium at load factor {failure.factor:.6g}, last found at {failure.last:.6g}"
    if failure.factor == failure.last:
        words = f"{failure.stage}: stopped at load factor {failure.last:.6g}"
    left = [stage.name for stage in results.stages if stage.name not in results and stage.name != failure.stage]
    return [
        Check(words, "", "", Verdict.FAIL, failure.reason),
        *(Check(f"{name}: not computed", "", "", Verdict.FAIL) for name in left),
    ]
