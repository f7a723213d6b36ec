"""Archives of strips, cutting patterns and proofs: where they lie, their text, and their equilibrium as results."""

from __future__ import annotations

from pathlib import Path

from ...checks.values import counted
from ...model.stages import Stage
from ...model.structure import Structure
from ...patterns.flat_strips import CuttingPattern
from ...patterns.proof_tables import text
from ...patterns.proofs import PatternProof
from ...patterns.strips import Strips
from ...results.states import StageResults
from ..archive import load_results, origin_of
from .proof_files import ARCHIVES

PATTERN_FILE, PROOF_FILE = ARCHIVES
KINDS = [cls.__name__ for cls in (Strips, CuttingPattern, PatternProof)]


def pattern_at(place: Path) -> Strips | CuttingPattern | PatternProof | None:
    """Open an archive of strips, a cutting pattern or a proof, or the last one in a folder of them.

    Args:
        place: The archive, or the folder that `fx-membrane patterns` fills.

    Returns:
        None if it is another file or folder.

    Raises:
        ValueError: The archive cannot be opened.
    """
    names = (PROOF_FILE, PATTERN_FILE) if place.is_dir() else ("",)
    files = [place / name for name in names if (place / name).is_file()]
    if not files or origin_of(files[0]).get("holds") not in KINDS:
        return None
    found: Strips | CuttingPattern | PatternProof = load_results(files[0])
    return found


def pattern_text(found: Strips | CuttingPattern | PatternProof) -> str:
    """Table of a proof, of the cloth of a pattern, or of strips."""
    if isinstance(found, PatternProof):
        return text(found)
    strips = found.strips if isinstance(found, CuttingPattern) else found
    unit = strips.length_unit
    wide = max(12, *(len(name) + 1 for name in strips.names))
    kinds = counted(sum(edge.is_seam for edge in strips.edges), "seam")
    head = f"{counted(len(strips.names), 'strip')}, {len(strips.names) - len(strips.copies)} of unlike shape, {kinds}"
    if not isinstance(found, CuttingPattern):
        rows = [
            f"{name:<{wide}}{len(strips.membrane(name).cells):>7}  {_likeness(strips, name)}" for name in strips.names
        ]
        return "\n".join([f"Strips: {head}", f"{'strip':<{wide}}{'cells':>7}", *(row.rstrip() for row in rows)])
    lines = [
        f"Cutting pattern: {head}",
        f"Cloth without allowances [{unit}, {unit}2], compensation along warp and weft [%]",
        f"{'strip':<{wide}}{'length':>9}{'width':>9}{'area':>10}{'warp':>8}{'weft':>8}",
    ]
    for name, cloth in found.cloth.items():
        warp, weft = (100 * (1 - ratio) for ratio in found.compensation[name])
        sizes = f"{cloth.length:>9.4g}{cloth.width:>9.4g}{cloth.area:>10.4g}"
        lines.append(f"{name:<{wide}}{sizes}{warp:>8.3f}{weft:>8.3f}  {_likeness(strips, name)}".rstrip())
    return "\n".join(lines)


def _likeness(strips: Strips, name: str) -> str:
    """Strip that is cut for a copy."""
    turned = ", turned over" if name in strips.mirrored else ""
    return f"as {strips.copies[name]}{turned}" if name in strips.copies else ""


def assembly(proof: PatternProof) -> StageResults:
    """Equilibrium of a proof as the results of its one stage, for reports and scenes."""
    stage = Stage(proof.state.name, proof.loads, changes=proof.changes or ())
    found = StageResults({proof.state.name: proof.state}, [stage])
    strips = proof.pattern.strips
    found.title, found.force_unit, found.length_unit = "Assembly of strips", strips.force_unit, strips.length_unit
    return found


def proof_at(place: Path) -> PatternProof | None:
    """Open an archive of a proof; None if it is another file or folder.

    Raises:
        ValueError: It is an archive of strips or of a pattern without a proof.
    """
    found = pattern_at(place)
    if found is None or isinstance(found, PatternProof):
        return found
    raise ValueError(
        f"{place} holds {'strips' if isinstance(found, Strips) else 'a cutting pattern'} without a proof; "
        "`fx-membrane show` tells of it, and prove_pattern makes the proof that a report needs."
    )


def scene_of(found: Strips | CuttingPattern | PatternProof) -> StageResults | Structure:
    """Equilibrium of a proof, or the strips on the surface."""
    if isinstance(found, PatternProof):
        return assembly(found)
    return (found.strips if isinstance(found, CuttingPattern) else found).structure
