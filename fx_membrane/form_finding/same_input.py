"""Input of form finding that is the same on all processes, functions of place included."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mpi4py import MPI

from ..model.digests import fingerprint, fingerprints, of_settings
from ..model.ropes import refuse_ropes
from ..model.structure import Structure
from ..runtime.processes import refuse_differences
from .wishes import SurfaceDirection


def refuse_different_input(
    structure: Structure, settings: Mapping[str, Any], fields: Mapping[str, Mapping[str, Any] | None]
) -> None:
    """Refuse ropes, and a structure, settings, or functions of place that differ between processes, on all of them.

    Args:
        structure: The structure.
        settings: Settings and loads by name.
        fields: Functions of place by part, by their name; they are compared by their values at the centres of cells.

    Raises:
        ValueError: They differ; a part is a rope.
    """
    refuse_ropes("Form finding", structure)

    def digests() -> dict[str, str]:
        found = fingerprints(structure) | of_settings(settings)
        for what, by_part in fields.items():
            for name, field in (by_part or {}).items():
                cells = structure.parts[name].cells
                if isinstance(field, SurfaceDirection):
                    values = field.vectors(name, structure.points, cells)
                else:
                    values = field(structure.points[cells].mean(axis=1).T)
                found[f"{what} of part {name!r}, as a function of place"] = fingerprint(values)
        return found

    refuse_differences(MPI.COMM_WORLD, digests)
