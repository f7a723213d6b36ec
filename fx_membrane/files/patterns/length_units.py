"""Warning of pieces of cloth in a wrong unit, by their size."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import replace

from ...geometry.length_units import METRES
from ...patterns.cloth_pieces import Piece
from ...patterns.flat_strips import CuttingPattern

LONGEST_PIECE = 300.0  # piece of a roof: rolls have 50 to 100 m [m]
SHORTEST_PIECE = 0.05  # the longest piece of a model of one [m]
NARROWEST = 1e-3  # allowance that can be welded or sewn [m]


class LengthUnitWarning(UserWarning):
    """Pieces longer than any roll, or all shorter than a hand, or allowances below 1 mm: probably another unit."""


def in_unit(pattern: CuttingPattern, unit: str) -> CuttingPattern:
    """Name the unit of a pattern for its usual allowances, if its cloth has the size of a roof then."""
    longest = max(flat.length for flat in pattern.cloth.values())
    if not _is_of_a_roof(longest, unit):
        return pattern
    return replace(pattern, strips=replace(pattern.strips, length_unit=unit))


def warn_of_length_unit(pieces: Mapping[str, Piece], unit: str, stacklevel: int) -> None:
    """Warn of a longest piece that no roof has, or else of an allowance too narrow for a weld."""
    longest = max(pieces.values(), key=lambda piece: piece.length)
    if _is_of_a_roof(longest.length, unit):
        words = _narrow_allowance(pieces, unit)
    else:
        words = (
            f"Piece {longest.name!r} is {longest.length:.4g} {unit} long and {longest.width:.4g} {unit} wide, which no "
            'piece of a roof is; name the unit of the pattern by length_unit, as length_unit="mm".'
        )
    if words:
        warnings.warn(words, LengthUnitWarning, stacklevel=stacklevel + 1)


def _is_of_a_roof(length: float, unit: str) -> bool:
    return SHORTEST_PIECE <= length * METRES[unit] <= LONGEST_PIECE


def _narrow_allowance(pieces: Mapping[str, Piece], unit: str) -> str:
    """Sentence on the first allowance that is narrower than a millimetre, empty without any."""
    for piece in pieces.values():
        for side in piece.sides:
            if 0 < side.allowance * METRES[unit] < NARROWEST:
                return (
                    f"The allowance of {side.edge!r} is {side.allowance:.4g} {unit}, too narrow for a weld or a hem; "
                    f"give allowances in {unit}, or zero for none."
                )
    return ""
