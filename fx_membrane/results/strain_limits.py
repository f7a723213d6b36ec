"""Warnings and remarks where strains, or those that belong to the prestress, leave the range of the material law."""

import warnings
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..model.parts import Mast, Membrane, Part
from ..model.structure import Structure
from .states import BarResult, MembraneResult, Remark, StageResult

MODERATE = 0.05
ABSURD = 1.0  # strain that no fabric or cable bears


class LargeStrainWarning(UserWarning):
    """Strains above 5 %, beyond the range of the Saint Venant-Kirchhoff law.

    A relative change of length e has the Green-Lagrange strain E = e + e^2 / 2. The force EA E (1 + e) differs from EA
    e by the fraction 3 e / 2: 8 % at e = 5 %.

    For a prestress it is the elastic strain of the reference shape, prestress over stiffness.
    """


class _Strained(Remark):
    category = LargeStrainWarning


def warn_of_large_prestress(structure: Structure, stacklevel: int) -> None:
    """Warn once, of the part with the largest strain of its prestress, in tension, compression or excess."""
    strains = {name: _largest(elastic_strain(part, part.prestress_tensors())) for name, part in structure.parts.items()}
    name = max(strains, key=lambda name: np.abs(strains[name]).max())
    cell = int(np.abs(strains[name]).argmax())
    strain = strains[name][cell]
    if not abs(strain) > MODERATE:
        return
    if abs(strain) > ABSURD:
        advice = "Units are probably mixed: check that prestress, stiffness and lengths are in the same system."
    elif strain < 0 and not isinstance(structure.parts[name], Mast):
        advice = (
            "Check prestress, stiffness and units; an excess of length or cloth that is right needs a reference shape "
            "nearer to its own size, or what takes it up is too stiff."
        )
    else:
        advice = "Check prestress, stiffness and units; if they are right, take stiffness there for a rough value."
    warnings.warn(
        f"Part {name!r} is prestressed by {100 * strain:.3g} %, the strain that belongs to the prestress by the "
        f"stiffness (cell {cell}); the Saint Venant-Kirchhoff law is meant for less than {100 * MODERATE:g} %. "
        f"{advice}",
        LargeStrainWarning,
        stacklevel=stacklevel,
    )


def strain_remarks(result: StageResult) -> Iterator[Remark]:
    """At most one, on the most strained part; strains that wrinkling, slackness or an excess takes up do not count."""
    sizes = {name: _sizes(result.structure.parts[name], part) for name, part in result.parts.items()}
    name = max(sizes, key=lambda name: sizes[name].max())
    cell = int(sizes[name].argmax())
    if not sizes[name][cell] > MODERATE:
        return
    also = sum(int((size > MODERATE).sum()) for size in sizes.values()) - 1
    strain = f"{100 * sizes[name][cell]:.3g} %" + (f" ({also} more cells by over {100 * MODERATE:g} %)" if also else "")
    if sizes[name][cell] > ABSURD:
        advice = "Units are probably mixed: check that loads, prestress, stiffness and lengths are in the same system."
    else:
        advice = "Check stiffness, loads and units; if they are right, take forces and stresses there for rough values."
    yield _Strained(
        f"cell {cell} of part {name!r} is strained by {strain}; the Saint Venant-Kirchhoff law is meant for less than "
        f"{100 * MODERATE:g} %. {advice}"
    )


def _sizes(part: Part, result: MembraneResult | BarResult) -> NDArray[np.float64]:
    """Largest strain that each cell resists, in tension or compression, shape (cells,) [-]."""
    excess = elastic_strain(part, _compression(part.prestress_tensors()))
    if isinstance(result, BarResult):
        stretched = result.strain + excess[:, 0, 0]
        return np.where(result.slack, 0.0, np.maximum(stretched, -result.strain))
    largest = np.linalg.eigvalsh(result.strain + excess)[:, 1]
    least = np.linalg.eigvalsh(result.strain)[:, 0]
    sizes = np.maximum(largest, np.where(result.state == "taut", -least, 0.0))
    return np.where(result.state == "slack", 0.0, sizes)


def elastic_strain(part: Part, stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Elastic strains of cells under stresses, both of shape (cells, d, d)."""
    return part.material.strain(stress) if isinstance(part, Membrane) else np.divide(stress, part.axial_stiffness)


def _compression(stress: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compressive part of stresses, shape (cells, d, d)."""
    values, directions = np.linalg.eigh(stress)
    return (directions * np.minimum(values, 0.0)[:, None, :]) @ directions.transpose(0, 2, 1)


def _largest(tensors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Principal values of largest magnitude, with their sign, shape (cells,)."""
    values = np.linalg.eigvalsh(tensors)
    return np.where(-values[:, 0] > values[:, -1], values[:, 0], values[:, -1])
