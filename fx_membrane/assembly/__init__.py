"""From a structure to energy, residual and tangent: meshes, compiled forms, actions, the problem."""

from __future__ import annotations

from .. import _dolfinx  # noqa: F401  (before dolfinx: it keeps warnings and signals as they are)
