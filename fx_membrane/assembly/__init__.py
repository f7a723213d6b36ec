"""From a structure to energy, residual and tangent: meshes, compiled forms, actions, the problem."""

from __future__ import annotations

from ..runtime import petsc as _petsc  # noqa: F401  (before any module imports PETSc)
