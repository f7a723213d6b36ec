"""Rounding of nodal forces, node by node, so that a stiff part does not loosen the tolerance of others."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..geometry.measures import measures
from ..model.parts import Part
from ..model.structure import Structure
from .part_forms import stiffness

_Values = Mapping[str, NDArray[np.float64]]  # of the cells of each part, shape (cells,)

UNIT = 1e-15  # rounding of a cell's forces, relative to these forces


class Scales(NamedTuple):
    """Sizes of the forces of all cells at each node, before they balance.

    Attributes:
        prestress: Prestress forces, shape (n,) [N].
        stiffness: Force per displacement of a node, shape (n,) [N/m].
    """

    prestress: NDArray[np.float64]
    stiffness: NDArray[np.float64]

    def rounding(self, displacement: float) -> NDArray[np.float64]:
        """Force at each node at rounding, for the largest displacement [m], shape (n,) [N]."""
        return UNIT * (self.prestress + displacement * self.stiffness)


class Magnitudes(NamedTuple):
    """Typical forces and stiffnesses of a structure.

    Attributes:
        prestress_forces: 2-norm of the prestress forces of all cells, before they balance [N].
        stiffness: Typical stiffness, the median over the cells [N/m].
        scales: Sizes of the forces at the components of this process, in the order of a PETSc vector.
    """

    prestress_forces: float
    stiffness: float
    scales: Scales


def magnitudes(structure: Structure, elastic: bool, owned_nodes: NDArray[np.int64]) -> Magnitudes:
    """Typical forces and stiffnesses of a structure, of which this process owns some nodes."""
    sizes, prestress = _sizes(structure), prestresses(structure)
    owned = (np.repeat(values[owned_nodes], 3) for values in _scales(structure, elastic, sizes, prestress))
    forces = [prestress[name] * _width(part, sizes[name]) for name, part in structure.parts.items()]
    stiffnesses = [stiffness(part) / _length(part, sizes[name]) for name, part in structure.parts.items()]
    return Magnitudes(
        prestress_forces=float(np.sqrt(sum(float(force @ force) for force in forces))),
        stiffness=float(np.median(np.concatenate(stiffnesses))),
        scales=Scales(*owned),
    )


def scales(structure: Structure, elastic: bool) -> Scales:
    """Sizes of the nodal forces of a structure; the stiffness is that of prestress alone where it is not elastic."""
    return _scales(structure, elastic, _sizes(structure), prestresses(structure))


def _scales(structure: Structure, elastic: bool, sizes: _Values, prestress: _Values) -> Scales:
    found = Scales(_meeting(structure, prestress, sizes), np.zeros(len(structure.points)))
    for name, part in structure.parts.items():
        per_length = (prestress[name] + elastic * stiffness(part)) / _length(part, sizes[name])
        found.stiffness[:] += _at_nodes(structure, part, per_length)
    return found


def prestresses(structure: Structure) -> dict[str, NDArray[np.float64]]:
    """Sizes of the prestress of the cells of each part, shape (cells,) [N/m], of bars [N]."""
    tensors = {name: part.prestress_tensors() for name, part in structure.parts.items()}
    return {name: np.sqrt(np.einsum("nij,nij->n", values, values)) for name, values in tensors.items()}


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
    return size if part.dimension == 1 else np.ones_like(size)
