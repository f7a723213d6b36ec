"""Objects of the package from the values of a table: each key with a fault is told apart."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from .faults import Faults, Unknown
from .table import is_whole


def make(
    faults: Faults,
    trail: tuple[str | int, ...],
    maker: Callable[..., Any],
    values: Mapping[str, Any],
    sound: Mapping[str, Any],
    names: Mapping[str, str] | None = None,
) -> Any:
    """Make an object; where that fails, try each value alone among sound ones, so that all faults are found.

    Args:
        faults: Faults found so far, to which those of single keys are added.
        trail: Path of the table.
        maker: Class or function.
        values: Its arguments; those that are not whole have a fault already.
        sound: Arguments with which it can be called; all that it needs.
        names: Keys of the file for arguments of another name; empty for none.

    Raises:
        ValueError: The values do not fit together.
        Unknown: Some of them have a fault.
    """
    known = {key: value for key, value in values.items() if is_whole(value)}
    if len(known) == len(values):
        try:
            return maker(**values)
        except (ValueError, TypeError) as error:
            told = error
    for key in sound.keys() & known.keys():
        if sound[key] is known[key]:  # it is to be sound, so that the others can be tried with it
            count = len(faults)
            with faults.at(*trail, *filter(None, [(names or {}).get(key, key)])):
                maker(**sound)
            if len(faults) > count:
                raise Unknown
    good = dict[str, Any]()
    for key, value in known.items():
        with faults.at(*trail, *filter(None, [(names or {}).get(key, key)])):
            maker(**{**sound, key: value})
            good[key] = value
    if len(good) == len(values):
        raise told
    mended = good | {key: value for key, value in sound.items() if key in values and key not in good}
    with faults.at(*trail):
        maker(**{**{key: sound[key] for key in sound if key not in values}, **mended})
    raise Unknown
