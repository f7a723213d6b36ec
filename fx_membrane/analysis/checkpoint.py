"""Checkpoints: saving the state of an analysis after each increment, and resuming it."""

from __future__ import annotations

import sqlite3
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

from mpi4py import MPI

from ..model.digests import fingerprints
from ..model.stages import Stage
from ..model.structure import Structure
from ..runtime.processes import together
from .checkpoint_file import CheckpointFile, Digests, Progress


class CheckpointWarning(UserWarning):
    """Failure to save a state: the run continues, and has the state in its results only."""


class Checkpoint:
    """Progress of a run, and the file in which the first process saves it.

    Attributes:
        progress: Progress of the stages begun, by name.
    """

    def __init__(self, comm: MPI.Intracomm, stages: Sequence[Stage], file: CheckpointFile | None):
        self._comm, self._file = comm, file
        self._digests = {stage.name: fingerprints(stage) for stage in stages} if file else {}
        self._unsaved: dict[str, Progress] = {}
        self.progress: dict[str, Progress] = {}

    def load(self, structure: Digests, stages: Sequence[Stage]) -> None:
        """Read the file.

        Raises:
            ValueError: It is not a checkpoint, or that of another structure or of other stages.
        """
        if self._file is None:
            return
        content = self._file.read()
        what = f"The checkpoint {self._file.path}"
        if content.progress:
            _refuse_if_changed(f"{what} is of another structure", content.structure, structure)
        for name in content.stages.keys() & self._digests.keys():
            _refuse_if_changed(f"{what} has another stage {name!r}", content.stages[name], self._digests[name])
        longest = {stage.name: Fraction(1, stage.increments) for stage in stages}
        self.progress = {
            name: replace(state, size=min(state.size, longest.get(name, state.size)))
            for name, state in content.progress.items()
        }

    def save(self, name: str, state: Progress) -> None:
        """Save the progress of a stage.

        Warns:
            CheckpointWarning: It could not be written; the next increment tries again.
        """
        with together(self._comm):
            if self._file is None:
                return
            first = not self._unsaved
            self._unsaved[name] = state
            try:
                self._file.write(self._unsaved, self._digests)
                self._unsaved = {}
            except sqlite3.Error as error:
                if first:
                    warnings.warn(
                        f"Stage {name!r}: its state could not be saved in {self._file.path} ({error}). The run goes "
                        "on and keeps it in memory, and the file keeps what it had; make room, and the next increment "
                        "saves both.",
                        CheckpointWarning,
                        stacklevel=5,
                    )


@contextmanager
def opened(
    path: str | Path | None, structure: Structure, stages: Sequence[Stage], comm: MPI.Intracomm
) -> Iterator[Checkpoint]:
    """Open the checkpoint of a run and lock its file against other runs; without a path, nothing is saved.

    A missing file is created. The path is that of the first process, which alone reads and writes.

    Raises:
        ValueError: The file cannot be written; another run has it open; it is not a checkpoint, or that of another
            structure or of other stages.
    """
    file = None
    try:
        with together(comm):
            if path is not None and comm.rank == 0:
                mine = fingerprints(structure)
                file = CheckpointFile(Path(path), mine)
            kept = Checkpoint(comm, stages, file)
            if file:
                kept.load(mine, stages)
        kept.progress = comm.bcast(kept.progress)
        yield kept
    finally:
        if file:
            file.close()


def _refuse_if_changed(what: str, stored: Digests, mine: Digests) -> None:
    changed = [name for name in {**stored, **mine} if stored.get(name) != mine.get(name)]
    if changed:
        more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
        raise ValueError(
            f"{what}, which differs in: {', '.join(changed[:3])}{more}; give another name or remove the file."
        )
