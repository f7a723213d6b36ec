"""Data that cannot be changed in place, since it was checked when it was given."""

from __future__ import annotations

from typing import Any, NoReturn, TypeVar

import numpy as np

Key = TypeVar("Key")
Value = TypeVar("Value")


class ReadOnlyDict(dict[Key, Value]):
    """Dictionary whose entries were checked when it was made, and stay."""

    def _refuse(self, *_: Any, **__: Any) -> NoReturn:
        raise TypeError(
            f"The entries {list(self)} were checked when their object was made, and are read-only; make a new object "
            "with dataclasses.replace, as replace(structure, parts={**structure.parts, name: part})."
        )

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> Any:
        """Pickle and copy without setting entries one by one."""
        return type(self), (dict(self),)


def read_only(array: Any) -> Any:
    """Return a view of an array that cannot be written to; another object as it is."""
    if not isinstance(array, np.ndarray):
        return array
    view = array.view()
    view.flags.writeable = False
    return view
