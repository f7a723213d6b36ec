"""Classes of a user for laws and energy terms: frozen dataclasses with a formula of their own."""

from __future__ import annotations

from collections.abc import Sequence


def home(kind: type, name: str) -> type | None:
    """Class that defines a member, in the order of inheritance; protocols define none."""
    own = (base for base in kind.__mro__ if not getattr(base, "_is_protocol", False))
    return next((base for base in own if name in vars(base)), None)


def check(named: str, kind: type, methods: Sequence[str], noun: str) -> None:
    """Refuse a class that inherits its formula, and one that is no frozen dataclass.

    A class that adds or changes something else would be computed by the formula of its parent.

    Args:
        named: Beginning of the sentence, "terms has a Bed".
        kind: The class.
        methods: Names of the formulas, of which it has one.
        noun: Word for its instances, "law".

    Raises:
        ValueError: It breaks one of these rules.
    """
    for method in methods:
        parent = home(kind, method)
        if parent is not None and parent is not kind:
            raise ValueError(
                f"{named}, a class derived from {parent.__name__}, whose {method} would be used; define {method} in "
                f"{kind.__name__} ({method} = {parent.__name__}.{method} if that is meant)."
            )
    settings = getattr(kind, "__dataclass_params__", None)
    if settings is None or not settings.frozen or "__dataclass_fields__" not in vars(kind):
        raise ValueError(
            f"{named}, whose class is no frozen dataclass; write @dataclass(frozen=True) before it: its fields are "
            f"the parameters of the {noun}."
        )
