"""Nonlinear statics of prestressed tension structures: fabric membranes, cables and masts.

The public names are listed in `__init__.pyi`; each is loaded on first use. Of the process that imports it, the package
changes one thing: the environment variable OMP_NUM_THREADS is 1 where it was not set.
"""

import importlib.metadata as _metadata
import os as _os

from .runtime import standard_streams as _standard_streams  # noqa: F401  (before any other file is opened)

# isort: split
import lazy_loader as _lazy

# One thread for each process: with more, MUMPS can be ten times slower where cores are busy. Before PETSc is loaded.
_os.environ.setdefault("OMP_NUM_THREADS", "1")

__getattr__, __dir__, __all__ = _lazy.attach_stub(__name__, __file__)


def _version() -> str:
    try:
        return _metadata.version("fx-membrane")
    except _metadata.PackageNotFoundError:  # sources that are not installed
        return "unknown"


__version__ = _version()
