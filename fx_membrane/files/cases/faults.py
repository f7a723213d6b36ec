"""Faults of a case file, all at once, each with its line, its key and a remedy."""

from __future__ import annotations

import difflib
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from ...checks.values import counted, short_repr
from .lines import line_of
from .wording import in_words_of_files

OTHER_NAMES = {  # of keys and kinds
    "EA": "axial_stiffness",
    "type": "kind",
    "gmsh": "file",
    "mesh": "file",
    "msh": "file",
    "rope": "cable",
    "strut": "mast",
    "fabric": "membrane",
    "isotropic": "fabric",
    "orthotropic": "woven",
    "snow": "plan",
    "wind": "pressure",
    "self-weight": "area",
    "force": "point",
    "soap film": "updated reference",
    "remeshed": "new mesh",
    "masts": "masts and stays",
}
HINTS = {  # for keys that have no like
    **dict.fromkeys(("colour", "color", "colours", "colors"), 'choose quantities, as pictures = ["displacement"]'),
    **dict.fromkeys(
        ("utilisation", "utilization"), "it is computed for the parts that limits.stress and limits.force name"
    ),
}
BARE = re.compile(r"[A-Za-z0-9_-]+")


ASKED = {  # by the type of an error of pydantic
    "int_type": "a whole number (an integer)",
    "int_from_float": "a whole number (an integer)",
    "int_parsing": "a whole number (an integer), without quotes",
    "bool_type": "true or false",
    "bool_parsing": "true or false, without quotes",
    "string_type": "a text, in quotes",
    "list_type": "a list, in []",
    "tuple_type": "a list, in []",
    "dict_type": "a table, in {}",
    "model_type": "a table, in {}",
    "model_attributes_type": "a table, in {}",
}


class Fault(NamedTuple):
    """Fault of a case file.

    Attributes:
        path: Keys and rows from the top of the file.
        words: What is wrong, and the remedy.
        missing: True if a key is not there.
    """

    path: tuple[str | int, ...]
    words: str
    missing: bool = False


class Wrong(ValueError):  # noqa: N818  (a fault, kept as one)
    """Fault of one key of a table.

    Attributes:
        keys: The key, and those below it, from the table.
    """

    def __init__(self, words: str, *keys: str | int):
        super().__init__(words)
        self.keys = keys
        self.others: Sequence[Wrong] = ()

    def beside(self, others: Sequence[Wrong]) -> Wrong:
        """Add others of the same table."""
        self.others = others
        return self


@contextmanager
def at_key(*keys: str | int) -> Iterator[None]:
    """Name the key of an error."""
    try:
        yield
    except ValueError as error:
        raise Wrong(str(error), *keys) from None


class Unknown(Exception):  # noqa: N818  (no error of its own: the other table has one)
    """An object depends on a table that has a fault, so that nothing can be said about it."""


class Faults(list[Fault]):
    """Faults found so far."""

    @contextmanager
    def at(self, *trail: str | int) -> Iterator[None]:
        """Keep an error of the package as a fault of a table."""
        try:
            yield
        except Unknown:
            pass
        except (ValueError, TypeError, OSError, ImportError) as error:
            for entry in (error, *getattr(error, "others", ())):
                self.append(Fault((*trail, *getattr(entry, "keys", ())), in_words_of_files(str(entry))))


class CaseError(ValueError):
    """Faults of a case file: one line for each, `file:line: key path: value, remedy`.

    Attributes:
        lines: The lines of the message.
    """

    def __init__(self, lines: Sequence[str]):
        super().__init__("\n".join(lines))
        self.lines = tuple(lines)


def case_error(file: Path, text: str, faults: Iterable[Fault]) -> CaseError:
    """Error of some faults, in the order of their lines."""
    found = sorted(((line_of(text, fault.path), fault) for fault in faults), key=lambda entry: entry[0])
    lines = [f"{file}:{line}: {_shown(fault.path)}: {fault.words}" for line, fault in found]
    return CaseError(list(dict.fromkeys(lines)))


def faults_of_validation(
    error: Any, data: Any, keys: Iterable[str], keys_at: Callable[[Any, tuple[str | int, ...]], list[str]]
) -> list[Fault]:
    """Faults of a `pydantic.ValidationError`, in words of ours.

    Args:
        error: The error.
        data: The tables of the file.
        keys: Keys that the schema has anywhere.
        keys_at: Function that gives the keys of one table, of the data and its path.
    """
    known = list(keys)
    return [
        Fault(*_told(entry, data, known, keys_at), entry["type"] in ("missing", "union_tag_not_found"))
        for entry in error.errors(include_url=False)
    ]


