"""Files of a cutting pattern in its folder, and its proof among them: text, and JSON that reports read."""

from __future__ import annotations

import json
import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

from ...patterns.proof_tables import text
from ...patterns.proofs import PatternProof
from ...plot.proof_pictures import PICTURES
from ...runtime.processes import by_the_first
from ..tables import LONE
from ..whole_file import writing
from .tables_of_strips import sides_file

FOLDER, PROOF, TEXT = "patterns", "proof.json", "proof.txt"
ARCHIVES: tuple[str, str] = ("pattern.fxm", "proof.fxm")
FORMAT = 3  # 1 had neither mean and rms of the stress error nor its place, 2 no remarks
DRAWING, BOOK, TABLE, SHEETS = "patterns.dxf", "patterns.pdf", "strips.csv", "sheets"


@by_the_first
def write_proof(proof: PatternProof, folder: Path) -> None:
    """Write the numbers and the table of a proof in a folder.

    Raises:
        ValueError: A file cannot be written.
    """
    strips = proof.pattern.strips
    units = {"force": strips.force_unit, "length": strips.length_unit}
    data = {"format": FORMAT, "units": units, **proof.to_dict()}
    with writing(folder / PROOF, encoding="utf-8", errors=LONE) as stream:
        json.dump(data, stream, ensure_ascii=False, indent=1)
    with writing(folder / TEXT, encoding="utf-8", errors=LONE) as stream:
        stream.write(text(proof) + "\n")


def drop_proof(folder: Path) -> None:
    """Delete a proof with its pictures, and the archives, of an earlier form."""
    for name in (PROOF, TEXT, *ARCHIVES, *PICTURES):
        (folder / name).unlink(missing_ok=True)


def drop_pattern(folder: Path) -> None:
    """Delete all files of a pattern, and its folder if no others are in it."""
    drop_proof(folder)
    shutil.rmtree(folder / SHEETS, ignore_errors=True)
    for file in (folder / DRAWING, folder / BOOK, folder / TABLE, sides_file(folder / TABLE)):
        file.unlink(missing_ok=True)
    with suppress(OSError):
        folder.rmdir()


def pattern_folder(results: Path) -> Path | None:
    """Folder of the cutting pattern beside the results of a run, a folder or a file; None without a proof."""
    folder = (results if results.is_dir() else results.parent) / FOLDER
    return folder if (folder / PROOF).is_file() else None


def read_proof(folder: Path) -> dict[str, Any] | None:
    """Read the numbers of a proof that was written in a folder; None if there is none.

    Raises:
        ValueError: The file cannot be read.
    """
    file = folder / PROOF
    if not file.is_file():
        return None
    try:
        data: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        known = data["format"] == FORMAT
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(
            f"{file} is no proof of a cutting pattern ({error}); run fx-membrane patterns again."
        ) from None
    if not known:
        raise ValueError(f"{file} is of another version; run fx-membrane patterns again.")
    return data
