"""Cables and masts: straight elements with axial force, as plain data checked when created."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from . import cell_tensors, laws, materials, natural_shape
from .axial_law import Axial
from .base_classes import AnyPart
from .laws import Law


class AxialPart(AnyPart):
    """Lines with an axial force: bars and ropes.

    `is_strut` tells those that stand by compression, and fall where nothing holds them. `shares_tension` tells those
    that slide over their nodes, with one tension in all cells.
    """

    dimension: ClassVar[Literal[1]] = 1
    measure: ClassVar[str] = "length"
    is_strut: ClassVar[bool] = False
    has_warp: ClassVar[bool] = False
    if TYPE_CHECKING:  # of the parts themselves
        prestress: Any
        natural_stretch: Any

        @property
        def cells(self) -> NDArray[np.int64]:
            """Segments, shape (n, 2)."""

    def prestress_tensors(self) -> NDArray[np.float64]:
        """Prestress of every cell, shape (n, 1, 1) [N]."""
        return self.tensors(f"{type(self).__name__} prestress", self.prestress)

    def natural_tensors(self) -> NDArray[np.float64]:
        """Natural per reference length of every cell, shape (n, 1, 1) [-]."""
        return self.tensors(f"{type(self).__name__} natural_stretch", self.natural_stretch)

    def tensors(self, what: str, given: ArrayLike) -> NDArray[np.float64]:
        """Numbers of every cell from one, or one per cell, shape (n, 1, 1)."""
        return cell_tensors.of_bar(what, given, len(self.cells))

    def prestress_values(self) -> NDArray[np.float64]:
        """Prestress as results have it: axial forces, shape (n,) [N]."""
        return self.prestress_tensors().ravel()

    def stress_unit(self, force: str, length: str) -> str:
        """Name of the unit of its force."""
        return force

    def size_unit(self, length: str) -> str:
        """Name of the unit of the size of its cells."""
        return length

    def fitted(self, name: str, points: NDArray[np.float64]) -> tuple[Self, str]:
        """Part in a structure with these points; the reason is that of `Membrane.fitted`."""
        return self, ""


@dataclass(frozen=True, eq=False)
class Bar(AxialPart):
    """Common fields of cables and masts: straight elements with axial force only."""

    shares_tension: ClassVar[Literal[False]] = False
    cells: NDArray[np.int64]
    axial_stiffness: float = None  # type: ignore[assignment]  # that of the material, if not given
    prestress: ArrayLike = 0.0
    mass: float = field(default=0.0, kw_only=True)
    natural_stretch: ArrayLike = field(default=1.0, kw_only=True)
    material: Law = field(default=None, kw_only=True)  # type: ignore[assignment]  # Axial(axial_stiffness)

    if TYPE_CHECKING:  # fields hold arrays, but lists may be given

        def __init__(
            self,
            cells: ArrayLike,
            axial_stiffness: float | None = ...,
            prestress: ArrayLike = ...,
            *,
            mass: float = ...,
            natural_stretch: ArrayLike = ...,
            material: Law | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        validation.keep(self, cells=validation.cells(f"{type(self).__name__} cells", self.cells, 2))
        self._store_material()
        validation.store(self, validation.not_negative, "mass")
        validation.store(self, validation.finite, "prestress")
        self.prestress_tensors()
        natural_shape.store(self)

    def _store_material(self) -> None:
        """Store the law and its stiffness, of which one is given, or both as by `dataclasses.replace`."""
        given = self.axial_stiffness
        if given is None and self.material is None:
            raise ValueError(
                f"{type(self).__name__} has neither an axial_stiffness nor a material; give axial_stiffness=... [N], "
                "or a law as material=..."
            )
        if callable(getattr(given, "energy", None)):
            raise ValueError(
                f"{type(self).__name__} axial_stiffness is the law {validation.short_repr(given)}; give that as "
                "material=..."
            )
        if given is not None:
            validation.store(self, validation.positive, "axial_stiffness")
        if self.material is None:
            validation.keep(self, material=Axial(self.axial_stiffness))
        materials.check(f"{type(self).__name__} material", self.material, self.dimension)
        stiffness = float(self.material.stiffness)
        if given is not None and self.axial_stiffness != stiffness:
            raise ValueError(
                f"{type(self).__name__} axial_stiffness is {validation.short_repr(given)}, and that of its material "
                f"{validation.short_repr(self.material)} is {stiffness:g}; give one of the two."
            )
        validation.keep(self, axial_stiffness=stiffness)

    @classmethod
    def from_modulus(
        cls, cells: ArrayLike, E: float, area: float, prestress: ArrayLike = 0.0, density: float = 0.0
    ) -> Self:
        """Make bars from Young's modulus E [Pa], a cross-section [m2] and a density [kg/m3], t/m3 with kN and m."""
        E, area = validation.positive(f"{cls.__name__} E", E), validation.positive(f"{cls.__name__} area", area)
        return cls(cells, E * area, prestress, mass=validation.not_negative(f"{cls.__name__} density", density) * area)


