"""Refusal of stages that a structure cannot go through, before anything is computed."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.load_cases import prescribed
from ..model.energy_terms import is_term
from ..model.restraint import check_supports
from ..model.stages import Stage, check_stages
from ..model.structure import Structure


def check_run(structure: Structure, stages: Sequence[Stage]) -> None:
    """Refuse stages that do not fit together, or leave the structure free to move as a rigid body.

    Raises:
        ValueError: As of `check_stages` and `check_supports`.
    """
    check_stages(structure, stages)
    held: dict[str | None, NDArray[np.bool_]] = {None: structure.supported}
    terms: dict[str | None, list[Any]] = {None: []}
    for stage in stages:
        held[stage.name] = held[stage.after] | prescribed(stage, structure)[0]
        terms[stage.name] = [*terms[stage.after], *filter(is_term, stage.loads)]
        check_supports(structure, held[stage.name], terms[stage.name])
