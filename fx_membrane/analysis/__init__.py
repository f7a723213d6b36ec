"""Stages and load increments, checkpoints, small motions, paths by arc length."""

from __future__ import annotations

from ..runtime import petsc as _petsc  # noqa: F401  (before any module imports PETSc)
