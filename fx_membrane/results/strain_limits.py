"""Warnings and remarks where strains, or those that belong to the prestress, leave the range of the material law."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..model import laws
from ..model.cell_tensors import once
from ..model.natural_shape import inverse_less_identity
from ..model.natural_shape import strain as natural_strain
from ..model.parts import Part
from ..model.structure import Structure
from .initial_stress import prestress
from .part_results import BarResult, MembraneResult
from .principal import principal_values
from .states import StageResult
from .told_states import Remark

ABSURD = 1.0  # strain that no fabric or cable bears


class LargeStrainWarning(UserWarning):
    """Strains beyond the range of the material law: above 5 % in that of Saint Venant-Kirchhoff.

    A relative change of length e has the Green-Lagrange strain E = e + e^2 / 2. The force EA E (1 + e) differs from EA
    e by the fraction 3 e / 2: 8 % at e = 5 %.

    For a prestress it is the elastic strain of the reference shape, prestress over stiffness. With a natural shape it
    is the strain with respect to that. Laws for large strains have no limit of their own; for their prestress it is 100
    %.
    """


class LargestStrain(NamedTuple):
    """Cell nearest to the limit of its law.

    Attributes:
        part: Name of its part.
        cell: Number of the cell.
        strain: Its largest strain, in tension or compression [-].
        limit: Limit of its law [-].
        beyond: Number of all cells beyond their limits.
    """

    part: str
    cell: int
    strain: float
    limit: float
    beyond: int


def warn_of_large_prestress(structure: Structure, stacklevel: int) -> None:
    """Warn once, of the part with the largest strain of its prestress, in tension, compression or excess."""
    strains = {name: _largest(_prestrain(part)) for name, part in structure.parts.items()}
    limits = {name: min(laws.strain_limit(part.material), ABSURD) for name, part in structure.parts.items()}
    shares = np.array([np.abs(strains[name]).max() / limits[name] for name in strains])
    name = list(strains)[first_largest(shares)]
    cell = first_largest(np.abs(strains[name]))
    strain = strains[name][cell]
    if not abs(strain) > limits[name]:
        return
    if abs(strain) > ABSURD:
        advice = "Units are probably mixed: check that prestress, stiffness and lengths are in the same system."
    elif strain < 0 and not structure.parts[name].is_strut:
        advice = (
            "Check prestress, stiffness and units; an excess of length or cloth needs a reference shape nearer to its "
            "own size. Or the part that takes it up is too stiff."
        )
    else:
        advice = "Check prestress, stiffness and units; if they are right, take stiffness there for a rough value."
    warnings.warn(
        f"Part {name!r} is prestressed by {100 * strain:.3g} %, the strain that belongs to the prestress by the "
        f"stiffness (cell {cell}); {_meant(structure.parts[name], limits[name])}. {advice}",
        LargeStrainWarning,
        stacklevel=stacklevel,
    )


def strain_remarks(result: StageResult) -> Iterator[Remark]:
    """At most one, on the most strained part; strains that wrinkling, slackness or an excess takes up do not count."""
    largest = largest_strain(result)
    if not largest or not largest.strain > largest.limit:
        return
    name, cell, limit = largest.part, largest.cell, largest.limit
    strain = f"{100 * largest.strain:.3g} %" + (
        f" ({counted(largest.beyond - 1, 'more cell')} by over {100 * limit:g} %)" if largest.beyond > 1 else ""
    )
    if largest.strain > ABSURD:
        advice = "Units are probably mixed: check that loads, prestress, stiffness and lengths are in the same system."
    else:
        advice = "Check stiffness, loads and units; if they are right, take forces and stresses there for rough values."
    yield Remark(
        f"cell {cell} of part {name!r} is strained by {strain}; {_meant(result.structure.parts[name], limit)}. "
        + advice,
        LargeStrainWarning,
    )


def largest_strain(result: StageResult) -> LargestStrain | None:
    """Find the cell nearest to the limit of its law, or farthest beyond; None if no law has one."""
    limits = {name: laws.strain_limit(result.structure.parts[name].material) for name in result.parts}
    limits = {name: limit for name, limit in limits.items() if np.isfinite(limit)}
    if not limits:
        return None
    sizes = {
        name: _sizes(
            result.structure.parts[name], result.parts[name], prestress(result.structure, name, result.actions)
        )
        for name in limits
    }
    name = list(sizes)[first_largest(np.array([size.max() / limits[name] for name, size in sizes.items()]))]
    cell = first_largest(sizes[name])
    beyond = sum(int((size > limits[other]).sum()) for other, size in sizes.items())
    return LargestStrain(name, cell, float(sizes[name][cell]), limits[name], beyond)


def _sizes(part: Part, result: MembraneResult | BarResult, sigma0: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest strain that each cell resists, in tension or compression, shape (cells,) [-]; sigma0 is its prestress."""
    strain = given = result.strain.reshape(sigma0.shape)
    if (principal_values(sigma0) < 0).any():
        strain = strain + _elastic(part, _compression(sigma0))
    largest = principal_values(strain)[:, -1]
    sizes = np.maximum(largest, np.where(result.taut, -principal_values(given)[:, 0], 0.0))
    return np.where(result.slack, 0.0, sizes)


def elastic_strain(part: Part, stress: NDArray[np.float64]) -> NDArray[np.float64] | None:
    """Elastic strains of cells under stresses, both (cells, d, d); None for a law without a compliance."""
    return laws.strain(part.material, stress)


def _elastic(part: Part, stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Elastic strains as above; without a compliance, stress over stiffness."""
    strain = elastic_strain(part, stress)
    return stress / part.material.stiffness if strain is None else strain


def _prestrain(part: Part) -> NDArray[np.float64]:
    """Elastic strain in the reference shape, by prestress and natural stretch, shape (cells, d, d) [-]."""
    if part.shares_tension:  # the first shape of a rope of given length is a guess
        return _elastic(part, part.prestress_tensors())
    H = inverse_less_identity(once(part.natural_tensors()) - np.eye(part.dimension))
    natural = natural_strain(H)
    if not part.carries_compression:  # a larger natural shape is slack, and its law is not used
        natural = natural - _compression(natural)
    return _elastic(part, part.prestress_tensors()) + natural


def _meant(part: Part, limit: float) -> str:
    return f"its law ({type(part.material).__name__}) is meant for less than {100 * limit:g} %"


def _compression(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compressive part of stresses, shape (cells, d, d)."""
    values, directions = np.linalg.eigh(stress)
    return (directions * np.minimum(values, 0.0)[:, None, :]) @ directions.transpose(0, 2, 1)


def _largest(tensors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Principal values of largest magnitude, with their sign, shape (cells,)."""
    values = principal_values(tensors)
    return np.where(-values[:, 0] > values[:, -1], values[:, 0], values[:, -1])
