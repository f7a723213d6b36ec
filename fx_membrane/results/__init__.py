"""States of a structure: their evaluation, remarks and warnings, tables."""

from __future__ import annotations

from ..runtime import petsc as _petsc  # noqa: F401  (before any module imports PETSc)
