"""Balance of the design of a pattern: the stress that it takes on its own, before it is cut."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from ..analysis.convergence_error import ConvergenceError
from ..analysis.stages import Analysis
from ..geometry.sizes import measures
from ..model.stages import Stage
from ..solvers.base import Solver
from .strips import Strips


def design_error(strips: Strips, stage: Stage, solver: Solver, comm: MPI.Intracomm, progress: bool) -> float:
    """Mean stress error of the strips before they are flattened, in equilibrium; infinite if they find none [-].

    The cells of a design in balance keep their prestress. What they lose or gain is in the stress error of every
    pattern, however narrow its strips are; collective.
    """
    structure = strips.structure
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the proof itself has told
        try:
            state = Analysis(structure, solver, comm, progress=progress).run([replace(stage, name="design")])["design"]
        except ConvergenceError:
            return np.inf
    errors, areas = [], []
    for name in strips.names:
        part = strips.membrane(name)
        area = measures(structure.points, part.cells)
        wanted = np.diagonal(part.prestress_tensors(), axis1=1, axis2=2)
        scale = np.abs(np.average(wanted, axis=0, weights=area)).mean()
        errors.append(np.abs(state.membrane(name).warp_weft_stress - wanted).max(axis=1) / scale)
        areas.append(area)
    return float(np.average(np.concatenate(errors), weights=np.concatenate(areas)))
