"""Owner of a result: the problem on whose meshes and forms it was computed, and on which later questions go on."""

from __future__ import annotations

from typing import Any

from mpi4py import MPI

from .. import _dolfinx
from ..assembly.problem import Problem
from ..model.structure import Structure


class Owned:
    """A result that keeps its problem.

    Attributes:
        structure: The structure.
        owner: The problem; None in a copy.
    """

    structure: Structure
    owner: Problem | None

    @property
    def problem(self) -> Problem:
        """Meshes and forms of the structure; in a copy they are made on first use, by all processes together."""
        return problem_of(self)

    def __getstate__(self) -> dict[str, Any]:
        """State for copies and files, without the owner: meshes and PETSc objects belong to this process."""
        return {name: value for name, value in vars(self).items() if name != "owner"}


def problem_of(result: Owned, comm: MPI.Intracomm | None = None) -> Problem:
    """Problem of a result; made, and kept in the result, if some process has none; collective.

    Args:
        result: The result; each process gives its own copy of the same one.
        comm: The processes that ask; None for those of the result, all if it has no problem.
    """
    kept = result.owner
    if comm is None:
        comm = MPI.COMM_WORLD if kept is None else kept.comm
    fits = kept is not None and kept.structure is result.structure and _same(kept.comm, comm)
    numbers = set(comm.allgather(kept.number if kept is not None and fits else None))
    if kept is not None and numbers == {kept.number}:
        _dolfinx.free_dropped(comm)
        return kept
    made = Problem(result.structure, comm)
    if kept is None or _same(kept.comm, comm):
        object.__setattr__(result, "owner", made)
    return made


def _same(one: MPI.Intracomm, other: MPI.Intracomm) -> bool:
    """Return True if two communicators have the same processes in the same order."""
    return MPI.Comm.Compare(one, other) in (MPI.IDENT, MPI.CONGRUENT)
