"""Pictures of a proof: the strips on the roof and flat, stress error and shift after assembly."""

import warnings
from pathlib import Path

import numpy as np

from ...patterns.proofs import PatternProof
from ...plot.contour_maps import VIEW, small_picture
from ...plot.cutting_patterns import draw_pattern
from ...plot.screen import obstacle

STRIPS, ERROR, SHIFT = "strips.png", "stress-error.png", "shift.png"


def draw_proof(proof: PatternProof, folder: Path) -> None:
    """Draw the pictures in a folder, on one process; a warning replaces them where nothing can draw."""
    if reason := obstacle():
        warnings.warn(f"The proof has no pictures: {reason}", stacklevel=3)
        return
    unit = proof.pattern.strips.length_unit
    draw_pattern(proof.pattern, folder / STRIPS, np.asarray(VIEW, dtype=float), unit)
    error = {name: 100 * strip.stress_error for name, strip in proof.strips.items()}
    small_picture(proof.state, {"stress error [%]": error}, folder / ERROR)
    small_picture(proof.state, {f"shift [{unit}]": proof.shift}, folder / SHIFT)
