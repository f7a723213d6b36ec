"""Nonlinear statics of prestressed tension structures: fabric membranes, cables and masts."""

import contextlib as _contextlib
import os as _os
import signal as _signal

# One thread for each process: with more, MUMPS can be ten times slower where cores are busy. Before PETSc is loaded.
_os.environ.setdefault("OMP_NUM_THREADS", "1")

from . import standard_streams as _standard_streams  # noqa: F401, I001  (before any other file is opened)
from mpi4py import MPI as _MPI  # noqa: F401  (before dolfinx: its wheel from PyPI needs the MPI library loaded)

from . import plot
from .analysis import Analysis, ConvergenceError
from .arc_length import ContinuationError, trace
from .balance import UnbalancedStateWarning
from .checkpoint import CheckpointWarning
from .coincidence import CoincidentNodesWarning
from .edges import edges_on
from .equilibrium_path import EquilibriumPath, PathPoint
from .first_order import ConjugateGradient, SteepestDescent
from .form_finding import Net, force_density
from .geometry import boundary, polyline, rectangle
from .gmsh import structure_from_gmsh
from .large_strain import LargeStrainWarning
from .loads import DeadLoad, PlanLoad, PointLoad, PrescribedDisplacement, Pressure, Stage
from .material import Fabric, OrthotropicFabric
from .modes import Modes, Stability, natural_frequencies, stability
from .newton import Newton
from .parts import Cable, Mast, Membrane
from .report import report
from .results import (
    BarResult,
    Equilibrium,
    Increment,
    LostPrestressWarning,
    MembraneResult,
    StageResult,
    StageResults,
    UnstableStateWarning,
)
from .solver import Iteration
from .structure import SliverWarning, Structure, Support
from .updated_reference import Form, UnsettledFormWarning, updated_reference
from .work import WorkLimit
from .wave_speed import MassUnitWarning

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
