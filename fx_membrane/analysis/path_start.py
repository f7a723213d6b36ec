"""Starts of equilibrium paths: reference shapes without loads, or final states of stages."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..assembly.acting_ponds import pond_groups, water_of
from ..assembly.actions import Actions, pond_of, unloaded
from ..assembly.problem import Problem
from ..model.stages import Stage, check_stages
from ..model.structure import Structure
from ..results.owner import problem_of
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


def begun(start: Structure | StageResult, comm: MPI.Intracomm) -> tuple[Problem, Actions, NDArray[np.float64]]:
    """Problem, actions and displacement, shape (n, 3) [m], of a start; collective."""
    if isinstance(start, Structure):
        return Problem(start, comm), unloaded(start), np.zeros(start.points.shape)
    return problem_of(start, comm), start.actions, start.displacement


def refuse_first_water(stage: str, before: Actions, after: Actions) -> None:
    """Refuse the first water on a dry membrane: its forces have no derivative there; and new drains of known basins.

    Raises:
        ValueError: A volume or rain comes to cells without water; drains come to rain.
    """
    groups = pond_groups(before.ponds)
    wet = {id(entry.pond) for group in groups for entry in group}
    drained = {id(entry.pond): pond_of(group).drains for group in groups for entry in group}
    for group in pond_groups(after.ponds):
        if group[0].pond.level is None and not any(id(entry.pond) in wet for entry in group):
            raise ValueError(
                f"Stage {stage!r} brings the first water to {group[0].pond.part!r}, where a path has no direction; run "
                "a stage with a little of it by an `Analysis`, and start the path of the rest from its result."
            )
        known = drained.get(id(group[0].pond), ())
        more = np.setdiff1d(np.asarray(pond_of(group).drains), np.asarray(known))
        if water_of(group) and len(more):
            raise ValueError(
                f"Stage {stage!r} brings the drain at node {more[0]} to rain on {group[0].pond.part!r}, but a path "
                "keeps the basins of its start; run the stage by an `Analysis`."
            )
