"""A tension structure as plain data: points, parts (membranes, cables, masts) and supports, checked when created."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import validation
from .geometry import branching_edge, measures, normals, orientation
from .material import Fabric, OrthotropicFabric


@dataclass(frozen=True, eq=False)
class Membrane:
    """Three-node membrane elements of one fabric.

    Args:
        cells: Triangles as rows of node numbers, shape (n, 3).
        material: The fabric.
        prestress: Cauchy stress times thickness in the reference shape [N/m]: a number (isotropic), a pair
            (warp, weft), or a tensor (2, 2) in the warp/weft frame; or one of these per cell, shape (n, 1),
            (n, 2) or (n, 2, 2). Shape (2, 2) is always one tensor.
        warp: A vector (3,), or one per cell (n, 3), that projected on the cell gives the warp direction. The weft
            is a right angle further, counter-clockwise about the normal of the cell. Without a warp the global x
            axis is taken, or y where a cell is nearly normal to x, for results only.
        compression_stiffness: Share of the stiffness that is kept where the membrane wrinkles or is slack, in (0, 1]
            [-]. It keeps slack nodes in place; above 1e-3 it is seen in results. 1 switches wrinkling off.
        mass: Mass per area of the reference shape, as data sheets give it [kg/m2], for `natural_frequencies`. It is
            here and not in the material, so that membranes, cables and masts have it in one place. It brings no
            weight: that is a load, `DeadLoad((0, 0, -9.81 * mass), part)`.

    Raises:
        ValueError: Cells, prestress or warp have a wrong shape or values that are not finite; the material or the
            prestress has a direction and there is no warp; the mass is negative.
    """

    dimension: ClassVar[int] = 2
    cells: NDArray[np.int64]
    material: Fabric | OrthotropicFabric
    prestress: ArrayLike = 0.0
    warp: ArrayLike | None = None
    compression_stiffness: float = 1e-4
    mass: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "cells", validation.cells("Membrane cells", self.cells, 3))
        validation.instance("Membrane material", self.material, Fabric | OrthotropicFabric)
        object.__setattr__(self, "prestress", validation.finite("Membrane prestress", self.prestress))
        validation.share("Membrane compression_stiffness", self.compression_stiffness)
        validation.not_negative("Membrane mass", self.mass)
        tensors = self.prestress_tensors()
        directed = not np.array_equal(tensors, tensors[:, :1, :1] * np.eye(2))
        if self.warp is not None:
            warp = validation.finite("Membrane warp", self.warp)
            object.__setattr__(self, "warp", warp)
            if warp.shape not in ((3,), (len(self.cells), 3)):
                raise ValueError(f"Membrane warp has shape {warp.shape}; give (3,) or ({len(self.cells)}, 3).")
        elif directed or isinstance(self.material, OrthotropicFabric):
            raise ValueError(
                "The material or the prestress has a warp and a weft; give the warp as a vector, warp=(x, y, z)."
            )

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
        if not np.array_equal(value, np.swapaxes(value, -1, -2)):
            raise ValueError("Membrane prestress is not symmetric; give [[warp, shear], [shear, weft]].")
        return np.broadcast_to(value, (n, 2, 2))


@dataclass(frozen=True, eq=False)
class _Bar:
    """What cables and masts have in common: straight elements that carry axial force only."""

    dimension: ClassVar[int] = 1
    cells: NDArray[np.int64]
    axial_stiffness: float
    prestress: ArrayLike = 0.0
    mass: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        kind = type(self).__name__
        object.__setattr__(self, "cells", validation.cells(f"{kind} cells", self.cells, 2))
        validation.positive(f"{kind} axial_stiffness", self.axial_stiffness)
        validation.not_negative(f"{kind} mass", self.mass)
        object.__setattr__(self, "prestress", validation.finite(f"{kind} prestress", self.prestress))
        self.prestress_tensors()

    @classmethod
    def from_modulus(
        cls, cells: NDArray[np.int64], E: float, area: float, prestress: ArrayLike = 0.0, density: float = 0.0
    ) -> Self:
        """Bars of a Young's modulus E [Pa], a cross-section area [m2] and a density [kg/m3]."""
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
class Cable(_Bar):
    """Cables as two-node straight elements that go slack instead of carrying compression.

    Args:
        cells: Segments as rows of node numbers, shape (n, 2).
        axial_stiffness: Young's modulus times cross-section [N].
        prestress: Axial force in the reference shape [N], a number or one per cell, shape (n,).
        compression_stiffness: Share of the stiffness that is kept where the cable is slack, in (0, 1] [-].
        mass: Mass per length of the reference shape [kg/m], for `natural_frequencies`; it brings no weight.

    Raises:
        ValueError: Cells or prestress have a wrong shape or values that are not finite; a stiffness is not positive;
            the mass is negative.
    """

    compression_stiffness: float = 1e-4

    def __post_init__(self) -> None:
        super().__post_init__()
        validation.share("Cable compression_stiffness", self.compression_stiffness)


class Mast(_Bar):
    """Pinned masts and struts as two-node straight elements, in tension and compression.

    Args and Raises as for `Cable`, without `compression_stiffness`.
    """


Part = Membrane | Cable | Mast


@dataclass(frozen=True, eq=False)
class Support:
    """Nodes held at their reference position.

    Args:
        nodes: A node number or several, shape (k,).
        components: The components held, some of "xyz".

    Raises:
        ValueError: Nodes are not whole numbers; components are not letters of "xyz".
    """

    nodes: ArrayLike
    components: str = "xyz"

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", validation.rows("Support nodes", self.nodes))
        validation.components("Support components", self.components)


