"""Stress in the reference shape under actions: the prestress times its factor, and that of the natural shape."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..assembly.actions import Actions, unloaded
from ..model import laws
from ..model.natural_shape import inverse_less_identity, strain
from ..model.structure import Structure

Array = NDArray[np.float64]


def built_stress(structure: Structure) -> dict[str, Array]:
    """Stress of each part as built, before any action, without wrinkling, each (cells, d, d) [N/m or N]."""
    built = unloaded(structure)
    return {name: reference_stress(structure, name, built) for name in structure.parts}


def prestress(structure: Structure, name: str, actions: Actions) -> Array:
    """Prestress of a part times the factors of actions, shape (cells, d, d) [N/m or N]."""
    tensors = structure.parts[name].prestress_tensors()
    return tensors * actions.prestress[name][:, None, None] if name in actions.prestress else tensors


def reference_stress(structure: Structure, name: str, actions: Actions) -> Array:
    """Stress of a part before it is displaced, without wrinkling, shape (cells, d, d) [N/m or N].

    Exact for laws that are linear in the strain; of others the natural strain counts to first order.
    """
    stress = prestress(structure, name, actions)
    part = structure.parts[name]
    if name not in actions.natural or part.shares_tension:  # the first shape of a rope is a guess
        return stress
    part, H = structure.parts[name], inverse_less_identity(actions.natural[name])
    elastic = np.einsum("ijkl,nkl->nij", laws.elasticity(part.material, part.dimension), strain(H))
    B = np.eye(part.dimension) + H
    return np.asarray(B @ (stress + elastic) @ B.transpose(0, 2, 1) / np.linalg.det(B)[:, None, None])
