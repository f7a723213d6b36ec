"""Parts of a structure, as plain data checked when created: membranes, cables and masts."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar, Literal, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from . import laws, materials
from .by_value import ByValue
from .laws import Law
from .materials import Axial


@dataclass(frozen=True, eq=False)
class Membrane(ByValue):
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
    is_strut: ClassVar[bool] = False
    cells: NDArray[np.int64]
    material: Law
    prestress: ArrayLike = 0.0
    warp: ArrayLike | None = None
    compression_stiffness: float = 1e-4
    mass: float = field(default=0.0, kw_only=True)

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
        ) -> None: ...

    def __post_init__(self) -> None:
        validation.keep(self, cells=validation.cells("Membrane cells", self.cells, 3))
        materials.check("Membrane material", self.material, self.dimension)
        validation.store(self, validation.finite, "prestress")
        validation.store(self, validation.fraction, "compression_stiffness")
        validation.store(self, validation.not_negative, "mass")
        tensors = self.prestress_tensors()
        if not self.carries_compression:
            laws.check_prestress("Membrane prestress", self.material, tensors)
        directed = not np.array_equal(tensors, tensors[:, :1, :1] * np.eye(2))
        if self.warp is not None:
            warp = validation.finite("Membrane warp", self.warp)
            validation.keep(self, warp=warp)
            if warp.shape not in ((3,), (len(self.cells), 3)):
                raise ValueError(f"Membrane warp has shape {warp.shape}; give (3,) or ({len(self.cells)}, 3).")
        elif directed or laws.is_directed(self.material):
            what = f"material is {validation.short_repr(self.material)}"
            if not laws.is_directed(self.material):
                what = f"prestress is {validation.short_repr(self.prestress)}"
            raise ValueError(
                f"Membrane {what}, which has a warp and a weft; give the warp as a vector, warp=(x, y, z)."
            )

    @cached_property
    def carries_compression(self) -> bool:
        """True if no cell wrinkles: all stiffness is kept, or the law has no relaxed energy."""
        return self.compression_stiffness >= 1 or laws.carries_compression(self.material, self.dimension)

    def prestress_tensors(self) -> NDArray[np.float64]:
        """Prestress of every cell in the warp/weft frame, shape (n, 2, 2) [N/m]."""
        n = len(self.cells)
        value = np.asarray(self.prestress)
        if value.shape in ((), (1,), (n, 1)):
            return np.broadcast_to(value.reshape(-1, 1, 1) * np.eye(2), (n, 2, 2))
        if value.shape == (2,) or (value.shape == (n, 2) and n != 2):
            return np.broadcast_to(value.reshape(-1, 2, 1) * np.eye(2), (n, 2, 2))
        if value.shape not in ((2, 2), (n, 2, 2)):
            raise ValueError(
                f"Membrane prestress has shape {value.shape}; give a number, a (warp, weft) pair or a (2, 2) tensor, "
                f"or one of these for each of the {n} cells: ({n}, 1), ({n}, 2) or ({n}, 2, 2)."
            )
        skew = np.flatnonzero(value.reshape(-1, 4)[:, 1] != value.reshape(-1, 4)[:, 2])
        if len(skew):
            tensor = value.reshape(-1, 2, 2)[skew[0]].tolist()
            raise ValueError(f"Membrane prestress {tensor} is not symmetric; give [[warp, shear], [shear, weft]].")
        return np.broadcast_to(value, (n, 2, 2))


@dataclass(frozen=True, eq=False)
class Bar(ByValue):
    """Common fields of cables and masts: straight elements with axial force only.

    `is_strut` tells those that stand by compression, and fall where nothing holds them.
    """

    dimension: ClassVar[Literal[1]] = 1
    is_strut: ClassVar[bool] = False
    cells: NDArray[np.int64]
    axial_stiffness: float = None  # type: ignore[assignment]  # that of the material, if not given
    prestress: ArrayLike = 0.0
    mass: float = field(default=0.0, kw_only=True)
    material: Law = field(default=None, kw_only=True)  # type: ignore[assignment]  # Axial(axial_stiffness)

    if TYPE_CHECKING:  # fields hold arrays, but lists may be given

        def __init__(
            self,
            cells: ArrayLike,
            axial_stiffness: float | None = ...,
            prestress: ArrayLike = ...,
            *,
            mass: float = ...,
            material: Law | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        validation.keep(self, cells=validation.cells(f"{type(self).__name__} cells", self.cells, 2))
        self._store_material()
        validation.store(self, validation.not_negative, "mass")
        validation.store(self, validation.finite, "prestress")
        self.prestress_tensors()

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

    def prestress_tensors(self) -> NDArray[np.float64]:
        """Prestress of every cell, shape (n, 1, 1) [N]."""
        name, n = f"{type(self).__name__} prestress", len(self.cells)
        value = np.asarray(self.prestress)
        if value.shape not in ((), (n,)):
            raise ValueError(f"{name} has shape {value.shape}; give a number or one for each of the {n} cells.")
        return np.broadcast_to(value.reshape(-1, 1, 1), (n, 1, 1))


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
            material: Law | None = ...,
        ) -> None: ...


Part = Membrane | Cable | Mast
Kind = TypeVar("Kind", bound=Membrane | Bar)
