"""Stages and load increments, checkpoints, small motions, paths by arc length."""

from ..runtime import petsc as _petsc  # noqa: F401  (before any module imports PETSc)
