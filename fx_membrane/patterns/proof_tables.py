"""Proof of a cutting pattern as text and as plain data."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks.validation import format_point
from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..results.screen_lines import wrapped
from .strip_proofs import JUDGED_SHARE

if TYPE_CHECKING:
    from .proofs import PatternProof

FOUND = ("wanted", "least", "mean", "largest")
LINE_WIDTH = 98  # columns of all lines, where names of strips have at most twelve letters


def data(proof: PatternProof) -> dict[str, Any]:
    """Numbers of a proof as dictionaries, lists, texts and numbers; None where one is infinite or missing."""
    shift = proof.shift
    node = first_largest(shift)
    strips = [_strip(proof, name) for name in proof.strips]
    worst = strips[first_largest(np.array([row["stress error"] for row in strips]))]
    area = np.array([row["area"] for row in strips])
    mean, square = (
        float(np.average([row[f"{kind} stress error"] ** power for row in strips], weights=area))
        for kind, power in (("mean", 1), ("rms", 2))
    )
    fit = proof.pattern.fit
    told: dict[str, Any] = {
        "stress error": proof.stress_error,
        "mean stress error": mean,
        "rms stress error": float(np.sqrt(square)),
        "strip of stress error": worst["strip"],
        "cell of stress error": worst["cell of stress error"],
        "place of stress error": worst["place of stress error"],
        "stress error of most": proof.stress_error_of_most,
        "largest shift": float(shift[node]),
        "node of largest shift": int(node),
        "place of largest shift": proof.pattern.strips.structure.points[node].tolist(),
        "flattening energy": proof.pattern.energy,
        "seam difference": proof.seam_difference,
        "roll width": proof.roll_width,
        "wanted stress error": proof.wanted_error,
        "stress error of the design": proof.design_error if np.isfinite(proof.design_error or 0.0) else None,
        "utilisation": proof.utilisation,
        "remarks": list(proof.remarks),
        "strips": strips,
        "edges": [_edge(proof, name) for name in proof.edges],
    }
    return told if fit is None else told | {"nearest stress": fit.to_dict()}


def text(proof: PatternProof, force: str | None = None, length: str | None = None) -> str:
    """Table of a proof, with the names of its units; no number is converted."""
    told, strips = data(proof), proof.pattern.strips
    force, length = force or strips.force_unit, length or strips.length_unit
    energy = "J" if (force, length) == ("N", "m") else f"{force} {length}"
    mean, rms, largest = (100 * told[f"{kind}stress error"] for kind in ("mean ", "rms ", ""))
    most = 100 * told["stress error of most"]
    error, shift = (format_point(np.array(told[f"place of {what}"])) for what in ("stress error", "largest shift"))
    wide = max(12, *(len(name) + 1 for name in proof.strips))
    rows = told["strips"]
    fit = [] if proof.pattern.fit is None else ["", str(proof.pattern.fit)]
    return "\n".join(
        [
            f"Proof of the cutting pattern: {counted(len(rows), 'strip')} sewn together, in equilibrium",
            f"  stress error             mean {mean:.3g}, rms {rms:.3g}, largest {largest:.3g} % of the mean stress of "
            "the design",
            f"                           largest in {told['strip of stress error']}, cell "
            f"{told['cell of stress error']}, at {error}",
            f"  stress error of most     below {most:.3g} % on {100 * JUDGED_SHARE:g} % of the area",
            f"  largest shift            {told['largest shift']:.4g} {length} at node {told['node of largest shift']}, "
            f"{shift}",
            f"  flattening energy        {told['flattening energy']:.6g} {energy}",
            f"  largest seam difference  {told['seam difference']:.2g} of the length, cloth on both sides",
            *(wrapped(words, 0, 2, LINE_WIDTH) for words in told["remarks"]),
            "",
            f"Cloth [{length}], change of area by flattening and stress error [%], and the place of the largest",
            f"widest: for a stress error of {100 * proof.wanted_error:g} % at the edges, by the curvature of "
            f"{100 * JUDGED_SHARE:g} % of the area",
            f"{'strip':<{wide}}{'length':>8}{'width':>8}{'widest':>8}{'change':>8}{'mean':>8}{'rms':>8}{'largest':>8}"
            "  place",
            *(_fit(row, wide) for row in rows),
            *_too_wide(rows, proof.roll_width, length),
            "",
            f"Area on the surface [{length}2], stress [{force}/{length}]: wanted mean, and found",
            f"{'':<{wide}}{'':>9}{'warp':>32}{'weft':>32}",
            f"{'strip':<{wide}}{'area':>9}{''.join(f'{one:>8}' for one in FOUND * 2)}{'util.':>8}",
            *(_stresses(row, wide) for row in rows),
            *fit,
        ]
    )


def _fit(row: dict[str, Any], wide: int) -> str:
    widest = "any" if row["widest"] is None else _short(row["widest"])
    change = max((row["least distortion"] - 1, row["largest distortion"] - 1), key=abs)
    numbers = (row["length"], row["width"])
    errors = (change, row["mean stress error"], row["rms stress error"], row["stress error"])
    place = ", ".join(f"{value:.3g}" for value in row["place of stress error"])
    return (
        f"{row['strip']:<{wide}}{''.join(f'{_short(value):>8}' for value in numbers)}{widest:>8}"
        f"{''.join(f'{100 * value:>8.2f}' for value in errors)}  ({place})"
    )


def _too_wide(rows: list[dict[str, Any]], roll: float | None, length: str) -> list[str]:
    """Sentence on the strips that are wider than the roll."""
    wide = [row["strip"] for row in rows if roll is not None and row["width"] > roll]
    if not wide:
        return []
    names = ", ".join(name.replace(" ", "\0") for name in wide)  # a name stays in one line
    return wrapped(
        f"Wider than the roll without allowances, {roll:.4g} {length}: {names}", 0, 2, LINE_WIDTH
    ).splitlines()


def _stresses(row: dict[str, Any], wide: int) -> str:
    used = "-" if row["utilisation"] is None else f"{row['utilisation']:.2f}"
    stress = "".join(f"{_short(row[f'{way} {one}']):>8}" for way in ("warp", "weft") for one in FOUND)
    return f"{row['strip']:<{wide}}{_short(row['area']):>9}{stress}{used:>8}"


def _short(value: float) -> str:
    """Write a number with four digits, or with those for which seven letters are enough."""
    if 1e4 <= abs(value) < 1e6:
        return f"{value:.0f}"
    return next((text for digits in (4, 3, 2) if len(text := f"{value:.{digits}g}") < 8), f"{value:.0e}")


def _strip(proof: PatternProof, name: str) -> dict[str, Any]:
    strip, structure = proof.strips[name], proof.pattern.strips.structure
    error = strip.stress_error
    cell = first_largest(error)
    row: dict[str, Any] = {
        "strip": name,
        "length": strip.length,
        "width": strip.width,
        "widest": float(strip.widest) if np.isfinite(strip.widest) else None,
        "area": float(strip.area.sum()),
        "area of cloth": proof.pattern.cloth[name].area,
        "compensation warp": float(proof.pattern.compensation[name][0]),
        "compensation weft": float(proof.pattern.compensation[name][1]),
        "least distortion": float(strip.distortion.min()),
        "largest distortion": float(strip.distortion.max()),
        "largest curvature": float(strip.curvature[first_largest(np.abs(strip.curvature))]),
        "stress error": float(error.max()),
        "mean stress error": float(strip.mean(error)),
        "rms stress error": float(np.sqrt(strip.mean(error**2))),
        "cell of stress error": int(cell),
        "place of stress error": structure.points[structure.parts[name].cells[cell]].mean(axis=0).tolist(),
        "utilisation": strip.largest_utilisation,
        "fits roll": None if proof.roll_width is None else bool(strip.width <= proof.roll_width),
    }
    for column, way in enumerate(("warp", "weft")):
        wanted, found = strip.wanted[:, column], strip.found[:, column]
        row |= {f"{way} wanted": float(strip.mean(wanted)), f"{way} least": float(found.min())}
        row |= {f"{way} mean": float(strip.mean(found)), f"{way} largest": float(found.max())}
    return row


def _edge(proof: PatternProof, name: str) -> dict[str, Any]:
    edge = proof.edges[name]
    return {
        "edge": name,
        "surface": edge.surface,
        "flat": edge.flat.tolist(),
        "cloth": edge.cloth.tolist(),
        "difference": edge.difference,
    }
