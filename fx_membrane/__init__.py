"""Nonlinear statics of prestressed tension structures: fabric membranes, cables and masts."""

import os

# One thread for each process: with more, MUMPS on busy cores can be ten times slower. To be set before PETSc loads.
os.environ.setdefault("OMP_NUM_THREADS", "1")

from mpi4py import MPI as _MPI  # noqa: E402, F401  (before dolfinx: its wheel from PyPI needs the MPI library loaded)

from .analysis import Analysis, ConvergenceError  # noqa: E402
from .geometry import boundary, rectangle  # noqa: E402
from .loads import DeadLoad, PointLoad, PrescribedDisplacement, Stage  # noqa: E402
from .material import Fabric, OrthotropicFabric  # noqa: E402
from .solver import Newton  # noqa: E402
from .structure import Cable, Mast, Membrane, Structure, Support  # noqa: E402

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
