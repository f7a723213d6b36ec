"""Wishes for the stress of membranes: direction and size given in space, taken anew where each cell is."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.calls import unfit
from ..geometry.sizes import normals
from ..geometry.symmetric_tensors import components, tensors
from ..geometry.vector_columns import columns, projected
from ..model.by_value import ByValue
from ..model.parts import Membrane
from ..model.structure import Structure
from .cell_reference import check_tension, tangents
from .plan import Field, place

Array = NDArray[np.float64]
Size = Callable[[Array], Array]


@dataclass(frozen=True, eq=False)
class RadialDirection(ByValue):
    """Direction away from an axis, as a function of place: the warp of cones and domes about it.

    Args:
        origin: Point of the axis, shape (3,) [m].
        axis: Vector along it, shape (3,), any length.

    Raises:
        ValueError: A vector is not finite, or axis is zero.

    Example:
        >>> RadialDirection()(np.array([[3.0], [4.0], [7.0]])).tolist()
        [[0.6, 0.8, 0.0]]
    """

    origin: ArrayLike = (0.0, 0.0, 0.0)
    axis: ArrayLike = (0.0, 0.0, 1.0)

    def __post_init__(self) -> None:
        validation.keep(self, origin=validation.vector("RadialDirection origin", self.origin))
        validation.direction("RadialDirection axis", self.axis)
        validation.keep(self, axis=validation.vector("RadialDirection axis", self.axis))

    def __call__(self, positions: Array) -> Array:
        """Give unit vectors at positions of shape (3, n) [m], shape (n, 3) [-]; zero on the axis."""
        arm = self.arms(positions.T)
        length = np.linalg.norm(arm, axis=1, keepdims=True)
        return np.divide(arm, length, where=length > 0, out=np.zeros_like(arm))

    def arms(self, points: Array) -> Array:
        """Vectors from the axis to points, both of shape (n, 3) [m]."""
        axis, arm = validation.direction("axis", self.axis), points - np.asarray(self.origin)
        return np.asarray(arm - (arm @ axis)[:, None] * axis)


@runtime_checkable
class SurfaceDirection(Protocol):
    """Direction that depends on the whole surface of a membrane, not on the place alone."""

    def vectors(self, name: str, points: Array, triangles: NDArray[np.int64]) -> Array:
        """Vectors of the direction in the cells of a shape, shape (cells, 3).

        Args:
            name: Name of the membrane, for messages.
            points: Positions of all nodes, shape (n, 3) [m].
            triangles: Cells, shape (cells, 3).

        Raises:
            ValueError: There is none.
        """


Directed = Field | SurfaceDirection


class Wish(NamedTuple):
    """Stress wished for in a membrane.

    Attributes:
        name: Name of the membrane.
        part: The membrane.
        direction: Function of the centres of cells, shape (3, cells), that returns vectors whose projection is the warp
            there, shape (cells, 3); None for equal stress in all directions, which has no warp.
        along: Direction that depends on the surface, from which the function is that on one shape; None without one.
        size: Function of the centres that returns tensors along warp and weft, shape (cells, 2, 2) [N/m].
    """

    name: str
    part: Membrane
    direction: Callable[[Array], Array] | None
    size: Size
    along: SurfaceDirection | None = None

    def on(self, points: Array) -> Wish:
        """Fix the direction on the surface of a shape, shape (n, 3) [m].

        Raises:
            ValueError: There is none on this surface.
        """
        if self.along is None:
            return self
        vectors = self.along.vectors(self.name, points, self.part.cells)
        return self._replace(direction=lambda x: vectors)

    def at(self, corners: Array, normal: Array) -> tuple[Array, Array]:
        """Evaluate the wish in cells: unit tangents, shape (cells, 3), and tensors, shape (cells, 2, 2) [N/m].

        Args:
            corners: Positions of the nodes of the cells, shape (cells, 3, 3) [m].
            normal: Unit normals of the cells, shape (cells, 3) [-].
        """
        at = columns(corners)
        warp, size = self.in_columns(at.mean(axis=0), at[1] - at[0], np.ascontiguousarray(normal.T))
        return np.ascontiguousarray(warp.T), tensors(size)

    def in_columns(self, centres: Array, side: Array, normal: Array) -> tuple[Array, Array]:
        """Evaluate the wish in copies of cells, in columns: unit tangents, (3, ..., cells), and components.

        Args:
            centres: Centres of the cells, shape (3, ..., cells) [m].
            side: Vectors along a side, of the same shape [m].
            normal: Unit normals of the cells, of the same shape [-].

        Returns:
            The unit tangents, and the components of the stress as in `symmetric_tensors` [N/m]: shape (3, ..., cells),
            or (3, 1, cells) where all copies have the same.
        """
        size = _of_copies(self.size, centres)
        if self.direction is None:
            return projected(side, normal), components(size)
        return projected(np.moveaxis(_of_copies(self.direction, centres), -1, 0), normal), components(size)

    def check(self, points: Array) -> None:
        """Refuse a wish that does not fit a shape.

        Raises:
            ValueError: A direction is zero, or normal to its cell; an axis goes through a cell; a stress is no tension.
        """
        corners = points[self.part.cells]
        if isinstance(self.direction, RadialDirection):
            _check_axis(self.name, self.part, points, self.direction)
        if self.direction is not None:
            tangents(self.name, self.part, points, self.direction(corners.mean(axis=1).T))
        check_tension(self.name, self.part, points, self.at(corners, normals(points, self.part.cells))[1])


def _of_copies(function: Callable[[Array], Array], centres: Array) -> Array:
    """Call a function of place for each copy of all cells, shape (3, ..., cells); once where its values stay."""
    if centres.ndim == 2:
        return function(centres)
    if isinstance(function, RadialDirection):  # of each place alone
        return function(centres.reshape(3, -1)).reshape(*centres.shape[1:], 3)
    values = [function(centres[:, copy]) for copy in range(centres.shape[1])]
    return values[0][None] if all(value is values[0] for value in values) else np.stack(values)


def wishes_of(structure: Structure, stress: Any, warp: Any) -> dict[str, Wish]:
    """Wishes for the membranes of a structure: functions of place, in the place of their prestress and their warp.

    Raises:
        ValueError: A name is that of no membrane; a value is no function of place, or gives values of a wrong shape.
    """
    sizes, directions = _functions(structure, "stress", stress), _functions(structure, "warp", warp)
    found = {}
    for name, part in structure.membranes.items():
        direction, tensors = _direction(name, part, directions.get(name)), part.prestress_tensors()
        size = _size(name, part, direction is not None, sizes[name]) if name in sizes else lambda x, t=tensors: t
        along = directions.get(name)
        wish = Wish(name, part, direction, size, along if isinstance(along, SurfaceDirection) else None)
        found[name] = wish.on(structure.points)
        found[name].check(structure.points)
    return found


def _functions(structure: Structure, what: str, given: Any) -> dict[str, Any]:
    validation.instance(what, given, Mapping | None)
    for name, field in (given or {}).items():
        if not (isinstance(name, str) and name in structure.parts_of(Membrane)):
            raise ValueError(f"{what} names {validation.short_repr(name)}, which is no membrane of the structure.")
        if what == "warp" and isinstance(field, SurfaceDirection):
            continue
        if shown := unfit(field, 1):
            raise ValueError(f"{what} of part {name!r} is {shown}; give a function of place, or the value in the part.")
    return dict(given or {})


def _direction(name: str, part: Membrane, field: Directed | None) -> Callable[[Array], Array] | None:
    if field is None:
        if part.warp is None:
            return None
        vectors = np.broadcast_to(np.asarray(part.warp, dtype=np.float64), (len(part.cells), 3))
        return lambda x: vectors
    if isinstance(field, RadialDirection):
        validation.plain(f"warp of part {name!r}", field, RadialDirection)
        return field
    if isinstance(field, SurfaceDirection):  # that on the first shape takes its place
        return lambda x: np.zeros((len(part.cells), 3))

    def vectors_at(x: Array) -> Array:
        value = validation.finite(f"warp of part {name!r}, as a function of place: its value", field(x))
        if value.shape not in ((3,), (len(part.cells), 3)):
            raise ValueError(
                f"warp of part {name!r}, as a function of place, gives shape {value.shape}; give (3,) or "
                f"({len(part.cells)}, 3)."
            )
        return np.broadcast_to(value, (len(part.cells), 3))

    return vectors_at


def _size(name: str, part: Membrane, directed: bool, field: Field) -> Size:
    n = len(part.cells)

    def tensors_at(x: Array) -> Array:
        value = validation.finite(f"stress of part {name!r}, as a function of place: its value", field(x))
        if value.shape in ((), (n,)):
            return np.broadcast_to(value.reshape(-1, 1, 1) * np.eye(2), (n, 2, 2))
        if not directed:
            raise ValueError(f"stress of part {name!r} has a warp and a weft; give the warp in the part, or by warp.")
        if value.shape in ((2,), (n, 2)):
            return np.broadcast_to(value.reshape(-1, 2, 1) * np.eye(2), (n, 2, 2))
        if value.shape in ((2, 2), (n, 2, 2)):
            skew = np.flatnonzero((value != value.swapaxes(-1, -2)).reshape(-1, 4).any(axis=1))
            if len(skew):
                tensor = value.reshape(-1, 2, 2)[skew[0]].tolist()
                raise ValueError(
                    f"stress of part {name!r} is {tensor} in cell {skew[0]}, which is not symmetric; give [[warp, "
                    "shear], [shear, weft]]."
                )
            return np.broadcast_to(value, (n, 2, 2))
        raise ValueError(
            f"stress of part {name!r}, as a function of place, gives shape {value.shape}; give numbers, pairs along "
            f"warp and weft, or tensors, for each of the {n} cells: ({n},), ({n}, 2) or ({n}, 2, 2)."
        )

    return tensors_at


def _check_axis(name: str, part: Membrane, points: Array, direction: RadialDirection) -> None:
    """Refuse an axis through a cell, where its direction turns by half a circle."""
    arms = direction.arms(points)[part.cells]
    axis = np.asarray(direction.axis)
    turns = [np.cross(arms[:, k], arms[:, (k + 1) % 3]) @ axis for k in range(3)]
    sides = np.stack(turns)
    scale = 1e-12 * np.abs(arms).max() ** 2
    through = np.flatnonzero((sides >= -scale).all(axis=0) | (sides <= scale).all(axis=0))
    if len(through):
        raise ValueError(
            f"Part {name!r}, cell {through[0]} at {place(points, part.cells, through[0])}: the axis of its warp goes "
            "through the cell, where no direction is radial; leave a hole there, held by a ring."
        )
