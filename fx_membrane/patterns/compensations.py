"""Compensation: ratios of unstressed to stressed cloth by prestress and law, by factors, or by biaxial tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.extremes import first_largest
from .biaxial_tests import BiaxialTests
from .cloth import Cloth
from .flat_shapes import Flattened
from .named_membranes import by_strip

Array = NDArray[np.float64]
Compensation = (
    Literal["prestress"]
    | float
    | Sequence[float]
    | BiaxialTests
    | Mapping[str, Literal["prestress"] | float | Sequence[float] | BiaxialTests]
)

MAX_COMPENSATION = 1.1  # factors above it are percentages: cloth that much longer than the surface bears nothing
MIN_RATIO, MAX_RATIO = 0.8, 1.25  # ratios of cloth to surface beyond which units or signs are probably mixed up
MAX_NEWTON_STEPS = 30
STRETCH_ROUNDING = 1e-12  # change of stretch that counts as rounding
DIFFERENCE_STRAIN = 1e-6  # strain of difference quotients
ENTRIES = ((0, 0), (1, 1), (0, 1))


def compensation_of(flat: Flattened, given: Compensation) -> Array:
    """Ratios of cloth to flat lengths of all cells in axes of warp and weft, symmetric, shape (k, 2, 2) [-].

    Raises:
        ValueError: There is no prestress to compensate; a factor is not positive, or far from one; a stress pair is
            outside the tests; a strip is unknown or has no compensation.
    """
    pieces = flat.pieces
    if isinstance(given, str):
        validation.choice("compensation", given, ("prestress",), "'prestress', factors, or BiaxialTests")
        return _by_law(flat, pieces.names)
    each = by_strip(flat.strips, given) if isinstance(given, Mapping) else dict.fromkeys(pieces.names, given)
    odd = [*sorted(each.keys() - set(pieces.names)), *(name for name in pieces.names if name not in each)]
    if odd:
        fault = "is no strip" if odd[0] in each else "has no compensation"
        raise ValueError(f"compensation: {odd[0]!r} {fault}; the strips are {list(pieces.names)}.")
    by_law = [name for name in pieces.names if _is_law(name, each[name])]
    pairs = np.array([np.ones(2) if name in by_law else _pair(flat, name, each[name]) for name in pieces.names])
    found = np.asarray((pairs[:, :, None] * np.eye(2))[pieces.strip_of_cell])
    return found @ _by_law(flat, by_law) if by_law else found


def mean_ratios(flat: Flattened, ratios: Array) -> dict[str, Array]:
    """Means of ratios along warp and weft by the name of the strip, each shape (2,) [-]."""
    area = np.linalg.det(flat.shapes)
    return {
        name: np.average(np.diagonal(ratios[cells], axis1=1, axis2=2), axis=0, weights=area[cells])
        for name, cells in ((name, flat.pieces.cells_of(number)) for number, name in enumerate(flat.pieces.names))
    }


def prestress_of(flat: Flattened) -> Array:
    """Prestress of all cells in axes of warp and weft on the surface, shape (k, 2, 2) [N/m]."""
    return np.concatenate([flat.strips.membrane(name).prestress_tensors() for name in flat.pieces.names])


def _is_law(name: str, given: Any) -> bool:
    """Return True for "prestress"; refuse other texts."""
    if isinstance(given, str):
        what = f"compensation of strip {name!r}"
        validation.choice(what, given, ("prestress",), "'prestress', factors, or BiaxialTests")
    return isinstance(given, str)


def _pair(flat: Flattened, name: str, given: Any) -> Array:
    if isinstance(given, BiaxialTests):
        cells = flat.pieces.cells_of(flat.pieces.names.index(name))
        stress = flat.strips.membrane(name).prestress_tensors()
        _refuse_no_prestress(flat, name, stress)
        mean = np.average(stress, axis=0, weights=np.linalg.det(flat.shapes[cells]))
        return 1 / (1 + given.at(np.diagonal(mean)))
    return factors_of(f"compensation of strip {name!r}", given)


def factors_of(what: str, given: float | Sequence[float]) -> Array:
    """Check a ratio of cloth to flat lengths, or a pair of them along warp and weft, shape (2,) [-].

    Raises:
        ValueError: It is none, or far from one.
    """
    factors = validation.finite(what, given)
    if factors.shape not in ((), (2,)):
        raise ValueError(
            f"{what} has shape {factors.shape}; give one ratio of cloth to flat lengths, or a (warp, weft) pair."
        )
    factors = np.broadcast_to(factors, 2)
    if not ((factors >= MIN_RATIO) & (factors <= MAX_RATIO)).all():
        raise ValueError(
            f"{what} is {factors.tolist()}; give ratios of cloth to flat lengths near one, as 0.99 for 1 % shorter, "
            f"between {MIN_RATIO:g} and {MAX_RATIO:g}."
        )
    if factors.max() > MAX_COMPENSATION:
        raise ValueError(
            f"{what} is {factors.tolist()}: cloth {100 * (factors.max() - 1):.3g} % longer than the surface; give "
            "ratios of cloth to flat lengths, not percentages, as 0.988 for 1.2 % shorter."
        )
    return factors


def _by_law(flat: Flattened, names: Sequence[str]) -> Array:
    """Natural size of cells that bear their prestress on the surface, one in other strips than those named."""
    stress = prestress_of(flat)
    for number, name in enumerate(flat.pieces.names):
        cells = flat.pieces.cells_of(number)
        if name in names:
            _refuse_no_prestress(flat, name, stress[cells])
        else:
            stress[cells] = 0.0
    found = np.linalg.inv(stretch_of_stress(flat.cloth, stress))
    values = np.linalg.eigvalsh(found)
    far = np.maximum(values[:, 1] / MAX_RATIO, MIN_RATIO / values[:, 0])
    cell = first_largest(far)
    if not far[cell] <= 1:
        name, where = flat.pieces.names[flat.pieces.strip_of_cell[cell]], _place(flat, slice(cell, cell + 1))
        raise ValueError(
            f"Strip {name!r}: the prestress stretches a cell by a factor of {1 / values[cell, 0]:.3g} at {where}; "
            "check prestress, stiffness and units."
        )
    return found


def _refuse_no_prestress(flat: Flattened, name: str, stress: Array) -> None:
    if not stress.any():
        where = _place(flat, flat.pieces.cells_of(flat.pieces.names.index(name)))
        raise ValueError(
            f"Strip {name!r} has no prestress to compensate; give its membrane a prestress around {where}, or "
            "compensation factors."
        )


def _place(flat: Flattened, cells: slice) -> str:
    """Middle of cells on the surface."""
    nodes = flat.pieces.nodes[flat.pieces.triangles[cells]]
    return validation.format_point(flat.strips.structure.points[nodes].mean(axis=(0, 1)))


def stretch_of_stress(cloth: Cloth, stress: Array) -> Array:
    """Stretches from the stress-free shape at which cells bear a Cauchy stress by their laws, both (k, 2, 2).

    Newton's method in each cell, with difference quotients of the law.

    Raises:
        ValueError: No stretch near one gives the stress of a cell.
    """
    stretch = np.broadcast_to(np.eye(2), stress.shape).copy()
    scale = np.array([law.stiffness for law in cloth.laws])[cloth.owner]
    with np.errstate(all="ignore"):
        for _ in range(MAX_NEWTON_STEPS):
            found = cloth.stress(stretch)
            slopes = np.empty((len(stress), 3, 3))
            for column, (i, j) in enumerate(ENTRIES):
                moved = stretch.copy()
                moved[:, i, j] += DIFFERENCE_STRAIN
                moved[:, j, i] = moved[:, i, j]
                slopes[:, :, column] = _entries(cloth.stress(moved) - found) / DIFFERENCE_STRAIN
            slopes += 1e-12 * scale[:, None, None] * np.eye(3)
            step = np.linalg.solve(slopes, _entries(stress - found)[:, :, None])[:, :, 0]
            step *= np.minimum(1.0, 0.1 / np.maximum(np.abs(step).max(axis=1), 1e-300))[:, None]
            for column, (i, j) in enumerate(ENTRIES):
                stretch[:, i, j] += step[:, column]
                stretch[:, j, i] = stretch[:, i, j]
            if np.abs(step).max() < STRETCH_ROUNDING:
                return stretch
    away = np.abs(step).max(axis=1)
    cell = int(np.argmax(np.where(np.isfinite(away), away, np.inf)))
    raise ValueError(
        f"Compensation: no stretch gives the prestress {stress[cell].tolist()} of a cell by its law; give another "
        "prestress, or compensation factors."
    )


def _entries(tensors: Array) -> Array:
    return np.stack([tensors[:, i, j] for i, j in ENTRIES], axis=1)
