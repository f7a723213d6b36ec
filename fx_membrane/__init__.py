"""Nonlinear statics of prestressed tension structures: fabric membranes, cables and masts."""

import os

# One thread for each process: with more, MUMPS can be ten times slower where cores are busy. Before PETSc is loaded.
os.environ.setdefault("OMP_NUM_THREADS", "1")

from mpi4py import MPI as _MPI  # noqa: F401  (before dolfinx: its wheel from PyPI needs the MPI library loaded)

from .analysis import Analysis, ConvergenceError
from .geometry import boundary, rectangle
from .loads import DeadLoad, PointLoad, PrescribedDisplacement, Stage
from .material import Fabric, OrthotropicFabric
from .solver import Newton
from .structure import Cable, Mast, Membrane, Structure, Support

__all__ = [
    "Analysis",
    "Cable",
    "ConvergenceError",
    "DeadLoad",
    "Fabric",
    "Mast",
    "Membrane",
    "Newton",
    "OrthotropicFabric",
    "PointLoad",
    "PrescribedDisplacement",
    "Stage",
    "Structure",
    "Support",
    "boundary",
    "rectangle",
]
