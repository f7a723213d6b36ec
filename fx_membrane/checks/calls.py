"""Arguments that functions of a user take."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

from .values import short_repr


def takes(function: Callable[..., Any], count: int) -> bool:
    """Return True if a function can be called with so many arguments."""
    try:
        inspect.signature(function).bind(*range(count))
    except TypeError:
        return False
    except ValueError:  # without a signature, as of C
        return True
    return True


def parameters_of(function: Callable[..., Any]) -> str:
    """Names of the arguments of a function, in a message."""
    return ", ".join(
        str(entry.replace(annotation=inspect.Parameter.empty))
        for entry in inspect.signature(function).parameters.values()
    )


def unfit(value: Any, *counts: int) -> str:
    """Show what is no function of so many arguments in a message; empty if it is one."""
    if not callable(value):
        return short_repr(value)
    return "" if any(takes(value, count) for count in counts) else f"a function of ({parameters_of(value)})"
