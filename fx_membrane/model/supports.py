"""Supports, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..checks import validation
from .by_value import ByValue


@dataclass(frozen=True, eq=False)
class Support(ByValue):
    """Nodes held at their reference position.

    Args:
        nodes: A node number or several, shape (k,).
        components: The constrained components, some of "xyz".

    Raises:
        ValueError: Nodes are not whole numbers; components are not letters of "xyz".

    Example:
        >>> Support([0, 4, 20, 24]).components
        'xyz'
        >>> Support(range(5), "y").nodes.tolist()
        [0, 1, 2, 3, 4]
    """

    nodes: ArrayLike
    components: str = "xyz"

    def __post_init__(self) -> None:
        validation.store(self, validation.indices, "nodes")
        validation.store(self, validation.letters, "components")
