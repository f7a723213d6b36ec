"""Changes of natural shape and prestress in a stage, as plain data: temperature, lengths, cutting, loss."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.values import with_article
from ..geometry.sizes import measures
from . import cell_tensors, natural_shape
from .base_classes import AnyChange
from .cable_changes import FixedLength, GivenForce, UnstressedLength, check_cable_change, store_cells
from .structure import Structure

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class NaturalStretch(AnyChange):
    """Natural shape times a stretch: cutting (compensation), shrinkage, creep, a new length by a factor.

    Args:
        stretch: New natural lengths over those at the start of the stage [-]: a number, of membranes also a (warp,
            weft) pair or a tensor (2, 2). A compensation of 1 % and 2 % is the stretch (0.99, 0.98).
        part: Name of the part.
        cells: Changed cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The stretch has another shape, or is not positive; part is not a text; cells are not whole numbers,
            or one is named twice.

    Example:
        >>> Stage("creep", changes=[NaturalStretch((1.004, 1.002), "roof")], after="prestress").changes[0].part
        'roof'
    """

    stretch: ArrayLike
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.finite, "stretch")
        store_cells(self)
        value = np.asarray(self.stretch)
        if value.shape not in ((), (2,), (2, 2)):
            raise ValueError(
                f"NaturalStretch stretch has shape {value.shape}; give a number, a pair or a (2, 2) tensor."
            )
        natural_shape.check("NaturalStretch stretch", cell_tensors.of_membrane("NaturalStretch stretch", value, 1))


@dataclass(frozen=True, eq=False)
class TemperatureChange(AnyChange):
    """Warming or cooling of a part, free to expand by its coefficient.

    It takes expansion x difference from the Green-Lagrange strain with respect to the natural shape. So changes add up,
    and warming and cooling by as much leave no trace. A length without stress grows by (1 - 2 expansion x
    difference)^(-1/2), which is 1 + expansion x difference to first order.

    Args:
        difference: Change of the temperature in the stage [K].
        part: Name of the part.
        expansion: Coefficient of thermal expansion, of membranes also a (warp, weft) pair [1/K].
        cells: Changed cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: A value is not a number; strains of 37 % or more; part and cells as for `NaturalStretch`.

    Example:
        >>> TemperatureChange(-30.0, "stays", expansion=1.2e-5).difference
        -30.0
    """

    difference: float
    part: str
    expansion: ArrayLike
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.number, "difference")
        validation.store(self, validation.finite, "expansion")
        store_cells(self)
        value = np.asarray(self.expansion)
        if value.shape not in ((), (2,)):
            raise ValueError(
                f"TemperatureChange expansion has shape {value.shape}; give a number or a (warp, weft) pair [1/K]."
            )
        strain = self.difference * value
        if not (np.abs(strain) < 0.37).all():
            raise ValueError(
                f"TemperatureChange strains part {self.part!r} by {100 * np.abs(strain).max():.3g} %; give the "
                "expansion per kelvin, about 1e-5, and the difference in kelvin."
            )


@dataclass(frozen=True, eq=False)
class LengthChange(AnyChange):
    """Change of the unstressed length of a cable or a mast: a stay that is shortened, a mast that is jacked.

    Args:
        change: Change of the unstressed length of all chosen cells together [m]; they share it in proportion to their
            unstressed lengths.
        part: Name of the part.
        cells: Changed cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The change is not a number; part and cells as for `NaturalStretch`.

    Example:
        >>> LengthChange(-0.03, "stays", cells=[4]).change
        -0.03
    """

    change: float
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.number, "change")
        store_cells(self)


@dataclass(frozen=True, eq=False)
class PrestressFactor(AnyChange):
    """Prestress times a factor: the loss by creep and relaxation, or the gain by stressing again.

    Args:
        factor: New prestress over that at the start of the stage, zero or above [-]. A loss of 20 % is 0.8.
        part: Name of the part.
        cells: Changed cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The factor is negative or not a number; part and cells as for `NaturalStretch`.

    Example:
        >>> PrestressFactor(0.8, "roof").factor
        0.8
    """

    factor: float
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.not_negative, "factor")
        store_cells(self)


Change = (
    NaturalStretch | TemperatureChange | LengthChange | PrestressFactor | GivenForce | UnstressedLength | FixedLength
)


def check_change(structure: Structure, stage: str, change: Change) -> None:
    """Refuse a change of an unknown part or cell, or of one that it cannot act on."""
    kind = with_article(type(change).__name__)
    if change.part not in structure.parts:
        raise ValueError(
            f"{stage} has {kind} of part {change.part!r}, which does not exist; the parts are {list(structure.parts)}."
        )
    part = structure.parts[change.part]
    if change.cells is not None:
        what = f"{stage}: {kind} of part {change.part!r}"
        validation.in_range(what, np.asarray(change.cells), len(part.cells), "cell")
    if isinstance(change, LengthChange) and change.part in structure.membranes:
        raise ValueError(
            f"{stage} has a LengthChange of {change.part!r}, a Membrane; it acts on cables and masts, of a membrane "
            "give a NaturalStretch."
        )
    if isinstance(change, GivenForce | UnstressedLength | FixedLength):
        check_cable_change(structure, stage, change)
    if isinstance(change, NaturalStretch):
        structure.check_shear(change.part, change.stretch, "NaturalStretch")
    directed = np.ndim(getattr(change, "stretch", getattr(change, "expansion", 0.0))) > 0
    if directed and not part.has_warp:
        raise ValueError(
            f"{stage} has {kind} of {change.part!r} along warp and weft, which it does not have; give one number, or "
            "the membrane a warp."
        )


def natural_after(structure: Structure, change: Change, natural: Array) -> Array:
    """Natural shape of a part after a change, shape (cells, d, d) [-].

    Args:
        structure: The structure.
        change: A `NaturalStretch`, `TemperatureChange`, `LengthChange` or `UnstressedLength`.
        natural: Natural shape at the start: A of `forms.natural_shape`, shape (cells, d, d) [-].

    Raises:
        ValueError: A cell is inverted by it, or half or twice as large as in the reference shape.
    """
    part, kind = structure.parts[change.part], type(change).__name__
    chosen = slice(None) if change.cells is None else np.asarray(change.cells)
    stretch: Any
    if isinstance(change, LengthChange):
        lengths = (measures(structure.points, part.cells) * natural[:, 0, 0])[chosen]
        stretch = np.eye(1) * (1 + change.change / lengths.sum())
    elif isinstance(change, UnstressedLength):
        lengths = (measures(structure.points, part.cells) * natural[:, 0, 0])[chosen]
        stretch = np.eye(1) * (change.length / lengths.sum())
    elif isinstance(change, TemperatureChange):
        strain = cell_tensors.of_membrane(kind, change.difference * np.asarray(change.expansion), 1)[0]
        d = part.dimension
        cells = np.arange(len(part.cells))[chosen]
        stretch = _expanded(change.part, cells, natural[chosen], part.natural_tensors()[chosen], strain[:d, :d])
    else:
        assert isinstance(change, NaturalStretch)
        stretch = cell_tensors.of_membrane(kind, change.stretch, 1)[0][: part.dimension, : part.dimension]
    after = natural.copy()
    after[chosen] = stretch @ natural[chosen]
    natural_shape.check(f"Part {change.part!r} after {with_article(kind)}", after)
    return after


def _expanded(part: str, cells: NDArray[np.int64], natural: Array, first: Array, strain: Array) -> Array:
    """Stretch of natural shapes A, shape (cells, d, d), by which they grow by a strain, (d, d), from the first ones.

    The metric A^-T A^-1 loses twice the strain, that with respect to the first natural shape: changes add up. The
    warp of the natural shape keeps its direction.
    """
    inverse, own = np.linalg.inv(natural), np.linalg.inv(first)
    metric = inverse.transpose(0, 2, 1) @ inverse
    left = metric - 2 * own.transpose(0, 2, 1) @ strain @ own
    gone = np.flatnonzero(np.linalg.eigvalsh(left)[:, 0] <= 0)
    if len(gone):
        raise ValueError(
            f"TemperatureChange leaves cell {cells[gone[0]]} of part {part!r} without a stress-free size, by the "
            f"strain {np.abs(strain).max():.3g}; check the expansion [1/K] and the difference [K]."
        )
    before, after = np.linalg.cholesky(metric), np.linalg.cholesky(left)
    return np.linalg.solve(after.transpose(0, 2, 1), before.transpose(0, 2, 1))
