"""Loads, prescribed displacements and stages, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..checks import validation
from .structure import Structure

STEPS = 1_000_000  # maximum number of increments of a stage: all their iterates are kept


@dataclass(frozen=True, eq=False)
class PointLoad:
    """Equal force on each of some nodes.

    Args:
        nodes: A node number or several, each once, shape (k,).
        force: Force on each node, shape (3,) [N].

    Raises:
        ValueError: Nodes are not whole numbers, or one is named twice; the force is not three finite numbers.
    """

    nodes: ArrayLike
    force: ArrayLike

    def __post_init__(self) -> None:
        validation.keep(self, nodes=validation.distinct("PointLoad nodes", self.nodes, "node"))
        validation.store(self, validation.vector, "force")


@dataclass(frozen=True, eq=False)
class _SpreadLoad:
    """Common fields of loads of fixed direction that are spread over cells."""

    load: ArrayLike
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.vector, "load")
        _check_cells(self)


@dataclass(frozen=True, eq=False)  # repeated so that Python's TypeError names DeadLoad
class DeadLoad(_SpreadLoad):
    """A load of fixed direction, spread over the reference area of a membrane or the length of cables or masts.

    Args:
        load: Load per reference area [N/m2] or per reference length [N/m], shape (3,).
        part: Name of the part.
        cells: The loaded cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The load is not three finite numbers; part is not a text; cells are not whole numbers, or one is
            named twice.
    """


@dataclass(frozen=True, eq=False)  # repeated so that Python's TypeError names PlanLoad
class PlanLoad(_SpreadLoad):
    """A load of fixed direction per plan area of the reference shape, as snow is given: per area of the xy-plane.

    Each cell takes its own plan area: for a closed cushion name the cells of the upper skin only.

    Args:
        load: Load per plan area [N/m2], shape (3,).
        part: Name of the membrane.
        cells: The loaded cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: As for `DeadLoad`.
    """


@dataclass(frozen=True, eq=False)
class Pressure:
    """A pressure that follows the membrane: per current area, along its current normal.

    Args:
        pressure: Positive along `Structure.normals(part)` [Pa].
        part: Name of the membrane.
        cells: The loaded cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The pressure is not a finite number; part and cells as for `DeadLoad`.
    """

    pressure: float
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.number, "pressure")
        _check_cells(self)


def _check_cells(load: _SpreadLoad | Pressure) -> None:
    """Check the part and the cells of a load, and keep a copy of the cell numbers."""
    validation.store(load, validation.text, "part")
    if load.cells is not None:
        validation.keep(load, cells=validation.distinct(f"{type(load).__name__} cells", load.cells, "cell"))


Load = PointLoad | DeadLoad | PlanLoad | Pressure


@dataclass(frozen=True, eq=False)
class PrescribedDisplacement:
    """Nodes moved by a given displacement and held there.

    Args:
        nodes: A node number or several, shape (k,).
        displacement: Displacement from the reference position, one for all nodes, shape (3,), or one for each, (k, 3)
            [m].
        components: The prescribed components, some of "xyz"; the others stay free.

    Raises:
        ValueError: Nodes are not whole numbers; the displacement has a wrong shape or values that are not finite;
            components are not letters of "xyz".
    """

    nodes: ArrayLike
    displacement: ArrayLike
    components: str = "xyz"

    def __post_init__(self) -> None:
        validation.store(self, validation.rows, "nodes")
        validation.store(self, validation.finite, "displacement")
        validation.store(self, validation.letters, "components")
        nodes, displacement = np.asarray(self.nodes), np.asarray(self.displacement)
        if displacement.shape not in ((3,), (len(nodes), 3)):
            raise ValueError(
                f"PrescribedDisplacement displacement is {validation.shown(displacement)}; give three components "
                f"(x, y, z), or three for each of the {len(nodes)} nodes."
            )


@dataclass(frozen=True, eq=False)
class Stage:
    """Load case: the loads to apply, the number of increments, and the stage that it follows.

    Args:
        name: Name of the stage; its results are found under it.
        loads: Loads that this stage adds.
        displacements: Displacements that this stage prescribes.
        steps: Number of equal load increments to begin with, at most a million; a failed one is halved, see `Analysis`.
        after: Name of the stage whose final state is the start of this one, and whose loads and prescribed
            displacements it keeps; without it the stage starts from the reference shape.

    Raises:
        ValueError: steps is not a positive whole number, or more than a million; an entry is not a load or a prescribed
            displacement, or is of a class derived from one.
    """

    name: str
    loads: Sequence[Load] = ()
    displacements: Sequence[PrescribedDisplacement] = ()
    steps: int = 1
    after: str | None = None

    def __post_init__(self) -> None:
        validation.keep(self, name=validation.name("stage", self.name))
        what = f"Stage {self.name!r}:"
        moves = validation.instances(f"{what} displacements", self.displacements, PrescribedDisplacement)
        validation.keep(self, loads=validation.instances(f"{what} loads", self.loads, Load), displacements=moves)
        validation.keep(self, steps=validation.whole(f"{what} steps", self.steps, most=STEPS))
        if self.after is not None:
            validation.keep(self, after=validation.text(f"{what} after", self.after))


def check(structure: Structure, stages: Sequence[Stage]) -> None:
    """Refuse stages that do not fit together or do not fit the structure.

    Raises:
        ValueError: Two stages have one name; a stage follows one that does not come before it; a load or a
            prescribed displacement names a node, part or cell that does not exist, or a node that no part uses; a
            pressure is on a membrane without two sides, see `Structure.normals`.
    """
    validation.instances("stages", stages, Stage)
    validation.unique("Stage", (stage.name for stage in stages))
    for position, stage in enumerate(stages):
        _check_order(stage, stages[:position], stages[position + 1 :])
        for load in stage.loads:
            _check_load(structure, f"Stage {stage.name!r}", load)
        for entry in stage.displacements:
            structure.check_nodes(f"Stage {stage.name!r}: a prescribed displacement", np.asarray(entry.nodes))


def _check_order(stage: Stage, earlier: Sequence[Stage], later: Sequence[Stage]) -> None:
    """Refuse a stage that follows one which is not among those before it."""
    names = [other.name for other in earlier]
    if stage.after is None or stage.after in names:
        return
    exist = f"the stages before it are {names}" if names else "no stage is before it"
    remedy = "correct the name, or leave `after` out to start from the reference shape"
    if stage.after in (other.name for other in later):
        remedy = f"put {stage.after!r}, which comes later in the list, before it"
    elif stage.after == stage.name:
        remedy = "name another, or leave `after` out to start from the reference shape"
    raise ValueError(f"Stage {stage.name!r} is to follow {stage.after!r}, but {exist}; {remedy}.")


def _check_load(structure: Structure, stage: str, load: Load) -> None:
    if isinstance(load, PointLoad):
        structure.check_nodes(f"{stage}: a point load", np.asarray(load.nodes))
        return
    if load.part not in structure.parts:
        raise ValueError(
            f"{stage} has a load on part {load.part!r}, which does not exist; the parts are {list(structure.parts)}."
        )
    part = structure.parts[load.part]
    if isinstance(load, PlanLoad | Pressure) and part.dimension != 2:
        raise ValueError(
            f"{stage} has a {type(load).__name__} on {load.part!r}, a {type(part).__name__}; it acts on membranes, on "
            "cables and masts give a DeadLoad."
        )
    if isinstance(load, Pressure):
        structure.check_sides(load.part)
    if load.cells is not None:
        validation.in_range(f"{stage}: a load on part {load.part!r}", np.asarray(load.cells), len(part.cells), "cell")
