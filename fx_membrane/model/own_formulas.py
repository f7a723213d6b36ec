"""Formulas of a user, methods that return UFL, called on trial; their faults as sentences."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, NoReturn

import ufl

from ..checks.calls import parameters_of, takes
from ..checks.values import short_repr

NUMERIC = ("ufunc", "real number", "__float__", "evaluated as bool", "symbol without a value")  # in errors of UFL


class UnfitError(ValueError):
    """Formula that fails, or returns no scalar in UFL.

    Attributes:
        call: The method and its arguments.
        words: The fault and its remedy.
    """

    def __init__(self, call: str, words: str):
        super().__init__(f"{call} {words}")
        self.call, self.words = call, words


class _Valueless:
    """Symbol that refuses to be a number.

    UFL's own symbols call each other without end when Python asks for their value.
    """

    def __float__(self) -> float:
        _refuse()

    def __complex__(self) -> complex:
        _refuse()

    def ufl_evaluate(self, *_: Any) -> float:
        """Refuse: UFL asks for the value of a symbol in an expression."""
        _refuse()


def _refuse() -> NoReturn:
    raise TypeError("a symbol without a value is taken for a number")


class Constant(_Valueless, ufl.Constant):
    """Constant of a trial."""


class Coefficient(_Valueless, ufl.Coefficient):
    """Coefficient of a trial."""


class TestFunction(_Valueless, ufl.Argument):
    """Test function of a trial."""

    __test__ = False  # it is no class of pytest

    def __init__(self, space: Any):
        super().__init__(space, 0)


def called(method: Callable[..., Any], call: str, arguments: tuple[Any, ...], symbols: str) -> Any:
    """Call a method.

    Args:
        method: The method.
        call: The method and its arguments, as "energy(E, sigma0, parameters)".
        arguments: The arguments.
        symbols: Sentence on the arguments, for a message.

    Raises:
        UnfitError: It takes other arguments, or fails.
    """
    if not takes(method, len(arguments)):
        name, rest = call.split("(")
        raise UnfitError(name, f"takes ({parameters_of(method)}); let it take ({rest}")
    try:
        with _quiet():
            return method(*arguments)
    except Exception as error:
        numeric = any(words in str(error) for words in NUMERIC)
        remedy = (
            "take ufl.sqrt, ufl.exp, ufl.conditional ... in the place of NumPy's functions, math, if, max and float"
            if numeric
            else f"mend it: {symbols}"
        )
        raise UnfitError(call, f"raises {type(error).__name__}: {str(error).rstrip('.')}; {remedy}") from error


def scalar(
    method: Callable[..., Any], call: str, arguments: tuple[Any, ...], symbols: str, example: str
) -> ufl.core.expr.Expr:
    """Call a method that returns a scalar in UFL.

    Args:
        method: The method.
        call: The method and its arguments, as "energy(E, sigma0, parameters)".
        arguments: The arguments.
        symbols: Sentence on the arguments, for a message.
        example: Scalar in UFL, for a message.

    Raises:
        UnfitError: It takes other arguments, fails, or returns something else.
    """
    found = called(method, call, arguments, symbols)
    if not isinstance(found, ufl.core.expr.Expr) or found.ufl_shape or found.ufl_free_indices:
        raise UnfitError(call, f"returns {described(found)}; return a scalar in UFL without dx, as {example}")
    return found


def described(value: Any) -> str:
    """Show a value in a message, one of UFL by its kind and shape."""
    if isinstance(value, ufl.Form):
        return "an integral"
    if not isinstance(value, ufl.core.expr.Expr):
        return short_repr(value)
    if value.ufl_free_indices:
        return "an expression with free indices"
    if value.ufl_shape:
        return f"a {'vector' if len(value.ufl_shape) == 1 else 'tensor'} of shape {value.ufl_shape}"
    return "a scalar in UFL"


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence UFL, which prints what it raises."""
    logger = logging.getLogger("UFL")
    level = logger.level
    logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        logger.setLevel(level)
