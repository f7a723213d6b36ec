"""Warnings of forms that have not settled."""

from __future__ import annotations

import warnings

from .balance.constrained_balance import continued


class UnsettledFormWarning(UserWarning):
    """Form that has not settled in the steps allowed: it is in equilibrium, but not with the stress prescribed."""


def warn_of_doubt(doubt: str, stacklevel: int, carried: str = "stress") -> None:
    """Warn of a doubt about a form in equilibrium with the stress, or forces, that it carries; not of an empty one."""
    if doubt:
        warnings.warn(
            f"The form is in equilibrium with the {carried} that it carries, but {continued(doubt)}",
            UnsettledFormWarning,
            stacklevel=stacklevel + 1,
        )
