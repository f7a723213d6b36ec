"""Loads, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.sizes import normals
from . import energy_terms
from .base_classes import AnyLoad
from .energy_terms import Term
from .ponds import Pond, check_pond
from .structure import Structure


@dataclass(frozen=True, eq=False)
class PointLoad(AnyLoad):
    """Equal force on each of some nodes.

    Args:
        nodes: A node number or several, each once, shape (k,).
        force: Force on each node, shape (3,) [N].

    Raises:
        ValueError: Nodes are not whole numbers, or one is named twice; the force is not three finite numbers.

    Example:
        >>> PointLoad(12, (0, 0, -1e3)).force.tolist()
        [0.0, 0.0, -1000.0]
    """

    nodes: ArrayLike
    force: ArrayLike

    def __post_init__(self) -> None:
        validation.keep(self, nodes=validation.unique_indices("PointLoad nodes", self.nodes, "node"))
        validation.store(self, validation.vector, "force")


@dataclass(frozen=True, eq=False)
class SpreadLoad(AnyLoad):
    """Common fields of loads of fixed direction that are spread over cells."""

    load: ArrayLike
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.vector, "load")
        _check_cells(self)


@dataclass(frozen=True, eq=False)  # repeated so that Python's TypeError names DistributedLoad
class DistributedLoad(SpreadLoad):
    """A load of fixed direction, spread over the reference area of a membrane or the length of cables or masts.

    Args:
        load: Load per reference area [N/m2] or per reference length [N/m], shape (3,).
        part: Name of the part.
        cells: The loaded cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The load is not three finite numbers; part is not a text; cells are not whole numbers, or one is
            named twice.

    Example:
        >>> DistributedLoad((0, 0, -600.0), "roof").load.tolist()
        [0.0, 0.0, -600.0]
    """


@dataclass(frozen=True, eq=False)  # repeated so that Python's TypeError names PlanLoad
class PlanLoad(SpreadLoad):
    """A load of fixed direction per plan area of the reference shape, as snow is given: per area of the xy-plane.

    Each cell takes its own plan area: for a closed cushion name the cells of the upper skin only.

    Args:
        load: Load per plan area [N/m2], shape (3,).
        part: Name of the membrane.
        cells: The loaded cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: As for `DistributedLoad`.

    Example:
        >>> PlanLoad((0, 0, -1e3), "roof", cells=[0, 1]).cells.tolist()
        [0, 1]
    """


@dataclass(frozen=True, eq=False)
class Pressure(AnyLoad):
    """A pressure that follows the membrane: per current area, along its current normal.

    Args:
        pressure: Positive along `Structure.normals(part)` [Pa].
        part: Name of the membrane.
        cells: The loaded cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The pressure is not a finite number; part and cells as for `DistributedLoad`.

    Example:
        >>> wind = Stage("wind", [Pressure(-800.0, "roof")], after="prestress")
        >>> wind.loads[0].pressure
        -800.0
    """

    pressure: float
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        if isinstance(self.pressure, list | tuple) or np.ndim(self.pressure):
            raise ValueError(
                f"Pressure pressure is {validation.short_repr(self.pressure)}; give one number for its `cells`, and an "
                "energy term for one that differs from cell to cell, see `EnergyTerm`."
            )
        validation.store(self, validation.number, "pressure")
        _check_cells(self)


def _check_cells(load: SpreadLoad | Pressure) -> None:
    """Check the part and the cells of a load, and keep a copy of the cell numbers."""
    validation.store(load, validation.text, "part")
    if load.cells is not None:
        validation.keep(load, cells=validation.unique_indices(f"{type(load).__name__} cells", load.cells, "cell"))


FormLoad = PointLoad | DistributedLoad | PlanLoad | Pressure  # in form finding, too
OwnLoad = FormLoad | Pond
Load = OwnLoad | Term


def per_size(load: SpreadLoad | Pressure, points: NDArray[np.float64], cells: NDArray[np.int64]) -> NDArray[np.float64]:
    """Force of a load per size of cells in a shape, shape (cells, 3) or (3,) [N/m2], on bars [N/m]."""
    if isinstance(load, Pressure):
        return np.asarray(load.pressure * normals(points, cells))
    if isinstance(load, PlanLoad):
        return np.asarray(np.abs(normals(points, cells)[:, 2:]) * np.asarray(load.load))
    return np.asarray(load.load)


def checked_loads(what: str, loads: Any) -> tuple[Load, ...]:
    """Make a tuple of loads, from any sequence of them; energy terms of a user's own are checked by their contract.

    Raises:
        ValueError: It is no sequence, or has another object or one of a derived class; a term does not keep to its
            contract.
    """
    return energy_terms.checked(what, loads, OwnLoad)


def check_load(structure: Structure, stage: str, load: Load) -> None:
    """Refuse a load on an unknown node, part or cell, or on a part that it cannot act on."""
    if energy_terms.is_term(load):
        energy_terms.check_on(structure, stage, load)
        return
    assert isinstance(load, OwnLoad)
    if isinstance(load, Pond):
        check_pond(structure, stage, load)
        return
    if isinstance(load, PointLoad):
        structure.check_nodes(f"{stage}: a point load", np.asarray(load.nodes))
        return
    if load.part not in structure.parts:
        raise ValueError(
            f"{stage} has a load on part {load.part!r}, which does not exist; the parts are {list(structure.parts)}."
        )
    part = structure.parts[load.part]
    if isinstance(load, PlanLoad | Pressure) and load.part not in structure.membranes:
        raise ValueError(
            f"{stage} has a {type(load).__name__} on {load.part!r}, a {type(part).__name__}; it acts on membranes, on "
            "cables and masts give a DistributedLoad."
        )
    if isinstance(load, Pressure):
        structure.check_sides(load.part)
    if load.cells is not None:
        validation.in_range(f"{stage}: a load on part {load.part!r}", np.asarray(load.cells), len(part.cells), "cell")
