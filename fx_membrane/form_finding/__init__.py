"""Shapes in equilibrium, by force densities, by stress in projection and by prescribed stress."""

from __future__ import annotations

from ..runtime import petsc as _petsc  # noqa: F401  (before any module imports PETSc)
