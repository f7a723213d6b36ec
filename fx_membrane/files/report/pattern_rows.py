"""Chapter on a cutting pattern: rows of strips, and of their proof, as texts."""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ...patterns.proofs import PatternProof
from ...plot.proof_pictures import PICTURES, draw_proof, left_out
from ..patterns.proof_files import read_proof

RMS = "rms tensor error"


def pattern_chapter(source: PatternProof | Path | None, length: str, pictures: bool = True) -> dict[str, Any] | None:
    """Values of the chapter; None without a proof.

    Args:
        source: A proof, or the folder of a cutting pattern.
        length: Name of the length unit.
        pictures: Draw a proof; those in a folder are there.

    Raises:
        ValueError: The proof in the folder cannot be read.
    """
    if source is None:
        return None
    proof = source.to_dict() if isinstance(source, PatternProof) else read_proof(source)
    if not proof:
        return None
    return {
        "sentence": " ".join(filter(None, (_sentence(proof, length), _fit(proof.get("nearest stress"))))),
        "remarks": proof["remarks"],
        "left_out": " ".join(left_out(proof)),
        "strips": [_strip(row) for row in proof["strips"]],
        "proof": [_proof(row) for row in proof["strips"]],
        "pictures": list(_drawn(source) if isinstance(source, PatternProof) else _pictures(source)) if pictures else [],
        "used": any(row["utilisation"] is not None for row in proof["strips"]),
        "rolled": proof["roll width"] is not None,
    }


def _sentence(proof: Mapping[str, Any], length: str) -> str:
    """Sentence on the whole proof."""
    place, worst = (
        ", ".join(f"{value:.4g}" for value in proof[f"place of {what}"]) for what in ("largest shift", "stress error")
    )
    mean, rms, largest = (f"{100 * proof[f'{kind}stress error']:.3g} %" for kind in ("mean ", "rms ", ""))
    return (
        f"The cloth of {len(proof['strips'])} strips, sewn together, is in equilibrium with a shift of at most "
        f"{proof['largest shift']:.3g} {length}, at ({place}). Its stress differs from that of the design, over "
        f"the mean of the latter, by {mean} on average. The root mean square is {rms}, the largest difference "
        f"{largest}: in {proof['strip of stress error']}, cell {proof['cell of stress error']}, at ({worst}). "
        f"Both sides of seams differ by {proof['seam difference']:.1g} of their length."
    )


def _fit(fit: Mapping[str, Any] | None) -> str:
    """Sentences on outlines that were moved towards the nearest stress; empty without."""
    if fit is None:
        return ""
    end = "" if fit["converged"] else f" The search ended early: {fit['remark'].rstrip('.')}."
    return (
        f"Its outlines were moved towards the stress of the design. The root mean square error of the stress tensor, "
        f"with shear, fell from {100 * fit['before'][RMS]:.3g} % to {100 * fit['after'][RMS]:.3g} % of the mean "
        "stress: by "
        f"{100 * fit['gain at borders']:.3g} % at borders, by {100 * fit['gain within']:.3g} % within.{end}"
    )


def _strip(row: Mapping[str, Any]) -> dict[str, str]:
    return {
        "name": row["strip"],
        "length": f"{row['length']:.4g}",
        "width": f"{row['width']:.4g}",
        "area": f"{row['area']:.4g}",
        "cloth": f"{row['area of cloth']:.4g}",
        "compensation": " / ".join(f"{100 * (1 - row[f'compensation {way}']):.2f}" for way in ("warp", "weft")),
        "distortion": " to ".join(f"{100 * (row[f'{end} distortion'] - 1):.2f}" for end in ("least", "largest")),
        "widest": "any" if row["widest"] is None else f"{row['widest']:.4g}",
        "roll": {True: "yes", False: "no", None: ""}[row["fits roll"]],
    }


def _proof(row: Mapping[str, Any]) -> dict[str, str]:
    found = {
        way: " / ".join(f"{row[f'{way} {entry}']:.4g}" for entry in ("least", "mean", "largest"))
        for way in ("warp", "weft")
    }
    place = ", ".join(f"{value:.3g}" for value in row["place of stress error"])
    return {
        "name": row["strip"],
        "warp_wanted": f"{row['warp wanted']:.4g}",
        "warp": found["warp"],
        "weft_wanted": f"{row['weft wanted']:.4g}",
        "weft": found["weft"],
        "error": " / ".join(f"{100 * row[f'{kind}stress error']:.3g}" for kind in ("mean ", "rms ", "")),
        "at": f"{row['cell of stress error']} at ({place})",
        "utilisation": "" if row["utilisation"] is None else f"{row['utilisation']:.2f}",
    }


def _drawn(proof: PatternProof) -> list[dict[str, str]]:
    """Pictures of a proof, drawn for the report."""
    with tempfile.TemporaryDirectory(prefix="fx_membrane-") as folder:
        draw_proof(proof, Path(folder))
        return list(_pictures(Path(folder)))


def _pictures(folder: Path) -> Iterator[dict[str, str]]:
    for name, words in PICTURES.items():
        if (folder / name).is_file():
            data = base64.b64encode((folder / name).read_bytes()).decode()
            yield {"data": f"data:image/png;base64,{data}", "words": words}
