"""Results of a run, from its folder or its archive."""

from __future__ import annotations

from pathlib import Path

from ..results.states import StageResults
from ..runtime.messages import say
from .archive import load_results
from .patterns.proof_files import FOLDER
from .unfinished_run import unfinished_results

RESULTS = "results.fxm"  # archive in the folder of a run
FORM = "form.fxm"  # the form that it begins with
CHECKPOINT = "checkpoint.sqlite"  # its increments, from the first on


def results_of(place: Path) -> StageResults:
    """Open the results of a run; those of one that has not ended as far as it has got.

    Args:
        place: The folder of the run, or the archive in it.

    Raises:
        ValueError: There are none, or they are a form without stages.
    """
    file = place / RESULTS if place.is_dir() else place
    if not place.exists():
        raise ValueError(f"There is no folder and no archive {str(place)!r}; give the folder of a run.")
    if place.suffix == ".toml":
        raise ValueError(f"{place} is a case, not its results; give the folder of its run, {place.with_suffix('')}.")
    if file != place and not file.exists() and (kept := unfinished_results(place)):
        say(f"The run of {place} has not ended; these are the states that it has found.")
        return kept
    if file != place and not file.exists():
        hint = "run a case first: fx-membrane run CASE"
        if (place / FORM).exists():
            hint = "it has a form, without stages: `show` tells of it, and `fx-membrane run CASE --resume` goes on"
        if (place / FOLDER).is_dir():
            hint = f"it has a cutting pattern: `fx-membrane show {place / FOLDER}` tells of it"
        if (place / CHECKPOINT).exists():
            hint = "its run has not ended: `fx-membrane run CASE --resume` goes on, --overwrite begins anew"
        raise ValueError(f"The folder {place} has no {RESULTS}; {hint}.")
    found = load_results(file)
    if not isinstance(found, StageResults):
        remedy = f"`fx-membrane show` tells of it; give {RESULTS} of a run, or its folder"
        raise ValueError(f"{file} holds a form, without stages: {remedy}.")
    return found