@dataclass(frozen=True, eq=False)
class Cable(Bar):
    """Cables as two-node straight elements that go slack under compression.

    Args:
        cells: Segments as rows of node numbers, shape (n, 2).
        axial_stiffness: Young's modulus times cross-section [N], for the linear law `Axial`.
        prestress: Axial force in the reference shape [N], a number or one per cell, shape (n,). A negative prestress is
            an excess of length: the cable is slack up to the Green-Lagrange strain -prestress / axial_stiffness, about
            its relative excess length. Keep the excess small: stiffness and loads are per length of the reference
            shape. A cable with the excess strain E0 is (1 + 2 E0)^1.5 times as stiff as its data: 6 % more with 2 %, 31
            % with 10 %.
        compression_stiffness: Fraction of the stiffness that a slack cable keeps, in (0, 1] [-]. It keeps slack nodes
            in place. It shows in results as a small negative force of a slack cable: that fraction of the compression
            that a mast would have there. 1 switches slackness off: the cable carries compression like tension, and is
            never called slack.
        mass: Mass per length of the reference shape [kg/m], for `natural_frequencies`. Its unit follows from the other
            data, force unit times s2 over length unit, per length: t/m with kN and m. It adds no weight.
        material: A law of your own that keeps to `Law`, in the place of axial_stiffness; that is its `stiffness` then.
            It goes slack like the linear law, unless it has no relaxed energy by its own word.

    Raises:
        ValueError: Cells or prestress have a wrong shape or values that are not finite; a stiffness is not positive, or
            not that of the material; the material is no law for bars; the mass is negative.

    Example:
        >>> edge = Cable(polyline([0, 1, 2]), axial_stiffness=1e7, prestress=2e4)
        >>> edge.cells.tolist()
        [[0, 1], [1, 2]]
    """

    compression_stiffness: float = 1e-4

    if TYPE_CHECKING:

        def __init__(
            self,
            cells: ArrayLike,
            axial_stiffness: float | None = ...,
            prestress: ArrayLike = ...,
            compression_stiffness: float = ...,
            *,
            mass: float = ...,
            natural_stretch: ArrayLike = ...,
            material: Law | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        super().__post_init__()
        validation.store(self, validation.fraction, "compression_stiffness")
        if not self.carries_compression:
            laws.check_prestress("Cable prestress", self.material, self.prestress_tensors())

    @cached_property
    def carries_compression(self) -> bool:
        """True if no cell goes slack: all stiffness is kept, or the law has no relaxed energy."""
        return self.compression_stiffness >= 1 or laws.carries_compression(self.material, self.dimension)


@dataclass(frozen=True, eq=False)  # repeated so that Python's TypeError names Mast
class Mast(Bar):
    """Pinned masts and struts as two-node straight elements, in tension and compression.

    Args and Raises as for `Cable`, without `compression_stiffness`; a negative prestress is a compression.

    Example:
        >>> mast = Mast.from_modulus([[0, 1]], E=210e9, area=1e-3)
        >>> mast.axial_stiffness
        210000000.0
    """

    is_strut: ClassVar[bool] = True
    carries_compression: ClassVar[bool] = True
    compression_stiffness: ClassVar[float] = 1.0

    if TYPE_CHECKING:

        def __init__(
            self,
            cells: ArrayLike,
            axial_stiffness: float | None = ...,
            prestress: ArrayLike = ...,
            *,
            mass: float = ...,
            natural_stretch: ArrayLike = ...,
            material: Law | None = ...,
        ) -> None: ...
