"""Saving the state of an analysis after each increment, and taking it up again.

The file is a NumPy archive: displacements as arrays, all else as JSON. It is written to a temporary name and renamed,
so that a process killed while it writes leaves the previous state.
"""

import dataclasses
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from .geometry import from_smallest
from .loads import Stage
from .results import Increment
from .solver import Iteration
from .structure import Structure


@dataclasses.dataclass(frozen=True, eq=False)
class Progress:
    """How far a stage has come.

    Attributes:
        displacement: The last converged state, shape (n, 3) [m].
        factor: Its load factor; 1 when the stage is complete.
        size: Load factor of the increment to try next.
        increments: The converged increments.
    """

    displacement: NDArray[np.float64]
    factor: Fraction
    size: Fraction
    increments: tuple[Increment, ...]


def save(path: Path, structure: Structure, stages: Sequence[Stage], progress: Mapping[str, Progress]) -> None:
    """Writes the progress of the stages that have begun; those in the file that are not in the list stay in it."""
    digests = {stage.name: fingerprints(stage) for stage in stages if stage.name in progress}
    if progress.keys() > digests.keys():
        digests = _read(path)[0]["stages"] | digests
    entries = {
        name: {
            "factor": str(state.factor),
            "size": str(state.size),
            "increments": [list(increment) for increment in state.increments],
        }
        for name, state in progress.items()
    }
    document = {
        "structure": fingerprints(structure),
        "stages": digests,
        "progress": entries,
    }
    arrays = {f"displacement of {name}": state.displacement for name, state in progress.items()}
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(path.name + ".part")
    with temporary.open("wb") as file:
        np.savez(file, document=np.array(json.dumps(document)), **arrays)
        file.flush()
        os.fsync(file.fileno())
    temporary.replace(path)


def load(path: Path, structure: Structure, stages: Sequence[Stage]) -> dict[str, Progress]:
    """Progress of the stages that had begun; none where there is no file.

    Stages that are not in the list come too. One whose `steps` have changed goes on in increments of the new length.

    Raises:
        ValueError: The file is not a checkpoint, or that of another structure or of other stages.
    """
    if not path.exists():
        return {}
    document, displacements = _read(path)
    _refuse_if_changed(f"The checkpoint {path} is of another structure", document["structure"], fingerprints(structure))
    longest = {stage.name: Fraction(1, stage.steps) for stage in stages}
    for stage in stages:
        if stage.name in document["stages"]:
            what = f"The checkpoint {path} has another stage {stage.name!r}"
            _refuse_if_changed(what, document["stages"][stage.name], fingerprints(stage))
    return {
        name: Progress(
            displacement=displacements[name],
            factor=Fraction(entry["factor"]),
            size=min(Fraction(entry["size"]), longest.get(name, Fraction(1))),
            increments=tuple(
                Increment(factor, tuple(Iteration(*values) for values in iterations), *remarks)
                for factor, iterations, *remarks in entry["increments"]
            ),
        )
        for name, entry in document["progress"].items()
    }


def fingerprints(data: Structure | Stage) -> dict[str, str]:
    """Digests of all that decides the state, by what it is: "points", "prestress of part 'fabric'", "loads" ..."""
    if isinstance(data, Stage):
        return {name: fingerprint(getattr(data, name)) for name in ("loads", "displacements", "after")}
    digests = {"points": fingerprint(data.points), "supports": fingerprint(data.supports)}
    for name, part in data.parts.items():
        digests[f"kind of part {name!r}"] = type(part).__name__
        for entry in dataclasses.fields(part):
            digests[f"{entry.name} of part {name!r}"] = fingerprint(getattr(part, entry.name))
        digests[f"cells of part {name!r}"] = fingerprint(from_smallest(part.cells))
    return digests


def _refuse_if_changed(what: str, stored: dict[str, str], mine: dict[str, str]) -> None:
    changed = [name for name in stored | mine if stored.get(name) != mine.get(name)]
    if changed:
        more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
        raise ValueError(
            f"{what}, which differs in: {', '.join(changed[:3])}{more}; give another name or remove the file."
        )


def _read(path: Path) -> tuple[dict[str, Any], dict[str, NDArray[np.float64]]]:
    """What is in a checkpoint: the document, and the displacements by stage.

    Raises:
        ValueError: The file is not a checkpoint.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            document = json.loads(str(archive["document"]))
            displacements = {name: archive[f"displacement of {name}"] for name in document["progress"]}
        if not isinstance(document["structure"], dict):
            raise TypeError("it is of an earlier version")
    except (OSError, ValueError, KeyError, TypeError, AttributeError, EOFError, BadZipFile) as error:
        raise ValueError(f"{path} is not a checkpoint ({error}); give another name or remove it.") from None
    return document, displacements


def fingerprint(data: Any) -> str:
    """Digest of plain data: dataclasses, mappings, sequences, arrays and scalars."""
    digest = hashlib.sha256()

    def add(value: Any) -> None:
        if dataclasses.is_dataclass(value):
            digest.update(type(value).__name__.encode())
            for entry in dataclasses.fields(value):
                add(getattr(value, entry.name))
        elif isinstance(value, Mapping):
            for key in value:
                add(key)
                add(value[key])
        elif isinstance(value, np.ndarray):
            digest.update(f"{value.dtype.kind}{value.shape}".encode() + np.ascontiguousarray(value).tobytes())
        elif isinstance(value, list | tuple):
            digest.update(f"[{len(value)}]".encode())
            for item in value:
                add(item)
        else:
            digest.update(f"{value!r};".encode())

    add(data)
    return digest.hexdigest()
