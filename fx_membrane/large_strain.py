"""A warning where strains leave the range of the material law."""

import warnings

import numpy as np
from numpy.typing import NDArray

from .results import BarResult, MembraneResult, StageResult

MODERATE = 0.05
ABSURD = 1.0  # no fabric or cable bears that


class LargeStrainWarning(UserWarning):
    """Strains above 5 %, for which the Saint Venant-Kirchhoff law is not meant.

    A force EA E (1 + e), with the Green-Lagrange strain E = e + e^2 / 2 of a relative change of length e, differs from
    EA e by the share 3 e / 2: 8 % at e = 5 %.
    """


def warn_of_large_strains(result: StageResult, stacklevel: int) -> None:
    """Warns once, of the most strained part; strains that wrinkling or slackness takes up do not count."""
    sizes = {name: _sizes(part) for name, part in result.parts.items()}
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
    warnings.warn(
        f"Stage {result.name!r}: cell {cell} of part {name!r} is strained by {strain}; the Saint Venant-Kirchhoff "
        f"law is meant for less than {100 * MODERATE:g} %. {advice}",
        LargeStrainWarning,
        stacklevel=stacklevel,
    )


def _sizes(part: MembraneResult | BarResult) -> NDArray[np.float64]:
    """Largest strain that each cell resists, in tension or compression, shape (cells,) [-]."""
    if isinstance(part, BarResult):
        return np.where(part.slack, 0.0, np.abs(part.strain))
    least, largest = np.linalg.eigvalsh(part.strain).T
    return np.where(part.state == "slack", 0.0, np.maximum(largest, np.where(part.state == "taut", -least, 0.0)))
