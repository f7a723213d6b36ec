"""The file of a checkpoint: an SQLite database with an entry for each stage and for each of its increments.

Writes are atomic, even if the process is killed or the disk runs full. An increment adds its own state and rewrites no
other, and one run at a time has the file. Its journal, PATH-journal, undoes incomplete writes of a killed run. Each
entry has a digest: an entry changed by others is refused.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import os
import sqlite3
from collections.abc import Mapping
from fractions import Fraction
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import quote

import numpy as np
from numpy.typing import NDArray

from ..assembly.gas import ChamberResult
from ..model.water_events import BasinResult, WaterEvent
from ..results.load_increments import Increment
from ..solvers.base import Iteration
from ..solvers.outcome import Outcome

FORMAT = 2  # 1: until 0.1.0, with flags in place of the outcome
MAGIC = b"SQLite format 3\0"
TABLE = "CREATE TABLE entry (key TEXT PRIMARY KEY, document BLOB, displacement BLOB, digest TEXT)"
HEADER = "header"

Digests = Mapping[str, str]


@dataclasses.dataclass(frozen=True, eq=False)
class Progress:
    """Progress of a stage.

    Attributes:
        displacement: The last converged state, shape (n, 3) [m].
        factor: Its load factor; 1 when the stage is complete.
        size: Load factor of the next increment to try.
        increments: The converged increments.
    """

    displacement: NDArray[np.float64]
    factor: Fraction
    size: Fraction
    increments: tuple[Increment, ...]


class Content(NamedTuple):
    """Content of a file.

    Attributes:
        structure: Digests of the structure.
        stages: Digests of each stage begun, by its name.
        progress: Progress of each stage begun, by its name.
    """

    structure: Digests
    stages: dict[str, Digests]
    progress: dict[str, Progress]


class CheckpointFile:
    """Open checkpoint file, locked against other runs.

    Args:
        path: Path of the file; a missing file is created.
        structure: Digests of the structure, for a file that is new or has no stage yet.

    Raises:
        ValueError: The file cannot be written, another run has it open, or it is not a checkpoint.
    """

    def __init__(self, path: Path, structure: Digests):
        self.path, self._structure = path, structure
        self._counts: dict[str, int] = {}  # number of increments in the file, by key of the stage
        try:
            if not path.exists():
                _create(path)
            with path.open("rb") as file:
                start = file.read(len(MAGIC))
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or error
            raise ValueError(f"The checkpoint {path} cannot be written ({reason}); give another place.") from None
        if start != MAGIC:
            older = ": it is a NumPy archive, as earlier versions wrote" if start[:2] == b"PK" else ""
            raise self._no_checkpoint(f"that this version can read{older}")
        self._database = _connect(path)
        try:
            if os.access(path, os.W_OK):
                self._lock()
        except BaseException:
            self._database.close()
            raise

    def close(self) -> None:
        """Release the file for other runs."""
        self._database.close()

    def read(self) -> Content:
        """Return the whole content of the file.

        Raises:
            ValueError: It is not a checkpoint, or was changed.
        """
        try:
            entries = {key: _checked(key, *row) for key, *row in self._database.execute("SELECT * FROM entry")}
            header = entries[HEADER][0]
            if header["format"] != FORMAT:
                raise ValueError(f"of another version: its format is {header['format']}, and this one reads {FORMAT}")
            if header["entries"] != len(entries) - 1:
                raise ValueError(f"it has {len(entries) - 1} entries of {header['entries']}")
            content = Content(header["structure"], {}, {})
            for key, (document, displacement) in entries.items():
                if key.startswith("stage"):
                    name, self._counts[key] = document["name"], document["increments"]
                    increments = [entries[_increment_key(key, i)][0] for i in range(document["increments"])]
                    content.stages[name] = document["digests"]
                    content.progress[name] = _progress(document, displacement, increments)
        except (sqlite3.Error, ValueError, KeyError, TypeError, AttributeError, OverflowError) as error:
            reason = error if isinstance(error, sqlite3.Error | ValueError) else "an entry is missing or damaged"
            raise self._no_checkpoint(f"({reason})") from None
        return content

    def write(self, progress: Mapping[str, Progress], digests: Mapping[str, Digests]) -> None:
        """Write the progress of some stages, all or nothing.

        Raises:
            sqlite3.Error: It could not be written, and the file is unchanged.
        """
        counts = dict(self._counts)
        rows: list[tuple[str, Any, bytes]] = []
        for name, state in progress.items():
            key = _stage_key(name)
            known = counts.get(key, 0)
            for number, increment in enumerate(state.increments[known:], known):
                rows.append((_increment_key(key, number), _record(increment), b""))
            counts[key] = len(state.increments)
            document = {
                "name": name,
                "digests": digests[name],
                "factor": str(state.factor),
                "size": str(state.size),
                "increments": len(state.increments),
            }
            rows.append((key, document, state.displacement.astype("<f8").tobytes()))
        rows.append(_header(self._structure, len(counts) + sum(counts.values())))
        try:
            with self._database:
                self._database.executemany("REPLACE INTO entry VALUES (?, ?, ?, ?)", map(_row, rows))
        finally:
            if self._database.in_transaction:
                self._database.rollback()
        self._counts = counts

    def _lock(self) -> None:
        """Lock the file against other runs, and find at once if it can be written."""
        try:
            self._database.execute("PRAGMA locking_mode = EXCLUSIVE")
            with self._database:
                self._database.execute("BEGIN EXCLUSIVE")
                self._database.execute("UPDATE entry SET key = key WHERE key = ?", (HEADER,))
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode == sqlite3.SQLITE_BUSY:
                raise ValueError(
                    f"The checkpoint {self.path} is in use by another run; give this one another name, or wait until "
                    "that has ended."
                ) from None
            if error.sqlite_errorcode != sqlite3.SQLITE_ERROR:  # a file without our table
                raise ValueError(
                    f"The checkpoint {self.path} cannot be written ({error}); make room, or give another place."
                ) from None
            raise self._no_checkpoint(f"({error})") from None
        except sqlite3.Error as error:
            raise self._no_checkpoint(f"({error})") from None

    def _no_checkpoint(self, why: str) -> ValueError:
        return ValueError(f"{self.path} is not a checkpoint {why}; give another name or remove it.")


def _create(path: Path) -> None:
    """Create a file without stages, atomically; keep one that another run has created meanwhile."""
    with sqlite3.connect(":memory:") as database:
        database.execute(TABLE)
        database.execute("INSERT INTO entry VALUES (?, ?, ?, ?)", _row(_header({}, 0)))
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    try:
        with part.open("wb") as file:
            file.write(database.serialize())
            file.flush()
            os.fsync(file.fileno())
        try:
            os.link(part, path)
        except FileExistsError:
            pass
        except OSError:  # file systems without links
            part.rename(path)
    finally:
        part.unlink(missing_ok=True)


def _connect(path: Path) -> sqlite3.Connection:
    """Connect to an existing file, without waiting for others."""
    mode = "rw" if os.access(path, os.W_OK) else "ro"
    address = f"file:{quote(os.fsencode(path.absolute()))}?mode={mode}"
    return sqlite3.connect(address, uri=True, timeout=0)


def _stage_key(name: str) -> str:
    """Key of a stage name, independent of its length."""
    return "stage " + hashlib.sha256(name.encode(errors="surrogatepass")).hexdigest()


def _increment_key(stage_key: str, number: int) -> str:
    return f"increment {number} of {stage_key}"


def _header(structure: Digests, entries: int) -> tuple[str, Any, bytes]:
    return HEADER, {"format": FORMAT, "structure": structure, "entries": entries}, b""


def _row(entry: tuple[str, Any, bytes]) -> tuple[str, bytes, bytes, str]:
    key, document, displacement = entry
    text = json.dumps(document).encode()
    return key, text, displacement, _digest(key, text, displacement)


def _digest(key: str, document: bytes, displacement: bytes) -> str:
    return hashlib.sha256(b"%s;%d;%s%s" % (key.encode(), len(document), document, displacement)).hexdigest()


def _checked(key: str, document: bytes, displacement: bytes, digest: str) -> tuple[Any, bytes]:
    """Return an entry that matches its digest."""
    if _digest(key, document, displacement) != digest:
        raise ValueError(f"it was changed: {key.rpartition(' ')[0] or key}")  # without the digest of the name
    return json.loads(document), displacement


def _record(increment: Increment) -> dict[str, Any]:
    record = increment._asdict() | {
        "outcome": increment.outcome.name,
        "iterations": [entry._asdict() for entry in increment.iterations],
        "chambers": {name: found._asdict() for name, found in increment.chambers.items()},
        "basins": [found._asdict() for found in increment.basins],
        "events": [found._asdict() for found in increment.events],
    }
    for name in ("chambers", "basins", "events"):
        if not record[name]:  # as earlier versions wrote it, and read it
            del record[name]
    return record


def _progress(document: dict[str, Any], displacement: bytes, increments: list[dict[str, Any]]) -> Progress:
    return Progress(
        np.frombuffer(displacement, "<f8").reshape(-1, 3).astype(np.float64),
        Fraction(document["factor"]),
        Fraction(document["size"]),
        tuple(map(_increment, increments)),
    )


def _increment(record: dict[str, Any]) -> Increment:
    iterations = tuple(Iteration(**entry) for entry in record["iterations"])
    chambers = {name: ChamberResult(**found) for name, found in record.get("chambers", {}).items()}
    basins = tuple(BasinResult(**found) for found in record.get("basins", ()))
    events = tuple(WaterEvent(**found | {"place": tuple(found["place"])}) for found in record.get("events", ()))
    made = {"outcome": Outcome[record["outcome"]], "iterations": iterations, "chambers": chambers}
    made |= {"basins": basins, "events": events}
    return Increment(**record | made)
