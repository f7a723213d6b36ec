"""Starts of equilibrium paths: a stage must come after its start."""

from dataclasses import replace

from ..model.stages import Stage, check_stages
from ..model.structure import Structure
from ..results.states import StageResult


def check_stage(structure: Structure, start: Structure | StageResult, stage: Stage) -> None:
    """Refuse a stage that does not come after its start."""
    name = None if isinstance(start, Structure) else start.name
    if stage.after != name:
        given = "a structure" if name is None else f"the final state of {name!r}"
        raise ValueError(
            f"Stage {stage.name!r} has after={stage.after!r}, but the path starts from {given}; "
            f"start from what the stage comes after, or give it after={name!r}."
        )
    check_stages(structure, [replace(stage, after=None)])
