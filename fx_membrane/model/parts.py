"""Parts of a structure, as plain data checked when created: membranes, and those of `bars` and `ropes`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.one_side import with_one_side
from . import cell_tensors, laws, materials, natural_shape
from .bars import Bar, Cable, Mast
from .base_classes import AnyPart
from .laws import Law
from .ropes import Rope

__all__ = ["Bar", "Cable", "Kind", "Line", "Mast", "Membrane", "Part", "Rope"]


@dataclass(frozen=True, eq=False)
class Membrane(AnyPart):
    """Three-node membrane elements of one fabric.

    Args:
        cells: Triangles as rows of node numbers, shape (n, 3), in either order; see `Structure`.
        material: The law: `Fabric`, `OrthotropicFabric`, `NeoHooke`, `MooneyRivlin`, or one of your own that keeps to
            `Law`. A law without a relaxed energy, by its own word, carries compression.
        prestress: Cauchy stress times thickness in the reference shape [N/m]: a number (isotropic), a pair (warp,
            weft), or a tensor (2, 2) in the warp/weft frame; or one of these per cell, shape (n, 1), (n, 2) or (n, 2,
            2). Shape (2, 2) is always one tensor. A negative prestress is an excess of cloth: the cloth is larger than
            the reference shape, and carries nothing until it is stretched to its own size. Keep the excess small:
            stiffness and loads are per size of the reference shape. Cloth with an excess strain E0 in all directions is
            1 + 2 E0 times as stiff as its data (4 % more with 2 %).
        warp: A vector (3,), or one per cell (n, 3); its projection on the cell is the warp direction. The weft is a
            right angle further, counter-clockwise about the normal of `Structure.normals`. Without a warp, results take
            the global x axis, or y where a cell is nearly normal to x.
        compression_stiffness: Fraction of the stiffness that a wrinkled or slack membrane keeps, in (0, 1] [-]. It
            keeps slack nodes in place; above 1e-3 it shows in results. 1 switches wrinkling off: the membrane carries
            compression like tension, and every cell is called taut.
        mass: Mass per area of the reference shape, as in data sheets [kg/m2], for `natural_frequencies`. Its unit
            follows from the other data, force unit times s2 over length unit, per area: t/m2 with kN and m. It is here
            and not in the material, so that membranes, cables and masts have it in one place. It adds no weight: that
            is a load, `DistributedLoad((0, 0, -9.81 * mass), part)`.

    Raises:
        ValueError: Cells, prestress or warp have a wrong shape or values that are not finite; the material is no law
            for membranes; the material or the prestress has a direction and there is no warp; the mass is negative.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> Membrane(triangles, Fabric(Et=4e5, nu=0.3), prestress=2e3).prestress_tensors()[0].tolist()
        [[2000.0, 0.0], [0.0, 2000.0]]
        >>> woven = OrthotropicFabric(Et_warp=6e5, Et_weft=4e5, nu=0.3, Gt=2e4)
        >>> Membrane(triangles, woven, prestress=(2e3, 1e3), warp=(1, 0, 0)).prestress_tensors()[0].tolist()
        [[2000.0, 0.0], [0.0, 1000.0]]
    """

    dimension: ClassVar[Literal[2]] = 2
    measure: ClassVar[str] = "area"
    is_strut: ClassVar[bool] = False
    shares_tension: ClassVar[Literal[False]] = False
    cells: NDArray[np.int64]
    material: Law
    prestress: ArrayLike = 0.0
    warp: ArrayLike | None = None
    compression_stiffness: float = 1e-4
    mass: float = field(default=0.0, kw_only=True)
    natural_stretch: ArrayLike = field(default=1.0, kw_only=True)

    if TYPE_CHECKING:  # fields hold arrays, but lists may be given

        def __init__(
            self,
            cells: ArrayLike,
            material: Law,
            prestress: ArrayLike = ...,
            warp: ArrayLike | None = ...,
            compression_stiffness: float = ...,
            *,
            mass: float = ...,
            natural_stretch: ArrayLike = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        validation.keep(self, cells=validation.cells("Membrane cells", self.cells, 3))
        materials.check("Membrane material", self.material, self.dimension)
        validation.store(self, validation.finite, "prestress")
        validation.store(self, validation.fraction, "compression_stiffness")
        validation.store(self, validation.not_negative, "mass")
        natural_shape.store(self)
        tensors = self.prestress_tensors()
        if not self.carries_compression:
            laws.check_prestress("Membrane prestress", self.material, cell_tensors.once(tensors))
        directed = [
            name
            for name, given in (("prestress", tensors), ("natural_stretch", self.natural_tensors()))
            if not cell_tensors.are_isotropic(given)
        ]
        if self.warp is not None:
            warp = validation.finite("Membrane warp", self.warp)
            validation.keep(self, warp=warp)
            if warp.shape not in ((3,), (len(self.cells), 3)):
                raise ValueError(f"Membrane warp has shape {warp.shape}; give (3,) or ({len(self.cells)}, 3).")
        elif directed or laws.is_directed(self.material):
            what = f"material is {validation.short_repr(self.material)}"
            if not laws.is_directed(self.material):
                what = f"{directed[0]} is {validation.short_repr(getattr(self, directed[0]))}"
            raise ValueError(
                f"Membrane {what}, which has a warp and a weft; give the warp as a vector, warp=(x, y, z)."
            )

    @cached_property
    def carries_compression(self) -> bool:
        """True if no cell wrinkles: all stiffness is kept, or the law has no relaxed energy."""
        return self.compression_stiffness >= 1 or laws.carries_compression(self.material, self.dimension)

    def prestress_tensors(self) -> NDArray[np.float64]:
        """Prestress of every cell in the warp/weft frame, shape (n, 2, 2) [N/m]."""
        tensors = self.tensors("Membrane prestress", self.prestress)
        cell_tensors.check_symmetry("Membrane prestress", tensors)
        return tensors

    def natural_tensors(self) -> NDArray[np.float64]:
        """Natural shape of every cell: A of `forms.natural_shape` in the warp/weft frame, shape (n, 2, 2) [-]."""
        return self.tensors("Membrane natural_stretch", self.natural_stretch)

    def tensors(self, what: str, given: ArrayLike) -> NDArray[np.float64]:
        """Tensors of every cell from numbers, (warp, weft) pairs or tensors, shape (n, 2, 2)."""
        return cell_tensors.of_membrane(what, given, len(self.cells))

    def prestress_values(self) -> NDArray[np.float64]:
        """Prestress as results have it: `prestress_tensors`."""
        return self.prestress_tensors()

    @property
    def has_warp(self) -> bool:
        """True if a warp is given."""
        return self.warp is not None

    def stress_unit(self, force: str, length: str) -> str:
        """Name of the unit of its stresses."""
        return f"{force}/{length}"

    def size_unit(self, length: str) -> str:
        """Name of the unit of the size of its cells."""
        return f"{length}2"

    def fitted(self, name: str, points: NDArray[np.float64]) -> tuple[Membrane, str]:
        """Membrane with its cells turned to one sense; also the reason why it has no two sides, or ""."""
        cells, reason = with_one_side(points, self.cells)
        return (self if np.array_equal(cells, self.cells) else replace(self, cells=cells)), reason


Line = Cable | Mast | Rope
Part = Membrane | Line
Kind = TypeVar("Kind", bound=Membrane | Bar | Rope)
