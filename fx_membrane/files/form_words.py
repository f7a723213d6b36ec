"""Forms that no stage has followed: where a run leaves them, and their text."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ..form_finding.form import Form
from ..results.plain_numbers import plain
from .archive import load_results
from .run_results import CHECKPOINT, FORM, RESULTS


def form_at(place: Path) -> Form | None:
    """Form of an archive, or of the folder of a run without stages; None if it holds none.

    Args:
        place: The archive, or the folder.

    Raises:
        ValueError: The archive is damaged.
    """
    if place.is_dir() and any((place / name).exists() for name in (RESULTS, CHECKPOINT)):
        return None
    file = place / FORM if place.is_dir() else place
    if not file.is_file() or file.suffix != Path(FORM).suffix:
        return None
    found = load_results(file)
    return found if isinstance(found, Form) else None


def form_text(form: Form) -> str:
    """Table of a form: forces of each part, their largest difference from the wish, and remarks."""
    force, length = form.force_unit, form.length_unit
    lines = [repr(form)]
    for name, values in form.forces.items():
        if values.size:
            unit, quantity = (f"{force}/{length}", "stress") if values.ndim > 1 else (force, "force")
            extent = np.linalg.eigvalsh(values) if values.ndim > 1 else values
            lines.append(
                f"  {name}: {quantity} {plain(extent.min())} to {plain(extent.max())} {unit}, "
                f"at most {100 * form.differences[name].max():.3g} % from the wish"
            )
    lines.append(f"  largest reaction {plain(np.linalg.norm(form.reactions, axis=1).max())} {force}")
    return "\n".join([*lines, *(f"  {remark}" for remark in form.remarks)])