@dataclass(frozen=True, eq=False, repr=False)
class Structure:
    """Everything that does not change from stage to stage.

    Args:
        points: Reference (prestressed) position of the nodes, shape (n, 3) [m]. A node is known by its row.
        parts: Membranes, cables and masts by name. Parts that share a node are hinged together there.
        supports: Nodes that do not move.

    Raises:
        ValueError: A cell names a node that does not exist, has no area or no length, or is normal to its warp
            vector; a support is on a node that does not exist or that no part uses; a value is not finite.
    """

    points: NDArray[np.float64]
    parts: Mapping[str, Part]
    supports: Sequence[Support] = ()

    def __post_init__(self) -> None:
        points = validation.finite("points", self.points)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points has shape {points.shape}; give (n, 3), one row x, y, z for each node.")
        object.__setattr__(self, "points", points)
        if not isinstance(self.parts, Mapping):
            raise ValueError(f'parts is a {type(self.parts).__name__}; give a dictionary, {{"name": Membrane(...)}}.')
        object.__setattr__(self, "parts", dict(self.parts))
        object.__setattr__(self, "supports", validation.instances("supports", self.supports, Support))
        if not self.parts:
            raise ValueError("The structure has no parts; give at least one Membrane, Cable or Mast.")
        for name, part in self.parts.items():
            validation.name("part", name)
            validation.instance(f"Part {name!r}", part, Part)
            outside = np.flatnonzero(((part.cells < 0) | (part.cells >= len(points))).any(axis=1))
            for cell in outside[:1]:
                validation.in_range(f"Part {name!r}, cell {cell},", part.cells[cell], len(points), "node")
            self._check_measures(name, part)
            if part.dimension == 2:
                self.warp(name)
        for number, support in enumerate(self.supports):
            self.check_nodes(f"Support {number}", np.asarray(support.nodes))

    def __repr__(self) -> str:
        kinds = ", ".join(f"{name!r}: {len(part.cells)} x {type(part).__name__}" for name, part in self.parts.items())
        return f"Structure({len(self.points)} points, {{{kinds}}}, {len(self.supports)} supports)"

    @property
    def used(self) -> NDArray[np.bool_]:
        """Which nodes belong to a part, shape (n,)."""
        used = np.zeros(len(self.points), dtype=bool)
        for part in self.parts.values():
            used[part.cells] = True
        return used

    @property
    def supported(self) -> NDArray[np.bool_]:
        """Which components of which nodes are held by supports, shape (n, 3)."""
        held = np.zeros(self.points.shape, dtype=bool)
        for support in self.supports:
            for component in validation.components("Support components", support.components):
                held[support.nodes, component] = True
        return held

    def warp(self, name: str) -> NDArray[np.float64]:
        """Unit warp direction of every cell of a membrane in its own plane, shape (cells, 3) [-]."""
        membrane = self.parts[name]
        assert isinstance(membrane, Membrane)
        normal = normals(self.points, membrane.cells)
        if membrane.warp is None:
            along_x = np.abs(normal[:, :1]) < 0.99
            given = np.where(along_x, [[1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0]])
        else:
            given = np.broadcast_to(np.asarray(membrane.warp, dtype=np.float64), normal.shape)
        tangent = given - np.sum(given * normal, axis=1, keepdims=True) * normal
        length = np.linalg.norm(tangent, axis=1)
        bad = np.flatnonzero(length <= 1e-8 * np.linalg.norm(given, axis=1))
        if len(bad):
            raise ValueError(
                f"Part {name!r}, cell {bad[0]}: its warp {given[bad[0]].tolist()} is zero or normal to the cell; "
                "give a vector that lies roughly in the cell."
            )
        return np.asarray(tangent / length[:, None])

    def normals(self, name: str) -> NDArray[np.float64]:
        """Unit normals of a membrane, all on one side of it, shape (cells, 3) [-]; a positive pressure acts along them.

        In each connected piece they follow the right-hand rule of its first cell.

        Raises:
            ValueError: The membrane is one-sided, like a Moebius strip, or branches.
        """
        cells = self.parts[name].cells
        branch = branching_edge(cells)
        if branch is not None:
            raise ValueError(
                f"Part {name!r} branches at the edge between nodes {branch[0]} and {branch[1]}, so that it has no two "
                "sides; make each sheet a part of its own."
            )
        sides = orientation(cells)
        if sides is None:
            raise ValueError(
                f"Part {name!r} has only one side, like a Moebius strip, so that a normal and a pressure have no "
                "direction on it; cut it into parts along a line of edges."
            )
        return sides[:, None] * normals(self.points, cells)

    def check_nodes(self, what: str, nodes: NDArray[np.int64]) -> None:
        """Refuses nodes that do not exist or that no part uses.

        Raises:
            ValueError: Names what, and the node.
        """
        validation.in_range(what, nodes, len(self.points), "node")
        loose = nodes[~self.used[nodes]]
        if len(loose):
            raise ValueError(f"{what} is on node {loose[0]}, which no part uses; mend the number or add the part.")

    def _check_measures(self, name: str, part: Part) -> None:
        size = measures(self.points, part.cells)
        span = np.ptp(self.points[part.cells], axis=1).max(axis=1) ** part.dimension
        bad = np.flatnonzero(size <= 1e-10 * np.maximum(span, np.finfo(float).tiny))
        if len(bad):
            what = "length" if part.dimension == 1 else "area"
            raise ValueError(
                f"Part {name!r}, cell {bad[0]} (nodes {part.cells[bad[0]].tolist()}) has no {what}; "
                "remove the cell or move its nodes apart."
            )