def nearest(word: Any, known: Iterable[str]) -> str:
    """Clause that names the nearest known word, or another name of the same; empty if none is near."""
    known = list(known)
    if isinstance(word, str) and OTHER_NAMES.get(word) in known:
        return f"; {OTHER_NAMES[word]!r} may be meant"
    near = difflib.get_close_matches(str(word), [entry for entry in known if entry != word], 1)
    return f"; {near[0]!r} may be meant" if near else ""


def _told(entry: dict[str, Any], data: Any, keys: Sequence[str], keys_at: Any) -> tuple[tuple[str | int, ...], str]:
    path = without_tags(entry["loc"], data, entry["type"] == "missing")
    kind, context = entry["type"], entry.get("ctx", {})
    tag = context.get("discriminator", "").strip("'")
    if kind == "extra_forbidden":
        hint = _hint(path[-1], keys_at(data, path[:-1]), keys, _owner(path, data, keys_at))
        return path, f"there is no key of that name here{hint}"
    if kind == "missing" and isinstance(path[-1], int):  # too few entries
        return path[:-1], f"the list has {counted(path[-1], 'value')}; give {path[-1] + 1}"
    if kind == "missing":
        return path, "the key is missing; add it"
    if kind == "union_tag_not_found":
        return path, f"the key {tag!r} is missing; add it"
    if kind == "union_tag_invalid":
        expected = context["expected_tags"].replace("'", "").split(", ")
        words = f"{context['tag']!r} is not one of {', '.join(map(repr, expected))}"
        return (*path, tag), words + nearest(context["tag"], expected)
    return path, f"{in_words_of_files(short_repr(entry['input']))}: {_asked(entry, context)}"


def _owner(path: tuple[str | int, ...], data: Any, keys_at: Any) -> str:
    """Table that has the last key of a path: the next one around it, or one of the file; empty if none has."""
    around = [path[:count] for count in range(len(path) - 2, 0, -1)]
    beside = [(name,) for name in data if isinstance(data[name], dict)]
    return next((f", {_shown(table)}" for table in [*around, *beside] if path[-1] in keys_at(data, table)), "")


def _hint(key: Any, here: Sequence[str], anywhere: Sequence[str], owner: str) -> str:
    """Clause on a key that a table does not have: another name of one, one that is spelled like it, or its place."""
    if key in HINTS:
        return f"; {HINTS[key]}"
    if key in OTHER_NAMES and OTHER_NAMES[key] in anywhere:
        return nearest(key, anywhere)
    elsewhere = f"; it belongs to another table{owner}" if key in anywhere else "; correct or remove it"
    return nearest(key, here) or elsewhere


def _asked(entry: dict[str, Any], context: dict[str, Any]) -> str:
    """Clause on a value of another kind."""
    kind = entry["type"]
    if kind in ASKED:
        return f"give {ASKED[kind]}"
    if kind == "literal_error":
        known = [word.strip("'") for word in re.split(", | or ", context["expected"])]
        one_of = "one of " if len(known) > 1 else ""
        return f"give {one_of}{context['expected']}{nearest(entry['input'], known)}"
    if kind == "too_long":
        return f"give {counted(context['max_length'], 'value')}, not {context['actual_length']}"
    if kind == "value_error":
        return str(context["error"])
    return f"{entry['msg'][0].lower()}{entry['msg'][1:]}"


def without_tags(loc: Sequence[str | int], data: Any, missing: bool) -> tuple[str | int, ...]:
    """Path in the file: pydantic puts the kind of a union after its key; only a missing key is not in the file."""
    path: list[str | int] = []
    fresh = True  # at a table whose tag has not been passed
    for number, key in enumerate(loc):
        last = number == len(loc) - 1
        if isinstance(data, dict) and fresh and not last and key in (data.get("kind"), data.get("method")):
            fresh = False
            continue
        try:
            data = data[key]
        except (KeyError, IndexError, TypeError):
            if not (last and missing):  # the name of a type
                continue
        path.append(key)
        fresh = True
    return tuple(path)


def _shown(path: Sequence[str | int]) -> str:
    """Path with dots, as keys are written in TOML."""
    return ".".join(str(key) if BARE.fullmatch(str(key)) else json.dumps(key, ensure_ascii=False) for key in path)
