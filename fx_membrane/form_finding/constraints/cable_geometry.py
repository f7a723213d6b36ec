"""Lines of cables with a wanted length, sag or angle: their values, and what to do to come nearer."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...checks import validation
from ...model.structure import Structure
from .cable_lines import Line, lines_of
from .kinds import CableLength, CableSag, EdgeAngle

Array = NDArray[np.float64]

STRAIGHT_EXCESS = 1e-9  # relative excess of a length over the distance of its ends, that no finite force gives

Geometry = CableLength | CableSag | EdgeAngle


class Target(NamedTuple):
    """Line of a cable and the constraint on it.

    Attributes:
        part: Name of the cable.
        line: The line.
        constraint: Its constraint.
        is_anchored: True if it has several segments between held ends.
        least: Force that an angle asks for at least, where steps go from shape to shape [N].
    """

    part: str
    line: Line
    constraint: Geometry
    is_anchored: bool
    least: float


def _lines(structure: Structure, name: str, cells: NDArray[np.int64], guided: NDArray[np.bool_]) -> list[Line]:
    """Lines of cells of a cable; a closed one is divided where supports, constraints or other bars hold it."""
    supported, part = structure.supported, structure.parts[name]
    corners = supported.any(axis=1) | guided
    for other in structure.bars.values():
        if other is not part:
            corners[other.cells] = True
    lines = []
    for line in lines_of(part.cells, cells, supported.all(axis=1)):
        lines += lines_of(part.cells, line.cells, corners) if line.is_closed else [line]
    return lines


def targets_of(
    structure: Structure, constraint: Geometry, cells: NDArray[np.int64], guided: NDArray[np.bool_]
) -> list[Target]:
    """Lines of a constraint.

    Raises:
        ValueError: A line cannot have the geometry wanted.
    """
    held, name, points = structure.supported.all(axis=1), constraint.part, structure.points
    lines = _lines(structure, name, cells, guided)
    for line in lines:
        who = "The " + named(name, line, points)
        if isinstance(constraint, CableLength):
            apart = line.chord(points) if held[line.nodes[[0, -1]]].all() else 0.0
            if constraint.length <= apart * (1 + STRAIGHT_EXCESS):
                raise ValueError(
                    f"{who} is to have the length {constraint.length:.6g}, and its held ends are {apart:.6g} apart; "
                    "give a larger length."
                )
            if len(line.cells) == 1 and apart:
                raise ValueError(f"{who} is one segment between held ends, whose length is given; divide it.")
        elif isinstance(constraint, CableSag) and constraint.along is not None and _is_along(line, constraint, points):
            raise ValueError(f"{who} has its chord along the direction of its sag; give another direction (along=...).")
        elif line.is_closed:
            raise ValueError(
                f"{who} is closed, so it has no chord; name the cells of a piece (cells=...), or give its length."
            )
        elif len(line.cells) == 1:
            raise ValueError(f"{who} is one segment, which stays straight; divide it for a {noun(constraint)}.")
    anchored = [len(line.cells) > 1 and bool(held[line.nodes[[0, -1]]].all()) for line in lines]
    return [
        Target(name, line, constraint, is_anchored, _least(structure, line, constraint))
        for line, is_anchored in zip(lines, anchored, strict=True)
    ]


def _least(structure: Structure, line: Line, constraint: Geometry) -> float:
    """Force of a plane arc of a given angle in the least stress of the membranes beside it [N].

    A linear step from a straight edge reaches no deep arc; without this force, weak edges collapse in the next step.
    """
    if not isinstance(constraint, EdgeAngle):
        return 0.0
    on_line, least = np.zeros(len(structure.points), dtype=bool), np.inf
    on_line[line.nodes] = True
    for part in structure.membranes.values():
        beside = part.prestress_tensors()[on_line[part.cells].sum(axis=1) > 1]
        least = min(least, float(np.linalg.eigvalsh(beside).min(initial=np.inf)))
    radius = line.chord(structure.points) / 2 / np.sin(np.radians(constraint.angle))
    return float(least * radius) if np.isfinite(least) else 0.0


def value(line: Line, constraint: Geometry, points: Array) -> tuple[float, float, str]:
    """Value of a line in a shape, the wanted one, and their unit in words."""
    if isinstance(constraint, CableLength):
        return line.length(points), constraint.length, ""
    if isinstance(constraint, CableSag):
        return line.sag(points, along_of(constraint)), constraint.sag, ""
    return float(np.degrees(line.angle(points))), constraint.angle, " degrees"


def factor(line: Line, constraint: Geometry, points: Array, is_anchored: bool) -> float:
    """Factor on the force of a line that brings it near the wanted geometry."""
    now, goal, _ = value(line, constraint, points)
    if isinstance(constraint, EdgeAngle):
        return float(np.tan(np.radians(now) / 2) / np.tan(np.radians(goal) / 2))
    if isinstance(constraint, CableLength) and is_anchored and not line.is_closed:
        chord = line.chord(points)
        return float(np.sqrt(max(now - chord, 0.0) / (goal - chord)))
    return now / goal


def along_of(constraint: Geometry) -> Array | None:
    """Direction in which the sag of a line is measured; None normal to its chord."""
    given = constraint.along if isinstance(constraint, CableSag) else None
    return None if given is None else validation.direction("along", given)


def _is_along(line: Line, constraint: CableSag, points: Array) -> bool:
    """Return True if the chord of a line has the direction of its sag."""
    chord = points[line.nodes[-1]] - points[line.nodes[0]]
    across = np.cross(chord, validation.direction("along", constraint.along))  # type: ignore[arg-type]
    return bool(np.linalg.norm(across) <= STRAIGHT_EXCESS * np.linalg.norm(chord)) and not line.is_closed


def noun(constraint: Geometry) -> str:
    """Name the measure of a constraint in messages."""
    return {CableLength: "length", CableSag: "sag", EdgeAngle: "edge angle"}[type(constraint)]


def named(name: str, line: Line, points: Array) -> str:
    """Name a line by its ends in messages."""
    ends = [validation.format_point(points[node]) for node in line.nodes[[0, -1]]]
    return f"line of cable {name!r} from node {line.nodes[0]} at {ends[0]} to node {line.nodes[-1]} at {ends[1]}"
