"""Pictures of a proof: its strips, and stress error, utilisation, shift, distortion, seams and widths on the roof."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..checks import paths, validation
from ..patterns.proofs import PatternProof
from ..patterns.seam_lengths import segment_differences
from ..runtime.processes import by_the_first
from .contour_maps import VIEW, small_picture
from .cutting_patterns import draw_pattern
from .screen import obstacle
from .strips_in_view import InView, in_view, line_along

STRIPS, SEAMS = "strips.png", "seams.png"
EQUAL_SEAMS = 1e-7  # difference of seams that counts as none [%]
PICTURES = {
    STRIPS: "Strips on the roof and flat",
    "stress-error.png": "Stress error after assembly",
    "utilisation.png": "Utilisation after assembly",
    "shift.png": "Shift from the design",
    "distortion.png": "Change of area by flattening",
    SEAMS: "Difference of both sides of seams in the cloth",
    "widths.png": "Width of the cloth against the roll",
}  # with their captions


class _Map(NamedTuple):
    """Field on the roof, and the ends of its colours, None for its own extremes; symmetric about zero, or not."""

    title: str
    values: Any
    ends: tuple[float, float] | None = None
    symmetric: bool = False


@by_the_first
def pattern_proof(proof: PatternProof, folder: str | Path) -> None:
    """Plot a proof as pictures in a folder, which is made: strips.png, stress-error.png, utilisation.png, shift.png.

    Beside them distortion.png has the change of area by flattening. On seams.png is the difference of both sides of
    each segment of seams. On widths.png is the width of the cloth less that of the roll. Without strengths, seams or a
    roll the picture of it is left out. Films of a cushion are drawn one below the other. Colours of the stress error
    end at that of 95 % of the area. Without pyvista, or if VTK cannot draw on a screen or in memory, a warning replaces
    all.

    Args:
        proof: The proof.
        folder: The folder.

    Raises:
        ValueError: It is no proof; the folder cannot be written.
    """
    validation.instance("pattern_proof proof", proof, PatternProof)
    place = paths.path("folder", folder, spare=max(map(len, PICTURES)))
    paths.check_writable("folder", place / STRIPS)
    draw_proof(proof, place)


def draw_proof(proof: PatternProof, folder: Path) -> None:
    """Plot as `pattern_proof`, on one process."""
    if reason := obstacle():
        warnings.warn(f"The proof has no pictures: {reason}", stacklevel=4)
        return
    draw_pattern(proof.pattern, folder / STRIPS, np.asarray(VIEW, dtype=float), proof.pattern.strips.length_unit)
    strips = proof.pattern.strips
    found = in_view(strips, strips.structure.points + proof.state.displacement)
    for name, field in _maps(proof, found):
        shape = in_view(strips, strips.structure.points, seams=True) if name == SEAMS else found
        small_picture(shape.structure, {field.title: field.values}, folder / name, field.ends, field.symmetric)


def left_out(proof: Mapping[str, Any]) -> list[str]:
    """Sentences on pictures that the numbers of a proof do not have, as of `PatternProof.to_dict`."""
    found = []
    if proof["utilisation"] is None:
        found.append("Utilisation is not told: no strip has a strength, of the limits of stress.")
    if proof["roll width"] is None:
        found.append("Widths are not compared with a roll: none is given.")
    if all(len(edge["cloth"]) < 2 for edge in proof["edges"]):
        found.append("There are no seams.")
    return found


def _maps(proof: PatternProof, found: InView) -> Iterator[tuple[str, _Map]]:
    """Fields that the proof has, by the names of their files."""
    unit, strips = proof.pattern.strips.length_unit, proof.strips
    error = {name: 100 * strip.stress_error for name, strip in strips.items()}
    most = 100 * proof.stress_error_of_most
    yield "stress-error.png", _Map("stress error [%]", error, (0.0, most) if most < 100 * proof.stress_error else None)
    used = {name: strip.utilisation for name, strip in strips.items() if strip.utilisation is not None}
    if used:
        yield "utilisation.png", _Map("utilisation [-]", used)
    yield "shift.png", _Map(f"shift [{unit}]", found.at_nodes(proof.shift))
    change = {name: 100 * (strip.distortion - 1) for name, strip in strips.items()}
    yield "distortion.png", _Map("change of area by flattening [%]", change, symmetric=True)
    apart = {line_along(name): 100 * values for name, values in segment_differences(proof.pattern).items()}
    if apart:
        largest = max(float(values.max()) for values in apart.values())
        yield SEAMS, _Map("difference of both sides of seams [%]", apart, (0.0, max(largest, EQUAL_SEAMS)))
    if proof.roll_width is not None:
        beyond = {
            name: np.full(len(strip.area), 100 * (strip.width / proof.roll_width - 1)) for name, strip in strips.items()
        }
        yield "widths.png", _Map("width of the cloth beyond that of the roll [%]", beyond, symmetric=True)
