"""Results of a stage: displacements, reactions, stresses, forces and their balance, as NumPy arrays.

Arrays follow the user's own order of nodes and cells, and every process has all of them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..assembly.actions import Actions
from ..assembly.gas import ChamberResult
from ..assembly.problem import Problem
from ..checks import validation
from ..checks.read_only_data import read_only
from ..checks.values import counted
from ..model.parts import Cable, Mast, Membrane, Rope
from ..model.stages import Stage
from ..model.structure import Structure
from ..model.water_events import WaterEvent
from ..runtime.notebook_pictures import picture_png
from ..solvers.base import Iteration
from .forces_of_state import Equilibrium, PondResult, TermResult
from .load_increments import Increment
from .owner import Owned
from .part_results import BarResult, MembraneResult, RopeResult
from .told_states import Remark
from .unfinished_stages import Failure
from .water_depth import mean_depths

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class StageResult(Owned):
    """The final state of a stage.

    Attributes:
        name: Name of the stage.
        structure: The structure.
        displacement: Displacement from the reference position, shape (n, 3) [m].
        actions: Constraints and loads of the structure: constrained components, nodal loads, pressures of the cells,
            energy terms.
        loads: Loads on the nodes, those of pressures and energy terms in the current shape, shape (n, 3) [N].
        reactions: Forces of the supports and the prescribed displacements, shape (n, 3) [N]; zero at free components.
        energy: Total potential energy [J], that of gas included, without pressures and terms without a potential.
        equilibrium: Balance of loads and reactions.
        increments: The load increments of this stage, in order.
        parts: State of each part by name.
        terms: Energy terms that act, those of the structure first; their forces are in `loads`.
        ponds: Water on membranes; its forces are in `loads`.
        chambers: Gas in the chambers by name: pressure, volume, dp/dV; its forces are in `loads`.
        remarks: Sentences on the state to be read before its numbers, those of the warnings: that it is not stable, has
            snapped or fallen, hangs on slack parts or has lost its prestress; that it is strained beyond its material
            law, or not in balance.
        owner: The problem on which the state was computed; None in a copy, see `problem`.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> state = Analysis(rope).run([Stage("pull", [PointLoad(1, (0, 0, -10.0))])])["pull"]
        >>> state.cable("rope").force.round(1).tolist()
        [1012.2, 1012.2]
        >>> state.reactions[:, 2].round(6).tolist()
        [5.0, 0.0, 5.0]
        >>> state.equilibrium.loads.tolist()
        [0.0, 0.0, -10.0]
    """

    name: str
    structure: Structure
    displacement: Array
    actions: Actions
    loads: Array
    reactions: Array
    energy: float
    equilibrium: Equilibrium
    increments: tuple[Increment, ...]
    parts: dict[str, MembraneResult | BarResult]
    remarks: tuple[Remark, ...] = ()
    terms: tuple[TermResult, ...] = ()
    ponds: tuple[PondResult, ...] = ()
    chambers: Mapping[str, ChamberResult] = field(default_factory=dict)
    owner: Problem | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        for name in ("displacement", "loads", "reactions"):
            object.__setattr__(self, name, read_only(getattr(self, name)))

    def __repr__(self) -> str:
        return (
            f"StageResult({self.name!r}, {counted(len(self.increments), 'increment')}, "
            f"largest displacement {self.largest_displacement:.4g})"
        )

    def _repr_html_(self) -> str:
        """Show checks, extremes and a picture in notebooks."""
        from .notebook import state_html  # noqa: PLC0415  (it needs this class)

        return state_html(self)

    def _repr_png_(self) -> bytes | None:
        """Show a picture where a notebook takes no HTML."""
        return picture_png(self)

    @property
    def position(self) -> Array:
        """Current position of the nodes, shape (n, 3) [m]."""
        return self.structure.points + self.displacement

    @property
    def largest_displacement(self) -> float:
        """Largest displacement of a node, the length of its vector [m]."""
        return float(np.linalg.norm(self.displacement, axis=1).max())

    @property
    def membranes(self) -> dict[str, MembraneResult]:
        """States of the membranes by name."""
        return {name: cast(MembraneResult, self.parts[name]) for name in self.structure.membranes}

    @property
    def bars(self) -> dict[str, BarResult]:
        """States of cables, masts and ropes by name."""
        return {name: cast(BarResult, self.parts[name]) for name in self.structure.bars}

    def water_on(self, name: str) -> Array:
        """Mean depth of the water on each cell of the membrane of that name, shape (cells,) [m].

        Raises:
            ValueError: There is no membrane of that name.
        """
        cells = self.structure.part(name, Membrane).cells
        return mean_depths(self.ponds or (), name, cells, self.position)

    def membrane(self, name: str) -> MembraneResult:
        """State of the membrane of that name.

        Raises:
            ValueError: There is no membrane of that name.
        """
        self.structure.part(name, Membrane)
        return cast(MembraneResult, self.parts[name])

    def cable(self, name: str) -> BarResult:
        """State of the cables of that name.

        Raises:
            ValueError: There are no cables of that name.
        """
        self.structure.part(name, Cable)
        return cast(BarResult, self.parts[name])

    def mast(self, name: str) -> BarResult:
        """State of the masts of that name.

        Raises:
            ValueError: There are no masts of that name.
        """
        self.structure.part(name, Mast)
        return cast(BarResult, self.parts[name])

    def rope(self, name: str) -> RopeResult:
        """State of the rope of that name.

        Raises:
            ValueError: There is no rope of that name.
        """
        self.structure.part(name, Rope)
        return cast(RopeResult, self.parts[name])

    def to_dataframe(self, part: str | None = None, *, force_unit: str = "N", length_unit: str = "m") -> Any:
        """Table of the nodes, or of the cells of a part, for pandas.

        Args:
            part: Name of the part; None for the nodes.
            force_unit: Name of the force unit of the structure and its loads, in the heads of columns.
            length_unit: Name of the length unit.

        Returns:
            A pandas.DataFrame, with a row for each node or cell.

        Raises:
            ValueError: There is no part of that name.
            ModuleNotFoundError: pandas is not installed.
        """
        from pandas import DataFrame  # noqa: PLC0415  (optional)

        from .tables import cell_columns, node_columns  # noqa: PLC0415  (it needs this class)

        units = validation.text("force_unit", force_unit), validation.text("length_unit", length_unit)
        columns = node_columns(self, *units) if part is None else cell_columns(self, part, *units)
        return DataFrame(columns)

    @property
    def water_events(self) -> tuple[WaterEvent, ...]:
        """Water that ran over, and basins that merged or parted, in the order of the increments."""
        return tuple(event for increment in self.increments for event in increment.events or ())

    @property
    def water_depth(self) -> Array:
        """Depth of the water at each node, shape (n,) [m]; 0 where it is dry."""
        return np.max([np.zeros(len(self.displacement)), *(pond.depth for pond in self.ponds or ())], axis=0)

    @property
    def history(self) -> list[tuple[float, Iteration]]:
        """Load factor and iterate, for all iterations of the stage."""
        return [(increment.load_factor, entry) for increment in self.increments for entry in increment.iterations]


class StageResults(dict[str, StageResult]):
    """Results of stages by name: a dictionary whose KeyError lists the names.

    Attributes:
        stages: The stages that were to run, in order.
        title: Title of the case file that they are of; empty without one.
        force_unit: Name of its unit of force.
        length_unit: Name of its unit of length.
        limits: Its limits, for checks; None without.
        failure: Stage that found no equilibrium, and ended the run; None if it is complete.
        last: Last state of that stage, named with its load factor; its start if no stage is complete; or else None.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> stages = [Stage("rest"), Stage("pull", [PointLoad(1, (0, 0, -10.0))], after="rest")]
        >>> results = Analysis(rope).run(stages)
        >>> list(results), results["pull"].name, results.failure is None
        (['rest', 'pull'], 'pull', True)
    """

    def __init__(self, results: Mapping[str, StageResult] = MappingProxyType({}), stages: Sequence[Stage] = ()):
        super().__init__(results)
        self.stages = tuple(stages)
        self.title, self.force_unit, self.length_unit = "", "N", "m"
        self.limits: Any = None
        self.failure: Failure | None = None
        self.last: StageResult | None = None

    @property
    def states(self) -> dict[str, StageResult]:
        """States by name, with the last one of a stage that failed."""
        return dict(self) if self.last is None else {**self, self.last.name: self.last}

    def units(self, force: str | None = None, length: str | None = None) -> tuple[str, str]:
        """Names of the units of force and length: those given, or else those of the case file or archive.

        Raises:
            ValueError: A name is no text.
        """
        return (
            validation.text("force_unit", self.force_unit if force is None else force),
            validation.text("length_unit", self.length_unit if length is None else length),
        )

    def _repr_html_(self) -> str:
        """Show the list of stages, and a picture of the last, in notebooks."""
        from .notebook import states_html  # noqa: PLC0415  (it needs this class)

        return states_html(list(self.values()), self.length_unit)

    def _repr_png_(self) -> bytes | None:
        """Show a picture where a notebook takes no HTML."""
        return picture_png(self)

    def __missing__(self, name: object) -> StageResult:
        raise KeyError(f"no stage is named {name!r}; the results are of {list(self)}")
