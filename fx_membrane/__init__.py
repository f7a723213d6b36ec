"""Nonlinear statics of prestressed tension structures: fabric membranes, cables and masts."""

import contextlib as _contextlib
import os as _os
import signal as _signal

# One thread for each process: with more, MUMPS can be ten times slower where cores are busy. Before PETSc is loaded.
_os.environ.setdefault("OMP_NUM_THREADS", "1")

from .runtime import standard_streams as _standard_streams  # noqa: F401, I001  (before any other file is opened)
from mpi4py import MPI as _MPI  # noqa: F401  (before dolfinx: its wheel from PyPI needs the MPI library loaded)

from . import plot
from .analysis.stages import Analysis, ConvergenceError
from .analysis.arc_length import ContinuationError, trace
from .results.balance import UnbalancedStateWarning
from .analysis.checkpoint import CheckpointWarning
from .model.coincidence import CoincidentNodesWarning
from .geometry.edges import edges_on
from .analysis.equilibrium_path import EquilibriumPath, PathPoint
from .solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from .form_finding.force_density import Net, force_density
from .geometry.grids import polyline, rectangle
from .geometry.topology import boundary
from .files.gmsh import structure_from_gmsh
from .results.strain_limits import LargeStrainWarning
from .model.loads import DeadLoad, PlanLoad, PointLoad, PrescribedDisplacement, Pressure, Stage
from .model.materials import Fabric, OrthotropicFabric
from .analysis.modes import Modes, Stability, natural_frequencies, stability
from .solvers.newton import Newton
from .model.parts import Cable, Mast, Membrane
from .results.report import report
from .results.states import (
    BarResult,
    Equilibrium,
    Increment,
    LostPrestressWarning,
    MembraneResult,
    StageResult,
    StageResults,
    UnstableStateWarning,
)
from .solvers.base import Iteration
from .model.structure import SliverWarning, Structure, Support
from .form_finding.updated_reference import Form, UnsettledFormWarning, updated_reference
from .analysis.work import WorkLimit
from .analysis.wave_speed import MassUnitWarning

# PETSc takes a pipe that is closed at its other end, `script.py | head`, for a crash; to Python it is an exception.
with _contextlib.suppress(ValueError):  # not in the main thread
    _signal.signal(_signal.SIGPIPE, _signal.SIG_IGN)

__all__ = [
    "Analysis",
    "BarResult",
    "Cable",
    "CheckpointWarning",
    "CoincidentNodesWarning",
    "ConjugateGradient",
    "ContinuationError",
    "ConvergenceError",
    "DeadLoad",
    "Equilibrium",
    "EquilibriumPath",
    "Fabric",
    "Form",
    "Increment",
    "Iteration",
    "LargeStrainWarning",
    "LostPrestressWarning",
    "MassUnitWarning",
    "Mast",
    "Membrane",
    "MembraneResult",
    "Modes",
    "Net",
    "Newton",
    "OrthotropicFabric",
    "PathPoint",
    "PlanLoad",
    "PointLoad",
    "PrescribedDisplacement",
    "Pressure",
    "SliverWarning",
    "Stability",
    "Stage",
    "StageResult",
    "StageResults",
    "SteepestDescent",
    "Structure",
    "Support",
    "UnbalancedStateWarning",
    "UnsettledFormWarning",
    "UnstableStateWarning",
    "WorkLimit",
    "boundary",
    "edges_on",
    "force_density",
    "natural_frequencies",
    "plot",
    "polyline",
    "rectangle",
    "report",
    "stability",
    "structure_from_gmsh",
    "trace",
    "updated_reference",
]
