"""Ropes: lines that slide over their nodes without friction, with one tension, as plain data checked when created."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.array_entries import equal_rows
from ..geometry.grids import polyline
from ..geometry.sizes import measures
from . import natural_shape
from .axial_law import Axial
from .bars import AxialPart


@dataclass(frozen=True, eq=False)
class Rope(AxialPart):
    """Rope over frictionless nodes: one tension along the whole path, which depends on its length alone.

    It is the edge cable in a pocket, the stay over a mast head, the rope through a ring. Without anything more it is
    free of stress in the reference shape. Give one of `prestress`, `unstressed_length` and `force` for another start.
    Stages change its length (`LengthChange`, `UnstressedLength`), its temperature, or give it a force (`GivenForce`).
    A rope over two nodes is a straight cable.

    Args:
        nodes: Nodes in the order of the path, shape (k,), two at least; the ends are fixed to the rope. A path that
            ends where it begins is a ring.
        axial_stiffness: Young's modulus times cross-section [N]. The law is that of `Axial`, with the Green-Lagrange
            strain of the whole length.
        prestress: Tension in the reference shape [N].
        unstressed_length: Length without stress [m].
        force: Tension in every shape [N]: a weight over a pulley, a jack that follows.
        compression_stiffness: Fraction of the stiffness that a slack rope keeps, in (0, 1] [-].
        mass: Mass per length of the reference shape [kg/m], for `natural_frequencies`. It moves with the nodes.
        natural_stretch: Unstressed length over that in the reference shape, instead of unstressed_length [-].

    Raises:
        ValueError: The path has less than two nodes, visits one twice in a row, or runs twice between the same two; a
            number is not positive; more than one of prestress, unstressed_length and force are given.

    Example:
        >>> points = [(0, 0, 0), (4, 0, -3), (10, 0, 2)]
        >>> ring = Structure(points, {"rope": Rope([0, 1, 2], 1e6, unstressed_length=12.0)}, [Support([0, 2])])
        >>> state = Analysis(ring).run([Stage("weight", [PointLoad(1, (0, 0, -1e4))])])["weight"]
        >>> round(state.rope("rope").tension, 2), round(state.rope("rope").length, 6)
        (8872.72, 12.105088)
    """

    shares_tension: ClassVar[Literal[True]] = True
    nodes: NDArray[np.int64]
    axial_stiffness: float
    prestress: ArrayLike = 0.0
    unstressed_length: float | None = field(default=None, kw_only=True)
    force: float | None = field(default=None, kw_only=True)
    compression_stiffness: float = field(default=1e-4, kw_only=True)
    mass: float = field(default=0.0, kw_only=True)
    natural_stretch: float = field(default=1.0, kw_only=True)

    if TYPE_CHECKING:  # the field holds an array, but a list may be given

        def __init__(
            self,
            nodes: ArrayLike,
            axial_stiffness: float,
            prestress: ArrayLike = ...,
            *,
            unstressed_length: float | None = ...,
            force: float | None = ...,
            compression_stiffness: float = ...,
            mass: float = ...,
            natural_stretch: float = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        path = validation.indices("Rope nodes", self.nodes)
        if len(path) < 2:
            raise ValueError(f"Rope nodes is {validation.short_repr(self.nodes)}; give two at least, in order.")
        again = np.flatnonzero(path[1:] == path[:-1])
        if len(again):
            raise ValueError(f"Rope nodes visit node {path[again[0]]} twice in a row; leave one of the two out.")
        equal = equal_rows(np.sort(polyline(path), axis=1))
        if equal:
            a, b = path[equal[0] : equal[0] + 2]
            raise ValueError(f"Rope nodes run twice between nodes {a} and {b}; give the second run nodes beside them.")
        validation.keep(self, nodes=path)
        validation.store(self, validation.positive, "axial_stiffness")
        validation.store(self, validation.not_negative, "prestress", "mass")
        validation.store(self, validation.positive, "natural_stretch")
        validation.store(self, validation.fraction, "compression_stiffness")
        for name in ("unstressed_length", "force"):
            if getattr(self, name) is not None:
                validation.store(self, validation.positive, name)
        given = {"prestress": self.tension or None, "unstressed_length": self.unstressed_length, "force": self.force}
        both = [name for name, value in given.items() if value is not None]
        if len(both) > 1:
            raise ValueError(
                f"Rope has {both[0]} {given[both[0]]:g} and {both[1]} {given[both[1]]:g}; give one of the two, the "
                "other follows."
            )
        natural_shape.store(self)

    @cached_property
    def cells(self) -> NDArray[np.int64]:
        """Segments between consecutive nodes, shape (k - 1, 2)."""
        return polyline(self.nodes)

    @cached_property
    def material(self) -> Axial:
        """Law of its length."""
        return Axial(self.axial_stiffness)

    @property
    def tension(self) -> float:
        """Prestress as a number [N]."""
        return float(np.asarray(self.prestress))

    @property
    def carries_compression(self) -> bool:
        """True if it never goes slack: all stiffness is kept."""
        return self.compression_stiffness >= 1

    def fitted(self, name: str, points: NDArray[np.float64]) -> tuple[Self, str]:
        """Rope with the natural stretch of its unstressed length."""
        return replace(self, natural_stretch=natural_stretch_of(name, self, points)), ""


def natural_stretch_of(name: str, rope: Rope, points: NDArray[np.float64]) -> float:
    """Natural stretch of a rope in a structure, from its unstressed length if that is given [-].

    Raises:
        ValueError: It has another natural stretch, too; it is half or twice as long as the path.
    """
    if rope.unstressed_length is None:
        return rope.natural_stretch
    length = float(measures(points, rope.cells).sum())
    ratio = rope.unstressed_length / length
    if rope.natural_stretch not in (1.0, ratio):
        raise ValueError(
            f"Part {name!r} has the unstressed_length {rope.unstressed_length:g}, and a natural_stretch that makes it "
            f"{rope.natural_stretch * length:g}; give one of the two."
        )
    if not 1 / natural_shape.MAX_RATIO < ratio < natural_shape.MAX_RATIO:
        raise ValueError(
            f"Part {name!r} has the unstressed_length {rope.unstressed_length:g}, and its path is {length:g} long in "
            "the reference shape; give a shape of less than double and more than half of that length."
        )
    return ratio


def refuse_ropes(what: str, structure: Any) -> None:
    """Refuse a structure with ropes.

    Raises:
        ValueError: It has one.
    """
    for name, part in structure.parts.items():
        if part.shares_tension:
            raise ValueError(
                f"{what} does not know the Rope {name!r}; give a Cable along polyline(nodes) with one prestress, and "
                "the rope to the structure of the result."
            )
