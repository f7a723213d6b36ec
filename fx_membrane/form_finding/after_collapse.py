"""Form after a collapse: of the shapes on the way, the nearest one that is at rest.

Cells that collapse become slender, and their stress loses digits as the square of their aspect. The aspect does not
tell how far a shape moves by that. Over plans of tents and films between far rings, shapes of an aspect of 4e3 move by
1e-12. Others of 2e5 move by 1e-14 of their size. So the shape is analysed.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from ..assembly.problem import Problem
from ..model.loads import Load
from ..model.stages import Stage
from ..model.structure import Structure
from ..solvers.newton import Newton

# A tenth of the displacement, over the size, that a form may have when it is analysed: by rounding alone it scatters by
# a factor of 4 from one way to a shape to another.
STILL = 1e-13
MAX_SHAPES = 6  # nearest shapes looked at: no more than two of them were found to move


def last_good(structures: Sequence[Structure], loads: Sequence[Load], comm: MPI.Intracomm) -> int:
    """Return the number of the first structure that is at rest, or else of the one that moves least.

    Args:
        structures: Shapes with the stress found as prestress, the nearest to the wish first.
        loads: Loads on them.
        comm: The processes that share the work.
    """
    moves = list[float]()
    for number, structure in enumerate(structures[:MAX_SHAPES]):
        moves.append(_motion(structure, loads, comm))
        if moves[-1] <= STILL:
            return number
    return int(np.argmin(moves))


def _motion(structure: Structure, loads: Sequence[Load], comm: MPI.Intracomm) -> float:
    """Largest displacement of a structure under its loads, over its size [-]; infinite without equilibrium."""
    problem = Problem(structure, comm)
    x = problem.create_vector()
    loaded = problem.under(problem.actions_of(Stage("form", loads)))
    found = Newton().prepare(problem)(loaded, x, lambda number, entry: None, False)
    moved = float(np.linalg.norm(problem.to_numpy(x), axis=1).max())
    return moved / structure.size if found.converged else np.inf
