"""Digests of structures and stages: equal input has equal digests, in any notation of its numbers."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry.topology import from_smallest
from . import energy_terms, laws, term_parameters
from .materials import is_shipped
from .stages import Stage
from .structure import Structure


def fingerprints(data: Structure | Stage) -> dict[str, str]:
    """Digests of all data that decide the state, by subject: "points", "prestress of part 'fabric'", "loads" ..."""
    if isinstance(data, Stage):
        return {name: fingerprint(getattr(data, name)) for name in ("loads", "displacements", "changes", "after")}
    digests = {"points": fingerprint(data.points), "supports": fingerprint(data.supports)}
    for name, part in data.parts.items():
        digests[f"kind of part {name!r}"] = type(part).__name__
        for entry in dataclasses.fields(part):
            digests[f"{entry.name} of part {name!r}"] = fingerprint(getattr(part, entry.name))
        if not is_shipped(part.material):
            digests[f"energy of part {name!r}"] = fingerprint(laws.energies(part.material, part.dimension))
        digests[f"cells of part {name!r}"] = fingerprint(from_smallest(part.cells))
    if data.terms:
        digests["terms"] = fingerprint(data.terms)
    for name, chamber in data.chambers.items():
        digests[f"chamber {name!r}"] = fingerprint(chamber)
    return digests


def of_stages(stages: Sequence[Stage]) -> dict[str, str]:
    """Digests of all data of a list of stages, its order and `increments` included."""
    digests = {"names of the stages": fingerprint([stage.name for stage in stages])}
    for stage in stages:
        mine = fingerprints(stage) | {"increments": fingerprint(stage.increments)}
        digests |= {f"{name} of stage {stage.name!r}": digest for name, digest in mine.items()}
    return digests


def of_settings(settings: Mapping[str, Any]) -> dict[str, str]:
    """Digest of each entry."""
    return {name: fingerprint(value) for name, value in settings.items()}


def fingerprint(data: Any) -> str:
    """Digest of plain data: dataclasses, mappings, sequences, arrays, scalars; 20 equals 20.0, a list an array."""
    digest = hashlib.sha256()

    def add(value: Any) -> None:
        if dataclasses.is_dataclass(value):
            digest.update(type(value).__name__.encode())
            for entry in dataclasses.fields(value):
                add(getattr(value, entry.name))
            if hasattr(value, "part") and energy_terms.is_term(value):
                add(term_parameters.signature(value))
        elif isinstance(value, Mapping):
            for key in value:
                add(key)
                add(value[key])
        elif (numbers := _numbers(value)) is not None:
            digest.update(f"{numbers.shape}".encode() + numbers.tobytes())
        elif isinstance(value, list | tuple):
            digest.update(f"[{len(value)}]".encode())
            for item in value:
                add(item)
        else:
            digest.update(f"{value!r};".encode(errors="backslashreplace"))

    add(data)
    return digest.hexdigest()


def _numbers(value: Any) -> NDArray[np.float64] | None:
    """Numbers as an array, arrays of booleans too; None for other data."""
    if not isinstance(value, int | float | np.number | np.ndarray | list | tuple) or isinstance(value, bool):
        return None
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different length
        return None
    numeric = array.dtype.kind in ("iufb" if isinstance(value, np.ndarray) else "iuf")
    return array.astype(np.float64) + 0.0 if numeric else None  # -0.0 + 0.0 is 0.0
