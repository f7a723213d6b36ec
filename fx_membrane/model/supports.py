"""Supports, as plain data."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..checks import validation


@dataclass(frozen=True, eq=False)
class Support:
    """Nodes held at their reference position.

    Args:
        nodes: A node number or several, shape (k,).
        components: The constrained components, some of "xyz".

    Raises:
        ValueError: Nodes are not whole numbers; components are not letters of "xyz".
    """

    nodes: ArrayLike
    components: str = "xyz"

    def __post_init__(self) -> None:
        validation.store(self, validation.indices, "nodes")
        validation.store(self, validation.letters, "components")
