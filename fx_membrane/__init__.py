"""Nonlinear statics of prestressed tension structures: fabric membranes, cables and masts.

The public names are listed in `__init__.pyi`; each is loaded on first use. Import changes one thing in the process: it
sets the environment variable OMP_NUM_THREADS to 1 if it was not set. The first use of `plot` sets
VTK_DEFAULT_OPENGL_WINDOW to a window that VTK draws in memory, if DISPLAY is not set; see README.
"""

from __future__ import annotations

import importlib.metadata as _metadata
import os as _os

from .runtime import standard_streams as _standard_streams  # noqa: F401  (before any other file is opened)

# isort: split
import lazy_loader as _lazy

from .checks.former_names import telling as _telling

# One thread for each process: with more, MUMPS can be ten times slower on busy cores. Set before PETSc is loaded.
_os.environ.setdefault("OMP_NUM_THREADS", "1")

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)
__getattr__ = _telling(__getattr__)


def _version() -> str:
    try:
        return _metadata.version("fx-membrane")
    except _metadata.PackageNotFoundError:  # sources without installation
        return "unknown"


__version__ = _version()
