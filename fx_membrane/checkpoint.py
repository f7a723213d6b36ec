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
    """Writes the progress of the stages that have begun."""
    entries = {
        name: {
            "factor": str(state.factor),
            "size": str(state.size),
            "increments": [[increment.load_factor, increment.iterations] for increment in state.increments],
        }
        for name, state in progress.items()
    }
    document = {
        "structure": fingerprint(structure),
        "stages": {stage.name: fingerprint(stage) for stage in stages if stage.name in progress},
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

    Raises:
        ValueError: The file is not a checkpoint, or that of another structure or of other stages.
    """
    if not path.exists():
        return {}
    try:
        with np.load(path, allow_pickle=False) as archive:
            document = json.loads(str(archive["document"]))
            displacements = {name: archive[f"displacement of {name}"] for name in document["progress"]}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, EOFError, BadZipFile) as error:
        raise ValueError(f"{path} is not a checkpoint ({error}); give another name or remove it.") from None
    if document["structure"] != fingerprint(structure):
        raise ValueError(f"The checkpoint {path} is of another structure; give another name or remove it.")
    known = {stage.name: fingerprint(stage) for stage in stages}
    for name, stored in document["stages"].items():
        if known.get(name) != stored:
            raise ValueError(f"The checkpoint {path} has another stage {name!r}; give another name or remove it.")
    return {
        name: Progress(
            displacement=displacements[name],
            factor=Fraction(entry["factor"]),
            size=Fraction(entry["size"]),
            increments=tuple(
                Increment(factor, tuple(Iteration(*values) for values in iterations))
                for factor, iterations in entry["increments"]
            ),
        )
        for name, entry in document["progress"].items()
    }


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
