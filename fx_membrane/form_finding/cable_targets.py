"""Force densities of cables towards forces, lengths, sags and angles, from one shape to the next.

A line of a cable has one unknown: its force in the measure of the method, the same in all its cells. The larger it is,
the shorter and straighter is the line. A step multiplies it by the ratio that a shallow arc of given load asks for,
whose sag and force are inverse to each other; acceleration makes the steps few.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.measures import measures
from ..model.parts import Cable, Mast, Membrane
from ..model.structure import Structure
from .cable_forces import densities_of, measured_lengths
from .cable_lines import Line, lines_of
from .constraints import CableConstraint, CableDensity, CableForce, CableLength, CableSag, EdgeAngle
from .plan import place as place_of

Array = NDArray[np.float64]

MET = 1e-8  # accepted difference of length, sag or angle from the wanted one, relative to the latter
STRAIGHT = 1e-9  # relative excess of a length over the distance of its ends, that no finite force gives
STEP = 30.0  # largest factor on a force in one step
FLOOR = 1e-6  # relative excess of a force over the prestress, above which an angle is what decides it
RANGE = 1e9  # factor on the first guess of a force, beyond which none is looked for


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


class CableTargets:
    """Wanted force densities of all bars of a structure in a shape.

    Args:
        structure: The structure in its first shape.
        constraints: Constraints of cables.
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].
        measure: Meaning of the prestress of cables, one of `MEASURES`.

    Raises:
        ValueError: A constraint does not fit its cable.
    """

    def __init__(self, structure: Structure, constraints: Sequence[CableConstraint], axes: Array, measure: str) -> None:
        bars = {name: part for name, part in structure.parts.items() if isinstance(part, Cable | Mast)}
        forces = {name: part.prestress_tensors().ravel().copy() for name, part in bars.items()}
        self.kinds = {name: np.full(len(part.cells), measure, dtype=object) for name, part in bars.items()}
        self.axes, self.targets = axes, list[Target]()
        for constraint, cells in _distinct(structure, constraints):
            if isinstance(constraint, CableForce):
                forces[constraint.part][cells] = constraint.force
                self.kinds[constraint.part][cells] = "horizontal force" if constraint.horizontal else "force"
            elif isinstance(constraint, CableDensity):
                forces[constraint.part][cells] = constraint.density
                self.kinds[constraint.part][cells] = "force density"
            else:
                self.targets += _targets(structure, constraint, cells)
        self.bars = {name: replace(part, prestress=forces[name]) for name, part in bars.items()}
        self.points = structure.points
        self.first: list[float] = []

    def start(self, guess: float) -> dict[str, Array]:
        """Force densities of the first step, by part, shape (cells,) [N/m].

        Args:
            guess: Least force to begin with where the geometry of a cable is given [N]: from a large one, every load
                finds its shape.
        """
        found = self.by_force(self.points)
        for name, line, *_ in self.targets:
            length = measures(self.points, self.bars[name].cells[line.cells])
            found[name][line.cells] = np.maximum(found[name][line.cells], guess / length)
            self.first.append(_mean(found[name][line.cells]))
        return found

    def wanted(self, points: Array, densities: Mapping[str, Array], reference: Array | None = None) -> dict[str, Array]:
        """Force densities that a shape asks for, by part, shape (cells,) [N/m].

        Args:
            points: The shape, shape (n, 3) [m].
            densities: Those of the shape.
            reference: Shape in which the force is the same along a line, shape (n, 3) [m]; the shape itself if not
                given.

        Raises:
            ValueError: A cable of given horizontal force has no length in plan.
        """
        found = self.by_force(points)
        for name, line, constraint, is_anchored, least in self.targets:
            part, loaded = self.bars[name], np.zeros(len(found[name]), dtype=bool)
            loaded[line.cells] = True
            place = points if reference is None else reference
            length = measured_lengths(name, part, place, self.axes, self.kinds[name], loaded)[line.cells]
            factor = np.clip(_factor(line, constraint, points, is_anchored), 1 / STEP, STEP)
            q = _mean(densities[name][line.cells] * length) * factor / length
            if isinstance(constraint, EdgeAngle):
                given = part.prestress_tensors().ravel()[line.cells]
                q = np.maximum(q, (given if reference is None else np.maximum(given, least)) / length)
            found[name][line.cells] = q
        return found

    def mixed(self, densities: Mapping[str, Array], wanted: Mapping[str, Array]) -> dict[str, Array]:
        """Force densities with those wanted by lines of given geometry only, by part, shape (cells,) [N/m]."""
        found = {name: q.copy() for name, q in densities.items()}
        for name, line, *_ in self.targets:
            found[name][line.cells] = wanted[name][line.cells]
        return found

    def asked(self, points: Array, densities: Mapping[str, Array]) -> dict[str, Cable | Mast]:
        """Bars with the forces asked for in a shape as prestress; lines of given geometry have those they carry."""
        wanted = self.mixed(self.by_force(points), densities)
        return {
            name: replace(bar, prestress=wanted[name] * measures(points, bar.cells)) for name, bar in self.bars.items()
        }

    def miss(self, points: Array, densities: Mapping[str, Array], wanted: Mapping[str, Array]) -> tuple[float, str]:
        """Largest difference from a wanted length, sag or angle, relative to it [-], and the words for it.

        Args:
            points: The shape, shape (n, 3) [m].
            densities: Force densities of the shape.
            wanted: Those that it asks for.
        """
        worst, words = 0.0, ""
        for name, line, constraint, *_ in self.targets:
            now, goal, unit = _value(line, constraint, points)
            off = abs(now / goal - 1)
            if isinstance(constraint, EdgeAngle) and now < goal:  # by the prestress, as far as it is asked for
                change = np.abs(densities[name][line.cells] / wanted[name][line.cells] - 1).max()
                off = float(change) if change > FLOOR else 0.0
            if off > worst:
                worst, words = (
                    off,
                    (
                        f"the {_named(name, line, points)} has the {_noun(constraint)} {now:.6g}{unit} instead of "
                        f"{goal:.6g}{unit}"
                    ),
                )
        return worst, words

    def out_of_range(self, points: Array, densities: Mapping[str, Array]) -> str:
        """Tell of a line that has its wanted geometry under no force, in words; empty without one."""
        for first, (name, line, constraint, is_anchored, _) in zip(self.first, self.targets, strict=True):
            now, goal, unit = _value(line, constraint, points)
            if is_anchored and line.sag(points, _along(constraint)) <= STRAIGHT * line.length(points):
                return (
                    f"the {_named(name, line, points)} has no sag under any force, as no load and no membrane pulls it "
                    f"that way; it cannot have the {_noun(constraint)} {goal:.6g}{unit}: give its force instead."
                )
            mean = _mean(densities[name][line.cells])
            if not 1 / RANGE < mean / first < RANGE:
                return (
                    f"the {_named(name, line, points)} reaches the {_noun(constraint)} {goal:.6g}{unit} under no "
                    f"force: it is {now:.4g}{unit} with the mean force density {mean:.3g}; give a value nearer to "
                    "that, draw the line nearer to its form at the start, or move its ends."
                )
        return ""

    def by_force(self, points: Array) -> dict[str, Array]:
        """Force densities of given forces and densities in a shape, by part, shape (cells,) [N/m]."""
        return densities_of(self.bars, points, self.axes, self.kinds)


def _distinct(
    structure: Structure, constraints: Sequence[CableConstraint]
) -> list[tuple[CableConstraint, NDArray[np.int64]]]:
    """Constraints and the numbers of their cells, each cell in one of them only."""
    taken = {name: np.zeros(len(part.cells), dtype=bool) for name, part in structure.parts.items()}
    found = []
    for constraint in constraints:
        name, kind = constraint.part, type(constraint).__name__
        part = structure.part(name, Cable)
        cells = np.arange(len(part.cells)) if constraint.cells is None else np.asarray(constraint.cells)
        validation.in_range(f"{kind} of part {name!r}", cells, len(part.cells), "cell")
        twice = cells[taken[name][cells]]
        if len(twice):
            raise ValueError(
                f"Part {name!r}, cell {twice[0]} at {place_of(structure.points, part.cells, twice[0])} has two "
                "constraints; leave out one of them, or name the cells of each (cells=...)."
            )
        taken[name][cells] = True
        found.append((constraint, cells))
    return found


def _targets(structure: Structure, constraint: Geometry, cells: NDArray[np.int64]) -> list[Target]:
    """Lines of a constraint.

    Raises:
        ValueError: A line cannot have the geometry wanted.
    """
    held, name, points = structure.supported.all(axis=1), constraint.part, structure.points
    lines = lines_of(structure.parts[name].cells, cells, held)
    for line in lines:
        who = "The " + _named(name, line, points)
        if isinstance(constraint, CableLength):
            apart = line.chord(points) if held[line.nodes[[0, -1]]].all() else 0.0
            if constraint.length <= apart * (1 + STRAIGHT):
                raise ValueError(
                    f"{who} is to have the length {constraint.length:.6g}, and its held ends are {apart:.6g} apart; "
                    "give a larger length."
                )
            if len(line.cells) == 1 and apart:
                raise ValueError(f"{who} is one segment between held ends, whose length is given; divide it.")
        elif isinstance(constraint, CableSag) and constraint.along is not None and _is_along(line, constraint, points):
            raise ValueError(f"{who} has its chord along the direction of its sag; give another direction (along=...).")
        elif line.is_closed:
            raise ValueError(f"{who} is closed, so it has no chord; give its length (CableLength) or its force.")
        elif len(line.cells) == 1:
            raise ValueError(f"{who} is one segment, which stays straight; divide it for a {_noun(constraint)}.")
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
    for part in structure.parts.values():
        if isinstance(part, Membrane):
            beside = part.prestress_tensors()[on_line[part.cells].sum(axis=1) > 1]
            least = min(least, float(np.linalg.eigvalsh(beside).min(initial=np.inf)))
    radius = line.chord(structure.points) / 2 / np.sin(np.radians(constraint.angle))
    return float(least * radius) if np.isfinite(least) else 0.0


def _value(line: Line, constraint: Geometry, points: Array) -> tuple[float, float, str]:
    """Value of a line in a shape, the wanted one, and their unit in words."""
    if isinstance(constraint, CableLength):
        return line.length(points), constraint.length, ""
    if isinstance(constraint, CableSag):
        return line.sag(points, _along(constraint)), constraint.sag, ""
    return float(np.degrees(line.angle(points))), constraint.angle, " degrees"


def _factor(line: Line, constraint: Geometry, points: Array, is_anchored: bool) -> float:
    """Factor on the force of a line that brings it near the wanted geometry."""
    now, goal, _ = _value(line, constraint, points)
    if isinstance(constraint, EdgeAngle):
        return float(np.tan(np.radians(now) / 2) / np.tan(np.radians(goal) / 2))
    if isinstance(constraint, CableLength) and is_anchored and not line.is_closed:
        chord = line.chord(points)
        return float(np.sqrt(max(now - chord, 0.0) / (goal - chord)))
    return now / goal


def _along(constraint: Geometry) -> Array | None:
    """Direction in which the sag of a line is measured; None normal to its chord."""
    given = constraint.along if isinstance(constraint, CableSag) else None
    return None if given is None else validation.direction("along", given)


def _is_along(line: Line, constraint: CableSag, points: Array) -> bool:
    """Return True if the chord of a line has the direction of its sag."""
    chord = points[line.nodes[-1]] - points[line.nodes[0]]
    across = np.cross(chord, validation.direction("along", constraint.along))  # type: ignore[arg-type]
    return bool(np.linalg.norm(across) <= STRAIGHT * np.linalg.norm(chord)) and not line.is_closed


def _noun(constraint: Geometry) -> str:
    return {CableLength: "length", CableSag: "sag", EdgeAngle: "edge angle"}[type(constraint)]


def _named(name: str, line: Line, points: Array) -> str:
    ends = [validation.format_point(points[node]) for node in line.nodes[[0, -1]]]
    return f"line of cable {name!r} from node {line.nodes[0]} at {ends[0]} to node {line.nodes[-1]} at {ends[1]}"


def _mean(values: Array) -> float:
    """Geometric mean."""
    return float(np.exp(np.log(values).mean()))
