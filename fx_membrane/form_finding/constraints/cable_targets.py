"""Force densities of cables towards forces, lengths, sags and angles, from one shape to the next.

A line of a cable has one unknown: its force in the measure of the method, the same in all its cells. The larger it is,
the shorter and straighter is the line. A step multiplies it by the ratio for a shallow arc of given load: its sag and
force are inverse to each other; acceleration makes the steps few.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...checks import validation
from ...geometry.sizes import measures
from ...model.parts import Cable, Line
from ...model.structure import Structure
from ..balance.cable_forces import densities_of, measured_lengths
from ..plan import place as place_of
from .cable_geometry import STRAIGHT_EXCESS, Target, along_of, factor, named, noun, targets_of, value
from .kinds import CableConstraint, CableDensity, CableForce, EdgeAngle

Array = NDArray[np.float64]

# Ranges: tests/benchmarks/form_finding_constants.py, on 31 ropes and canopies of each kind of constraint.
# Accepted difference of length, sag or angle from the wanted one, relative to the latter. Ten times as much moves ropes
# that are longer than their span by 1e-5 by 4e-7 of their size; a step or two go to each digit.
TARGET_ERROR = 1e-10
TOLD_FORCE_ERROR = 1e-3  # the same, of a force from that of a constraint; no word changes from 1e-4 to 1e-2
# Largest factor on a force in one step; forms are the same from 3 to 30, another one is found with 300.
MAX_FORCE_FACTOR = 10.0
FLOOR = 1e-6  # relative excess of a force over the prestress, above which an angle is what decides it; the same below
RANGE = 1e9  # factor on the first guess of a force, beyond which none is looked for; the same from 1e8 to 1e10


class CableTargets:
    """Wanted force densities of all bars of a structure in a shape.

    Args:
        structure: The structure in its first shape.
        constraints: Constraints of cables.
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].
        measure: Meaning of the prestress of cables, one of `MEASURES`.
        guided: Nodes with a constraint of their own, shape (n,).

    Raises:
        ValueError: A constraint does not fit its cable.
    """

    def __init__(
        self,
        structure: Structure,
        constraints: Sequence[CableConstraint],
        axes: Array,
        measure: str,
        guided: NDArray[np.bool_],
    ) -> None:
        bars = structure.bars
        forces = {name: part.prestress_tensors().ravel().copy() for name, part in bars.items()}
        self.kinds = {name: np.full(len(part.cells), measure, dtype=object) for name, part in bars.items()}
        self.axes, self.targets = axes, list[Target]()
        self.given: list[tuple[CableForce | CableDensity, NDArray[np.int64]]] = []
        for constraint, cells in _distinct(structure, constraints):
            if isinstance(constraint, CableForce):
                forces[constraint.part][cells] = constraint.force
                self.kinds[constraint.part][cells] = "horizontal force" if constraint.horizontal else "force"
            elif isinstance(constraint, CableDensity):
                forces[constraint.part][cells] = constraint.density
                self.kinds[constraint.part][cells] = "force density"
            else:
                self.targets += targets_of(structure, constraint, cells, guided)
            if isinstance(constraint, CableForce | CableDensity):
                self.given.append((constraint, cells))
        self.bars = {name: replace(part, prestress=forces[name]) for name, part in bars.items()}
        self.points = structure.points
        self.first: list[float] = []

    def start(self, guess: float) -> dict[str, Array]:
        """Force densities of the first step, by part, shape (cells,) [N/m].

        Args:
            guess: Least force to begin with where the geometry of a cable is given [N]: from a large one, every load
                finds its shape.
        """
        found, self.first = self.by_force(self.points), []
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
            share = np.clip(factor(line, constraint, points, is_anchored), 1 / MAX_FORCE_FACTOR, MAX_FORCE_FACTOR)
            q = _mean(densities[name][line.cells] * length) * share / length
            if isinstance(constraint, EdgeAngle):
                given = part.prestress_tensors().ravel()[line.cells]
                q = np.maximum(q, (given if reference is None else np.maximum(given, least)) / length)
            found[name][line.cells] = q
        return found

    def mixed(
        self, densities: Mapping[str, Array], wanted: Mapping[str, Array], forces: bool = False
    ) -> dict[str, Array]:
        """Force densities with those wanted by lines of given geometry only, by part, shape (cells,) [N/m].

        With `forces`, those wanted by constraints of force are taken, too.
        """
        found = {name: q.copy() for name, q in densities.items()}
        for constraint, cells in self.given if forces else ():
            found[constraint.part][cells] = wanted[constraint.part][cells]
        for name, line, *_ in self.targets:
            found[name][line.cells] = wanted[name][line.cells]
        return found

    def asked(self, points: Array, densities: Mapping[str, Array]) -> dict[str, Line]:
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
            now, goal, unit = value(line, constraint, points)
            off = abs(now / goal - 1)
            if isinstance(constraint, EdgeAngle) and now < goal:  # by the prestress, as far as it is asked for
                change = np.abs(densities[name][line.cells] / wanted[name][line.cells] - 1).max()
                off = float(change) if change > FLOOR else 0.0
            if off > worst:
                worst, words = (
                    off,
                    (
                        f"the {named(name, line, points)} has the {noun(constraint)} {now:.6g}{unit} instead of "
                        f"{goal:.6g}{unit}"
                    ),
                )
        return worst, words

    def off(self, points: Array, densities: Mapping[str, Array]) -> str:
        """Tell of the cable that is farthest from the force or force density of its constraint; empty if all are near.

        Args:
            points: The shape.
            densities: Force densities in it.
        """
        wanted, worst, words = self.by_force(points), TOLD_FORCE_ERROR, ""
        for constraint, cells in self.given:
            ratio = densities[constraint.part][cells] / wanted[constraint.part][cells]
            cell = int(np.abs(ratio - 1).argmax())
            if abs(ratio[cell] - 1) > worst:
                worst = abs(ratio[cell] - 1)
                where = place_of(points, self.bars[constraint.part].cells, cells[cell])
                words = (
                    f"Cell {cells[cell]} of cable {constraint.part!r}, at {where}, has {ratio[cell]:.6g} times the "
                    f"{'force' if isinstance(constraint, CableForce) else 'force density'} of its constraint."
                )
        return words

    def out_of_range(self, points: Array, densities: Mapping[str, Array]) -> str:
        """Tell of a line that has its wanted geometry under no force, in words; empty without one."""
        for first, (name, line, constraint, is_anchored, _) in zip(self.first, self.targets, strict=True):
            now, goal, unit = value(line, constraint, points)
            if is_anchored and line.sag(points, along_of(constraint)) <= STRAIGHT_EXCESS * line.length(points):
                return (
                    f"the {named(name, line, points)} has no sag under any force, as no load and no membrane pulls it "
                    f"that way; it cannot have the {noun(constraint)} {goal:.6g}{unit}: give its force instead."
                )
            mean = _mean(densities[name][line.cells])
            if not 1 / RANGE < mean / first < RANGE:
                return (
                    f"no force gives the {named(name, line, points)} the {noun(constraint)} {goal:.6g}{unit}: it is "
                    f"{now:.4g}{unit} with a mean force density of {mean:.3g}; give a value nearer to that, draw the "
                    "line nearer to its form at the start, or move its ends."
                )
        return ""

    def by_force(self, points: Array) -> dict[str, Array]:
        """Force densities of given forces and densities in a shape, by part, shape (cells,) [N/m]."""
        return densities_of(self.bars, points, self.axes, self.kinds)

    def by_density(self, points: Array) -> dict[str, Array]:
        """Force densities of cells that are given by them, zero of others, by part, shape (cells,) [N/m]."""
        found = self.by_force(points)
        for name, line, *_ in self.targets:
            found[name][line.cells] = 0.0
        return {name: np.where(self.kinds[name] == "force density", q, 0.0) for name, q in found.items()}


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


def _mean(values: Array) -> float:
    """Geometric mean."""
    return float(np.exp(np.log(values).mean()))
