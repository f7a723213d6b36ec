"""Prescribed displacements and stages, as plain data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..checks import validation
from .base_classes import AnyChange, AnyLoad
from .by_value import ByValue
from .changes import Change, check_change
from .energy_terms import Term
from .gas import GasChange, check_gas_change, refuse_two_gases
from .loads import Load, check_load, checked_loads
from .structure import Structure

INCREMENTS = 1_000_000  # maximum number of increments of a stage: all their iterates are kept


@dataclass(frozen=True, eq=False)
class PrescribedDisplacement(ByValue):
    """Nodes moved by a given displacement and held there.

    Args:
        nodes: A node number or several, shape (k,).
        displacement: Displacement from the reference position, one for all nodes, shape (3,), or one for each, (k, 3)
            [m].
        components: The prescribed components, some of "xyz"; the others stay free.

    Raises:
        ValueError: Nodes are not whole numbers; the displacement has a wrong shape or values that are not finite;
            components are not letters of "xyz".

    Example:
        >>> PrescribedDisplacement([2, 3], (0, 0, 0.05), "z").displacement.tolist()
        [0.0, 0.0, 0.05]
    """

    nodes: ArrayLike
    displacement: ArrayLike
    components: str = "xyz"

    def __post_init__(self) -> None:
        validation.store(self, validation.indices, "nodes")
        validation.store(self, validation.finite, "displacement")
        validation.store(self, validation.letters, "components")
        nodes, displacement = np.asarray(self.nodes), np.asarray(self.displacement)
        if displacement.shape not in ((3,), (len(nodes), 3)):
            raise ValueError(
                f"PrescribedDisplacement displacement is {validation.short_repr(displacement)}; give three components "
                f"(x, y, z), or three for each of the {len(nodes)} nodes."
            )


@dataclass(frozen=True, eq=False)
class Stage(ByValue):
    """Load case: the loads to apply, the number of increments, and the stage that it follows.

    Args:
        name: Name of the stage; its results are found under it.
        loads: Loads that this stage adds; also terms of your own, see `EnergyTerm`.
        displacements: Displacements that this stage prescribes.
        increments: Number of equal load increments to begin with, at most a million; a failed one is halved, see
            `Analysis`.
        after: Name of the stage that ends where this one starts; its loads, prescribed displacements and changes are
            kept; without it the stage starts from the reference shape.
        changes: Changes of natural shape, prestress and forces, made one after the other: `TemperatureChange`,
            `LengthChange`, `UnstressedLength`, `NaturalStretch`, `PrestressFactor`, `GivenForce`, `FixedLength`;
            and of the gas in chambers and the air around: `GasPressure`, `GasVolume`, `GasAmount`, `Seal`, `Ambient`.

    Raises:
        ValueError: increments is not a positive whole number, or more than a million; an entry is no load, prescribed
            displacement or change, or is of a class derived from one.

    Example:
        >>> snow = Stage("snow", [DistributedLoad((0, 0, -600.0), "roof")], after="prestress", increments=2)
        >>> snow.name, snow.after, snow.increments
        ('snow', 'prestress', 2)
    """

    name: str
    loads: Sequence[Load] = ()
    displacements: Sequence[PrescribedDisplacement] = ()
    increments: int = 1
    after: str | None = None
    changes: Sequence[Change | GasChange] = ()

    if TYPE_CHECKING:  # lists of several kinds

        def __init__(
            self,
            name: str,
            loads: Sequence[AnyLoad | Term] = ...,
            displacements: Sequence[PrescribedDisplacement] = ...,
            increments: int = ...,
            after: str | None = ...,
            changes: Sequence[AnyChange] = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        validation.keep(self, name=validation.name("stage", self.name))
        what = f"Stage {self.name!r}:"
        moves = validation.instances(f"{what} displacements", self.displacements, PrescribedDisplacement)
        _refuse_misplaced(f"{what} loads", self.loads)
        validation.keep(self, loads=checked_loads(f"{what} loads", self.loads), displacements=moves)
        validation.keep(self, changes=validation.instances(f"{what} changes", self.changes, Change | GasChange))
        refuse_two_gases(what, self.changes)
        validation.keep(
            self, increments=validation.positive_integer(f"{what} increments", self.increments, most=INCREMENTS)
        )
        if self.after is not None:
            validation.keep(self, after=validation.text(f"{what} after", self.after))


def _refuse_misplaced(what: str, loads: Any) -> None:
    """Refuse changes and prescribed displacements that are given as loads."""
    for load in loads if isinstance(loads, list | tuple) else ():
        for kind, place in ((Change | GasChange, "changes"), (PrescribedDisplacement, "displacements")):
            if isinstance(load, kind):
                raise ValueError(f"{what} has {validation.short_repr(load)}, which is no load; give it in {place}.")


def check_stages(structure: Structure, stages: Sequence[Stage]) -> None:
    """Refuse stages that do not fit together or do not fit the structure.

    Raises:
        ValueError: Two stages have one name; a stage follows one that does not come before it; a load or a prescribed
            displacement is on an unknown node, part or cell; one is on a node that no part uses; a pressure is on a
            membrane without two sides, see `Structure.normals`.
    """
    validation.instances("stages", stages, Stage)
    validation.unique("Stage", (stage.name for stage in stages))
    for position, stage in enumerate(stages):
        _check_order(stage, stages[:position], stages[position + 1 :])
        for load in stage.loads:
            check_load(structure, f"Stage {stage.name!r}", load)
        for change in stage.changes:
            if isinstance(change, GasChange):
                check_gas_change(structure, f"Stage {stage.name!r}", change)
            else:
                check_change(structure, f"Stage {stage.name!r}", change)
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
