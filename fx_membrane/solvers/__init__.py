"""From a problem and a start to a solution: Newton's method, first-order methods, eigenvalues, diagnosis."""

from __future__ import annotations

from ..runtime import petsc as _petsc  # noqa: F401  (before any module imports PETSc)
