"""Results of a run, from its folder or its archive."""

from pathlib import Path

from ..results.states import StageResults
from .archive import load_results

RESULTS = "results.fxm"  # archive in the folder of a run
CHECKPOINT = "checkpoint.sqlite"  # its increments, from the first on


def results_of(place: Path) -> StageResults:
    """Open the results of a run.

    Args:
        place: The folder of the run, or the archive in it.

    Raises:
        ValueError: There are none, or they are a form without stages.
    """
    file = place / RESULTS if place.is_dir() else place
    if file != place and not file.exists():
        there = sorted(entry.name for entry in place.glob("*.fxm"))
        hint = f"it has {', '.join(there)}" if there else "run a case first: fx-membrane run CASE"
        if (place / CHECKPOINT).exists():
            hint = "its run has not ended: `fx-membrane run CASE --resume` goes on, --overwrite begins anew"
        raise ValueError(f"The folder {place} has no {RESULTS}; {hint}.")
    found = load_results(file)
    if not isinstance(found, StageResults):
        raise ValueError(f"{file} holds a form, without stages; give {RESULTS} of a run, or its folder.")
    return found
