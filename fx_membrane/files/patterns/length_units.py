"""Warning of pieces of cloth in a wrong unit, by their size."""

from __future__ import annotations

import warnings
from collections.abc import Mapping

from ...patterns.cloth_pieces import Piece
from ..mesh_files import METRES

LONGEST = 300.0  # piece of a roof: rolls have 50 to 100 m [m]
SHORTEST = 0.05  # the longest piece of a model of one [m]


class LengthUnitWarning(UserWarning):
    """Pieces of cloth longer than any roll, or all shorter than a hand: their unit of length is probably another."""


def warn_of_length_unit(pieces: Mapping[str, Piece], unit: str, stacklevel: int) -> None:
    """Warn of the longest piece if it has the size of none."""
    longest = max(pieces.values(), key=lambda piece: piece.length)
    if SHORTEST <= longest.length * METRES[unit] <= LONGEST:
        return
    warnings.warn(
        f"Piece {longest.name!r} is {longest.length:.4g} {unit} long and {longest.width:.4g} {unit} wide, which no "
        'piece of a roof is; name the unit of the pattern by length_unit, as length_unit="mm".',
        LengthUnitWarning,
        stacklevel=stacklevel + 1,
    )
