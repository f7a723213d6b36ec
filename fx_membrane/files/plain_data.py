"""Plain data as JSON and arrays, and back: numbers, texts, arrays, containers, and dataclasses of known names.

Reading makes objects of the classes given, by their constructors, which check their values. It runs no other code.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from enum import Enum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..results.told_states import Remark

Array = NDArray[Any]


class Encoder:
    """Encoder of plain data; an object or array that occurs twice is kept once.

    Args:
        classes: The known classes by name.

    Attributes:
        arrays: The arrays met, by name.
        objects: The encoded objects met, each after those that it holds.
    """

    def __init__(self, classes: Mapping[str, type]):
        self.arrays: dict[str, Array] = {}
        self.objects: list[Any] = []
        self._classes = classes
        self._numbers: dict[int, tuple[Any, Any]] = {}  # by identity; the object is kept, so that it stays its own

    def __call__(self, value: Any) -> Any:
        """Encode a value.

        Raises:
            ValueError: It, or a value in it, is no plain data.
        """
        if value is None or type(value) in (bool, int, float, str):
            return value
        if isinstance(value, np.generic):
            return self(value.item())
        known = self._numbers.get(id(value))
        if known is None:
            known = self._numbers[id(value)] = value, self._encoded(value)
        return known[1]

    def _encoded(self, value: Any) -> Any:
        if isinstance(value, np.ndarray) and value.dtype.kind in "biufU":
            name = f"array{len(self.arrays)}"
            self.arrays[name] = value
            return {"array": name}
        if isinstance(value, Enum):
            return {"enum": [type(value).__name__, value.name]}
        if isinstance(value, Remark):
            return {"remark": [str(value), value.category.__name__]}
        if dataclasses.is_dataclass(value) or hasattr(value, "_asdict"):
            name = type(value).__name__
            if self._classes.get(name, type(value)) is not type(value):
                raise ValueError(f"A class of your own is named {name}, like one of the package; give it another name.")
            fields = {name: self(content) for name, content in _fields(value).items()}
            self.objects.append({"class": name, "fields": fields})
            return {"object": len(self.objects) - 1}
        if type(value) in (list, tuple, frozenset):
            entries = sorted(value) if isinstance(value, frozenset) else value  # equal sets give equal files
            return {type(value).__name__: [self(entry) for entry in entries]}
        if isinstance(value, Mapping) and all(isinstance(key, str) for key in value):
            return {"mapping": {key: self(entry) for key, entry in value.items()}}
        raise ValueError(
            f"A {type(value).__name__} cannot be saved as plain data; make its class a dataclass of numbers, texts and "
            "arrays."
        )


class Decoder:
    """Decoder of what an `Encoder` wrote.

    Args:
        classes: The known classes by name.
        arrays: The arrays by name.
        objects: The encoded objects.
        grown: Those of the classes whose fields are None where the file has none: an earlier version wrote it.
    """

    def __init__(
        self,
        classes: Mapping[str, type],
        arrays: Mapping[str, Array],
        objects: Sequence[Any],
        grown: Sequence[type] = (),
    ):
        self._classes, self._arrays, self._grown = classes, arrays, grown
        self._objects: list[Any] = []
        self._makers: dict[str, Callable[[Any], Any]] = {
            "array": lambda name: self._arrays[name],
            "object": lambda number: self._objects[number],
            "enum": lambda names: getattr(self._classes[names[0]], names[1]),
            "remark": lambda words: Remark(words[0], self._classes[words[1]]),
            "mapping": lambda entries: {key: self(entry) for key, entry in entries.items()},
            "list": lambda entries: [self(entry) for entry in entries],
            "tuple": lambda entries: tuple(map(self, entries)),
            "frozenset": lambda entries: frozenset(map(self, entries)),
        }
        for entry in objects:
            self._objects.append(self._made(entry))

    def __call__(self, code: Any) -> Any:
        """Decode a value.

        Raises:
            ValueError, IndexError, KeyError, TypeError, AttributeError: It is no code of an `Encoder`.
        """
        if not isinstance(code, dict):
            return code
        ((kind, content),) = code.items()
        return self._makers[kind](content)

    def _made(self, entry: Mapping[str, Any]) -> Any:
        name = entry["class"]
        cls = self._classes[name]
        fields = {key: self(code) for key, code in entry["fields"].items()}
        every, needed = _constructor(cls)
        strange = [key for key in fields if key not in every]
        if strange:
            raise ValueError(f"its {name} has a field {strange[0]!r}, which the {name} of this program does not have")
        missing = [key for key in needed if key not in fields]
        if missing and cls not in self._grown:
            raise ValueError(f"its {name} has no field {missing[0]!r}, which the {name} of this program has")
        try:
            return cls(**fields, **dict.fromkeys(missing))
        except Exception as error:  # a class of a user may raise any
            raise ValueError(f"its {name} is refused: {str(error).rstrip('.')}") from error


def _constructor(cls: Any) -> tuple[list[str], list[str]]:
    """Names that the constructor of a dataclass or a named tuple takes, and those that it needs."""
    if not dataclasses.is_dataclass(cls):
        return list(cls._fields), [name for name in cls._fields if name not in cls._field_defaults]
    entries = [entry for entry in dataclasses.fields(cls) if entry.init]
    unset = dataclasses.MISSING
    return [entry.name for entry in entries], [
        entry.name for entry in entries if entry.default is unset and entry.default_factory is unset
    ]


def _fields(value: Any) -> dict[str, Any]:
    """Fields of a dataclass or a named tuple that its constructor takes; an owner stays with its process."""
    if not dataclasses.is_dataclass(value):
        return dict(value._asdict())
    names = [entry.name for entry in dataclasses.fields(value) if entry.init and entry.name != "owner"]
    return {name: getattr(value, name) for name in names}
