"""Constraints of form finding, as plain data: cables by their geometry, nodes that slide, rings and rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...checks import validation
from ...model.by_value import ByValue

RIGHT_ANGLE = 90.0


def _check_cable(constraint: CableConstraint) -> None:
    """Check the part and the cells of a constraint of a cable."""
    validation.keep(constraint, part=validation.name("part", constraint.part))
    if constraint.cells is not None:
        what = f"{type(constraint).__name__} cells"
        validation.keep(constraint, cells=validation.unique_indices(what, constraint.cells, "cell"))


@dataclass(frozen=True, eq=False)
class CableForce(ByValue):
    """Force of a cable in form finding, instead of its prestress.

    Args:
        part: Name of the cable.
        force: Tension [N].
        cells: Its cells of that force, shape (k,); all if not given.
        horizontal: True for the force in projection on the plan of `projected_stress`, or on the plane of x and y.

    Raises:
        ValueError: The force is not positive, or a field is of another kind.

    Example:
        >>> CableForce("edge", 15e3).force
        15000.0
    """

    part: str
    force: float
    cells: ArrayLike | None = None
    horizontal: bool = False

    def __post_init__(self) -> None:
        _check_cable(self)
        validation.store(self, validation.positive, "force")
        validation.store(self, validation.truth, "horizontal")


@dataclass(frozen=True, eq=False)
class CableDensity(ByValue):
    """Force density of a cable in form finding, instead of its prestress.

    Args:
        part: Name of the cable.
        density: Ratio of force to length [N/m].
        cells: Its cells of that force density, shape (k,); all if not given.

    Raises:
        ValueError: The force density is not positive, or a field is of another kind.

    Example:
        >>> CableDensity("edge", 2e3).density
        2000.0
    """

    part: str
    density: float
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        _check_cable(self)
        validation.store(self, validation.positive, "density")


@dataclass(frozen=True, eq=False)
class CableLength(ByValue):
    """Length of a cable in the form; its force is found.

    A line of the cable runs between its ends, branches and nodes held in all components; a closed one is divided where
    supports, other cables or masts, or constraints of nodes hold it. Each line has that length, and one force, or
    horizontal force, or force density, as the argument `cables` of `projected_stress` says. In `natural_force_density`
    it has one force.

    Args:
        part: Name of the cable.
        length: Length of each line [m].
        cells: Cells that make one line or several, shape (k,); all if not given.

    Raises:
        ValueError: The length is not positive, or a field is of another kind.

    Example:
        >>> CableLength("edge", 12.5).length
        12.5
    """

    part: str
    length: float
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        _check_cable(self)
        validation.store(self, validation.positive, "length")


@dataclass(frozen=True, eq=False)
class CableSag(ByValue):
    """Sag of a cable in the form; its force is found. Lines are those of `CableLength`.

    Args:
        part: Name of the cable.
        sag: Largest distance of nodes of a line from its chord, the straight line between its ends [m].
        cells: Cells that make one line or several, shape (k,); all if not given.
        along: Direction of that distance, shape (3,), as (0, 0, 1) for a sag measured vertically; normal to the chord
            if not given.

    Raises:
        ValueError: The sag is not positive, the direction is zero, or a field is of another kind.

    Example:
        >>> CableSag("edge", 1.2).sag
        1.2
    """

    part: str
    sag: float
    cells: ArrayLike | None = None
    along: ArrayLike | None = None

    def __post_init__(self) -> None:
        _check_cable(self)
        validation.store(self, validation.positive, "sag")
        if self.along is not None:
            validation.store(self, validation.vector, "along")
            validation.direction("CableSag along", self.along)


@dataclass(frozen=True, eq=False)
class EdgeAngle(ByValue):
    """Largest angle of an edge cable in the form, between its chord and its tangent at an end.

    An edge cable of force T in a membrane of stress n is an arc of radius T / n. Over a chord c its angle a has
    sin a = c n / 2 T: the smaller the force, the deeper the edge and the sharper the corner. A line whose prestress
    gives a larger angle gets the force of this one; the others keep their prestress. `natural_force_density` goes no
    lower than c n / 2 sin a, with the least principal stress n beside the edge. Lines are those of `CableLength`.

    Args:
        part: Name of the cable.
        angle: Largest angle, above 0 and at most 90 [degrees].
        cells: Cells that make one line or several, shape (k,); all if not given.

    Raises:
        ValueError: The angle is out of range, or a field is of another kind.

    Example:
        >>> EdgeAngle("edge", 30).angle
        30.0
    """

    part: str
    angle: float
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        _check_cable(self)
        validation.store(self, validation.positive, "angle")
        if self.angle > RIGHT_ANGLE:
            raise ValueError(f"EdgeAngle angle is {self.angle:g}; give an angle of at most {RIGHT_ANGLE:g} degrees.")


@dataclass(frozen=True, eq=False)
class Slide(ByValue):
    """Nodes that slide without friction in form finding: on a line, or on a plane, through their first position.

    In the structure of the form, a node that slides along axes has a support in its other components. One that slides
    in an inclined direction is held, as supports have the directions of axes; its reaction has no part along the slide.

    Args:
        nodes: A node number or several, shape (k,).
        direction: Direction of the line, shape (3,), or one for each node, (k, 3); of any length.
        normal: Normal of the plane instead, shape (3,) or (k, 3); of any length.

    Raises:
        ValueError: Neither or both of direction and normal are given; one is zero, or of another shape.

    Example:
        >>> Slide([3, 4], normal=(0, 1, 1)).nodes.tolist()
        [3, 4]
    """

    nodes: ArrayLike
    direction: ArrayLike | None = None
    normal: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.keep(self, nodes=validation.unique_indices("Slide nodes", self.nodes, "node"))
        if (self.direction is None) == (self.normal is None):
            raise ValueError("A Slide is on a line or on a plane; give one of direction=(x, y, z), normal=(x, y, z).")
        field = "direction" if self.normal is None else "normal"
        validation.store(self, validation.finite, field)
        value, count = np.asarray(getattr(self, field)), len(np.asarray(self.nodes))
        if value.shape not in {(3,), (count, 3)}:
            raise ValueError(f"Slide {field} has shape {value.shape}; give (3,), or ({count}, 3) for one at each node.")
        zero = np.flatnonzero(~np.atleast_2d(value).any(axis=1))
        if len(zero):
            where = f" of node {np.asarray(self.nodes)[zero[0]]}" if value.ndim == 2 else ""
            raise ValueError(f"Slide {field}{where} is zero; give a vector (x, y, z) that is not.")

    def unit(self) -> NDArray[np.float64]:
        """Direction or normal at each node, of length one, shape (k, 3) [-]."""
        given = np.atleast_2d(np.asarray(self.direction if self.normal is None else self.normal))
        scaled = given / np.abs(given).max(axis=1, keepdims=True)  # squares of tiny ones would be zero
        scaled /= np.linalg.norm(scaled, axis=1, keepdims=True)
        return np.broadcast_to(scaled, (len(np.asarray(self.nodes)), 3))


@dataclass(frozen=True, eq=False)
class Ring(ByValue):
    """Nodes on a circle that stay plane and round in form finding, while the ring moves and turns.

    The nodes keep their angles on the circle. Supports of the ring's nodes guide it: held in "z", it moves in its
    plane. What keeps it round is in `Form.reactions`. In the structure of the form, bars along the ring without
    prestress take these forces where they balance them; else its nodes are held.

    Args:
        nodes: The nodes, on a circle at the start, shape (k,), k >= 3.
        radius: Radius in the form [m]; found if not given. That of the start makes the ring rigid. A ring of free
            radius around a hole grows from step to step, as nothing within it holds it; `Form.remarks` says so.

    Raises:
        ValueError: There are fewer than three nodes, or the radius is not positive.

    Example:
        >>> Ring([0, 1, 2, 3], radius=0.6).radius
        0.6
    """

    nodes: ArrayLike
    radius: float | None = None

    def __post_init__(self) -> None:
        nodes = validation.unique_indices("Ring nodes", self.nodes, "node")
        if len(nodes) < 3:
            raise ValueError(f"Ring nodes is {nodes.tolist()}; give at least three.")
        validation.keep(self, nodes=nodes)
        if self.radius is not None:
            validation.store(self, validation.positive, "radius")


@dataclass(frozen=True, eq=False)
class RigidBody(ByValue):
    """Nodes that move and turn together in form finding, as those of a stiff head frame.

    Two nodes are the ends of a strut of given length; a `Mast` without prestress between them takes its force. Stays of
    given force do not bring a mast back upright, but balance it: from a held foot it stands where they do, within 45
    degrees of its start. Elsewhere it falls, with a warning that names the force missing: hold its head by supports
    then, and add both by `masts_and_stays`. Bars and supports take the forces of a body as those of a `Ring`.

    Args:
        nodes: The nodes, shape (k,), k >= 2.

    Raises:
        ValueError: There are fewer than two nodes.

    Example:
        >>> RigidBody([0, 1, 2, 3]).nodes.tolist()
        [0, 1, 2, 3]
    """

    nodes: ArrayLike

    def __post_init__(self) -> None:
        nodes = validation.unique_indices("RigidBody nodes", self.nodes, "node")
        if len(nodes) < 2:
            raise ValueError(f"RigidBody nodes is {nodes.tolist()}; give at least two.")
        validation.keep(self, nodes=nodes)


CableConstraint = CableForce | CableDensity | CableLength | CableSag | EdgeAngle
NodeConstraint = Slide | Ring | RigidBody
Constraint = CableConstraint | NodeConstraint
Constraints = Sequence[Constraint]
