"""Values that users give by mistake, by class, the arguments that accept some of them, and faults of refusals."""

import datetime
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from fx_membrane.checks import validation

VALUES: dict[str, list[Any]] = {
    "none": [None],
    "truth": [True, False, np.True_, np.array(True)],
    "truths": [
        np.array([True, False]), [True, False, True], [1.0, True, 0.0], [1, True],
        np.array([1.0, True], dtype=object),
    ],
    "text": ["12", "text", np.str_("north")],
    "texts": [["1", 2.0, 3.0], np.array(["1", 2.0], dtype=object), ("a", "b"), np.array(["1", "2"])],
    "empty text": [""],
    "bad name": ["x\0y", "n" * 5000, "/dev/null/x"],
    "folder name": ["folder/"],
    "bytes": [b"12", bytearray(b"123"), np.bytes_(b"1"), np.array([b"1"])],
    "complex": [1j, 1 + 0j, np.complex128(1), np.array([1.0, 2j, 3.0]), [1.0, 2j, 0.0]],
    "date": [np.datetime64("2020-01-01"), np.timedelta64(5, "s"), np.array([1, 2, 3], "m8[s]"), datetime.timedelta(1)],
    "masked": [
        np.ma.masked, np.ma.array([1.0, 2.0, 3.0], mask=[0, 1, 0]),
        np.ma.array([1, 2], mask=[0, 1]), [1.0, np.ma.masked, 0.0],
    ],
    "not finite": [np.nan, np.inf, -np.inf, np.float32("nan"), Decimal("NaN"), Decimal("Infinity"), [1.0, np.nan, 0.0]],
    "huge": [
        10**400, -(10**5000), Decimal("1e400"), 1e300, -1e300, [10**400, 0, 0],
        np.longdouble("1e4000"), [1e300, 0, 0],
    ],
    "number": [
        Decimal("0.25"), Fraction(1, 4), np.float32(0.25), np.array(0.25),
        np.array(0.25, dtype=object), 0.25, -0.25, 0.0,
    ],
    "whole": [2, 0, -1, np.int8(2), np.uint64(2), np.array(2)],
    "large": [2**70, -(2**70), 2**31, np.uint64(2**64 - 1)],
    "array": [
        [0.25], np.array([0.25]), (0.25, 0.5), [0.25, 0.5, 0.75], np.ones((2, 2)),
        np.ones((2, 3)), [Decimal(1), 0, 0],
    ],
    "rows": [[1], [0, 1], range(2), (0, 1, 2), np.array([1]), np.array([[0, 1], [1, 2]]), [2**70], [-1]],
    "empty": [[], (), np.empty(0, int)],
    "ragged": [[[0, 1], [2]], [[0.0, 1.0], 2.0], np.array([None, 1.0]), [None, 1.0, 2.0], [[1.0], "a"]],
    "object": [object(), int, len, {"a": 1}, {1, 2}, iter([1, 2]), slice(3), np.ones, datetime.date(2020, 1, 1)],
    "empty table": [{}],
    "path": [Path("picture")],
}  # fmt: skip

TAKES = {
    "number": {"number", "whole", "large"},
    "whole": {"whole"},
    "array": {"number", "whole", "large", "array", "rows"},
    "rows": {"whole", "large", "rows"},
    "list of rows": {"whole", "large", "rows", "empty"},
    "list": {"empty"},
    "table": {"empty table"},
    "text": {"text", "empty text", "bad name", "folder name"},
    "truth": {"truth"},
    "path": {"text", "path"},
    "folder": {"text", "path", "folder name"},
    "object": set(),
}


def values(kind):
    """All values, each with True if an argument of a kind accepts it; a kind that ends in ? accepts None."""
    taken = TAKES[kind.rstrip("?")] | ({"none"} if kind.endswith("?") else set())
    return [(value, name in taken) for name, group in VALUES.items() for value in group]


def scalars():
    """Values in the place of a number in an array, each with True if it is right there."""
    groups = (
        "none",
        "truth",
        "text",
        "empty text",
        "bytes",
        "complex",
        "date",
        "masked",
        "not finite",
        "huge",
        "number",
        "whole",
    )
    every = [(value, name in ("number", "whole")) for name in groups for value in VALUES[name]]
    return [
        (value, right)
        for value, right in every
        if not isinstance(value, list) and np.ndim(value) == 0 and value is not None
    ]


ALIASES = {
    "mesh": ("Mesh",), "groups": ("group",), "part": ("No part",),
    "name": ("No M", "No C"), "result": ("first argument",), "Et_warp": ("stiffnesses",), "Et_weft": ("stiffnesses",),
    "points": ("are numbered",), "parts": ("part",), "supports": ("support", "no file"),
    "source": ("file", "gmsh model"), "fields": ("field",), "histories": ("history",), "separate": ("no file",),
    "chambers": ("Chamber",),
}  # fmt: skip


def attempt(function, given, argument, value):
    """Call a function; return its value or the text of its refusal. Any other exception is a fault."""
    try:
        return function(**{**given, argument: value}), None
    except ValueError as refusal:
        words = str(refusal)
        named = any(alias.lower() in words.lower() for alias in (argument, *ALIASES.get(argument, ())))
        assert named, f"the refusal does not name {argument}: {words}"
        assert len(words) > 20, words
        assert words.endswith((".", ")")), words
        return None, words


def faults(function, given, tries):
    """List the faults of some calls, in words."""
    found = []
    for argument, value, allowed in tries:
        shown = f"{argument}={validation.short_repr(value)}"
        try:
            result, refusal = attempt(function, given, argument, value)
        except Exception as error:
            found.append(f"{shown}: {type(error).__name__}: {error!s:.150}")
            continue
        if refusal is None and not allowed:
            found.append(f"{shown} is taken")
        stored = getattr(result, argument, None) if isinstance(function, type) else None
        if stored is not None and value is not None and not kept(stored, value):  # None stands for a default
            found.append(f"{shown} is kept as {stored!r}")
    return found


def kept(stored, value):
    """Return True if a value is stored as plain data, unchanged."""
    if isinstance(stored, dict):
        return stored == value
    if isinstance(stored, tuple | list):
        return list(stored) == list(value)
    if isinstance(stored, np.ndarray):
        plain = type(stored) is np.ndarray and stored.dtype in (np.float64, np.int64) and not stored.flags.writeable
        return plain and bool(np.all(stored == np.asarray(value, dtype=stored.dtype)))
    return type(stored) in (float, int, bool, str, type(None)) and bool(
        stored == np.asarray(value, dtype=object).item()
    )
