"""Refusal of stages that a structure cannot go through, before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.load_cases import prescribed
from ..model.cable_changes import FixedLength
from ..model.energy_terms import is_term
from ..model.gas import GasVolume
from ..model.restraint import check_supports
from ..model.rope_nodes import refuse_loose_nodes
from ..model.stages import Stage, check_stages
from ..model.structure import Structure


def refuse_given_volumes(stages: Sequence[Stage], solver: str) -> None:
    """Refuse given volumes of chambers for a solver that only lowers an energy.

    Raises:
        ValueError: A stage has a `GasVolume`.
    """
    for stage in stages:
        if any(isinstance(change, GasVolume) for change in stage.changes):
            raise ValueError(
                f"Stage {stage.name!r} gives the volume of a chamber, and {solver} finds no pressure that holds it; "
                "take Newton()."
            )


def check_run(structure: Structure, stages: Sequence[Stage]) -> None:
    """Refuse stages that do not fit together, or leave the structure free to move as a rigid body.

    Raises:
        ValueError: As of `check_stages`, `check_supports` and `refuse_loose_nodes`; a `FixedLength` is in a stage that
            follows none.
    """
    check_stages(structure, stages)
    held: dict[str | None, NDArray[np.bool_]] = {None: structure.supported}
    terms: dict[str | None, list[Any]] = {None: []}
    for stage in stages:
        fixed = [change for change in stage.changes if isinstance(change, FixedLength)]
        if fixed and stage.after is None:
            raise ValueError(
                f"Stage {stage.name!r} has a FixedLength of {fixed[0].part!r}, and follows no stage; name the one at "
                "whose end the length is fixed, after=..."
            )
        held[stage.name] = held[stage.after] | prescribed(stage, structure)[0]
        terms[stage.name] = [*terms[stage.after], *filter(is_term, stage.loads)]
        check_supports(structure, held[stage.name], terms[stage.name])
    refuse_loose_nodes(structure, np.any([*held.values()], axis=0), stages)
