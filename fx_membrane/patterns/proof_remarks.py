"""Remarks on a proof: stress far from the design, with its causes, utilisation, and numbers that are not asked for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..geometry.extremes import first_largest

if TYPE_CHECKING:
    from .proofs import PatternProof

NOTABLE = 0.25  # share of the mean stress error that is told of the design


def stress_missed(proof: PatternProof) -> tuple[str, ...]:
    """Clause on the area where stress is off by more than the wanted error; none where 95 % of the area keep to it."""
    if proof.stress_error_of_most <= proof.wanted_error:
        return ()
    error, area = proof.stress_errors
    share = area[error > proof.wanted_error].sum() / area.sum()
    return (
        f"stress is off by more than {100 * proof.wanted_error:.3g} % of its mean on {100 * share:.3g} % of the area",
    )


def strength_missed(proof: PatternProof) -> tuple[str, ...]:
    """Clauses on strips that bear more than their strength."""
    used = {name: strip.largest_utilisation or 0.0 for name, strip in proof.strips.items()}
    return tuple(f"{name!r} bears {share:.3g} times its strength" for name, share in used.items() if share > 1)


def remarks(proof: PatternProof) -> tuple[str, ...]:
    """Sentences on what is beyond the wanted stress error or a strength, and on causes of the former."""
    off = stress_missed(proof)
    causes: list[str] = []
    if off:
        causes = _of_design(proof)
        causes += [] if causes else _of_compensation(proof)
        causes += _of_width(proof, others=bool(causes))
    return (*map(_sentence, off), *causes, *map(_sentence, strength_missed(proof)))


def _sentence(clause: str) -> str:
    return f"{clause[0].upper()}{clause[1:]}."


def _of_design(proof: PatternProof) -> list[str]:
    own = proof.design_error
    error, area = proof.stress_errors
    mean = float(np.average(error, weights=area))
    if own is None or own < NOTABLE * mean:
        return []
    remedy = "find its form with this prestress on finer cells, or give the proof the loads that it balances."
    if np.isinf(own):
        return [f"The design is not in balance, and finds no equilibrium before it is cut; {remedy}"]
    return [
        f"The design is not in balance: before it is cut, its stress settles by {100 * own:.3g} % of its mean, of "
        f"{100 * mean:.3g} % after; {remedy}"
    ]


def _of_compensation(proof: PatternProof) -> list[str]:
    """Sentence on the strip whose mean stress is off by more than curvature can do."""
    names = list(proof.strips)
    name = names[first_largest(np.array([_beyond_curvature(proof, one) for one in names]))]
    if _beyond_curvature(proof, name) <= 1:
        return []
    strip, units = proof.strips[name], proof.pattern.strips
    (warp, weft), (wanted_warp, wanted_weft) = strip.mean(strip.found), strip.mean(strip.wanted)
    return [
        f"The compensation of {name!r} does not fit its prestress: on average it bears {warp:.3g} and {weft:.3g} "
        f"{units.force_unit}/{units.length_unit} along warp and weft, and the design has {wanted_warp:.3g} and "
        f"{wanted_weft:.3g}; compensate by the prestress, or give factors or tests that belong to it."
    ]


def _beyond_curvature(proof: PatternProof, name: str) -> float:
    """Error of the mean stress over the error that curvature makes at the edges of a strip of its width [-]."""
    strip = proof.strips[name]
    wanted = strip.mean(strip.wanted)
    error = np.abs(strip.mean(strip.found) - wanted).max() / np.abs(wanted).mean()
    return float(error / (proof.wanted_error * max(1.0, (strip.width / strip.widest) ** 2)))


def _of_width(proof: PatternProof, others: bool) -> list[str]:
    """Sentence on the widest strip for its curvature; on finer cells where there are no other causes."""
    names, unit = list(proof.strips), proof.pattern.strips.length_unit
    name = names[first_largest(np.array([proof.strips[name].width / proof.strips[name].widest for name in names]))]
    strip = proof.strips[name]
    if strip.width <= strip.widest and others:
        return []
    if strip.width <= strip.widest:
        return [
            "Strips are narrow enough for their curvature; move their outlines by nearest_stress_pattern, or take "
            "finer cells."
        ]
    return [
        f"The curvature of {name!r} allows a width of {strip.widest:.3g} {unit}, and it has {strip.width:.3g} {unit}; "
        "cut narrower strips, or ask for a larger stress error."
    ]
