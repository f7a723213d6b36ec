"""Rounding of nodal forces, node by node, so that a stiff part does not loosen the tolerance of others."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import measures
from ..model.natural_shape import inverse_less_identity, strain
from ..model.parts import Part
from ..model.structure import Structure
from .actions import Actions
from .forms_of_parts import stiffness

_Values = Mapping[str, NDArray[np.float64]]  # of the cells of each part, shape (cells,)

UNIT = 1e-15  # rounding of a cell's forces, relative to these forces
# Rounding of the places of nodes, over the gap between two numbers of their size: a form far from the origin is in
# equilibrium no better. Forces of stresses in balance come to 1.4 of it at most in 60 random sails.
PLACES = 4.0


class Scales(NamedTuple):
    """Sizes of the forces of all cells at each node, before they balance.

    Attributes:
        prestress: Prestress forces, shape (n,) [N].
        stiffness: Force per displacement of a node, shape (n,) [N/m].
        places: Change of the prestress forces by the rounding of the places of nodes, shape (n,) [N].
    """

    prestress: NDArray[np.float64]
    stiffness: NDArray[np.float64]
    places: NDArray[np.float64]

    def rounding(self, displacement: float) -> NDArray[np.float64]:
        """Force at each node at rounding, for the largest displacement [m], shape (n,) [N]."""
        return UNIT * (self.prestress + displacement * self.stiffness) + self.places


class Magnitudes(NamedTuple):
    """Typical forces and stiffnesses of a structure.

    Attributes:
        prestress_forces: 2-norm of the prestress forces of all cells, before they balance [N].
        stiffness: Typical stiffness, the median over the cells [N/m].
        scales: Sizes of the forces at the nodes of this process, in the order of a PETSc vector.
        elastic: False if the prestress is the only stress.
        changed: True if actions change the stress in the reference shape.
    """

    prestress_forces: float
    stiffness: float
    scales: Scales
    elastic: bool = True
    changed: bool = False

    def under(self, structure: Structure, owned_nodes: NDArray[np.int64], actions: Actions) -> Magnitudes:
        """Magnitudes with the stress that actions leave in the reference shape."""
        if not (self.changed or actions.changes_stress):
            return self
        return magnitudes(structure, self.elastic, owned_nodes, actions)


def magnitudes(
    structure: Structure, elastic: bool, owned_nodes: NDArray[np.int64], actions: Actions | None = None
) -> Magnitudes:
    """Typical forces and stiffnesses of a structure, of which this process owns some nodes.

    Args:
        structure: The structure.
        elastic: False if the prestress is the only stress.
        owned_nodes: The nodes of this process.
        actions: Actions whose natural shapes and prestress factors count; None for the prestress of the structure.
    """
    sizes, prestress = _sizes(structure), prestresses(structure, actions)
    owned = (values[owned_nodes] for values in _scales(structure, elastic, sizes, prestress))
    forces = [prestress[name] * _width(part, sizes[name]) for name, part in structure.parts.items()]
    stiffnesses = [stiffness(part) / _length(part, sizes[name]) for name, part in structure.parts.items()]
    return Magnitudes(
        prestress_forces=float(np.sqrt(sum(float(force @ force) for force in forces))),
        stiffness=float(np.median(np.concatenate(stiffnesses))),
        scales=Scales(*owned),
        elastic=elastic,
        changed=actions is not None and actions.changes_stress,
    )


def prestresses(structure: Structure, actions: Actions | None = None) -> dict[str, NDArray[np.float64]]:
    """Sizes of the stress in the reference shape of the cells of each part, shape (cells,) [N/m], of bars [N].

    That of natural shapes is an upper bound. Without actions it is that of the prestress alone.
    """
    found = {name: _sizes_of(part.prestress_tensors()) for name, part in structure.parts.items()}
    if actions is None:
        return found
    for name, factors in actions.prestress.items():
        found[name] = found[name] * factors
    for name, less in actions.natural.items():
        found[name] = found[name] + stiffness(structure.parts[name]) * _sizes_of(strain(inverse_less_identity(less)))
    return found


def scales(structure: Structure, elastic: bool, actions: Actions | None = None) -> Scales:
    """Sizes of the nodal forces of a structure; the stiffness is that of prestress alone where it is not elastic."""
    return _scales(structure, elastic, _sizes(structure), prestresses(structure, actions))


def _scales(structure: Structure, elastic: bool, sizes: _Values, prestress: _Values) -> Scales:
    n = len(structure.points)
    found = Scales(_meeting(structure, prestress, sizes), np.zeros(n), np.zeros(n))
    gaps = PLACES * np.spacing(np.abs(structure.points).max(axis=1))
    for name, part in structure.parts.items():
        length = _length(part, sizes[name])
        found.stiffness[:] += _at_nodes(structure, part, (prestress[name] + elastic * stiffness(part)) / length)
        found.places[:] += gaps * _at_nodes(structure, part, prestress[name] / length)
    return found


def _sizes_of(tensors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Norms of tensors (cells, d, d), shape (cells,)."""
    return np.sqrt(np.einsum("nij,nij->n", tensors, tensors))


def meeting(structure: Structure, stresses: _Values) -> NDArray[np.float64]:
    """Sum of the sizes of the forces that meet at each node, before they balance each other, shape (n,) [N].

    Args:
        structure: The structure.
        stresses: Sizes of the stresses of the cells of each part, shape (cells,) [N/m], of bars their forces [N].
    """
    return _meeting(structure, stresses, _sizes(structure))


def _meeting(structure: Structure, stresses: _Values, sizes: _Values) -> NDArray[np.float64]:
    found = np.zeros(len(structure.points))
    for name, part in structure.parts.items():
        found += _at_nodes(structure, part, stresses[name] * _width(part, sizes[name]))
    return found


def _sizes(structure: Structure) -> dict[str, NDArray[np.float64]]:
    """Areas or lengths of the cells of each part, shape (cells,) [m2 or m]."""
    return {name: measures(structure.points, part.cells) for name, part in structure.parts.items()}


def _at_nodes(structure: Structure, part: Part, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of the values of the cells that meet at each node, shape (n,), from values of shape (cells,)."""
    return np.asarray(sum(np.bincount(corner, values, len(structure.points)) for corner in part.cells.T))


def _width(part: Part, size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Width on which the stress of a cell acts [m]; one for bars, whose stress is a force."""
    return size ** (1 - 1 / part.dimension)


def _length(part: Part, size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length over which a displacement strains a cell, by its width."""
    return size ** (2 / part.dimension - 1)
