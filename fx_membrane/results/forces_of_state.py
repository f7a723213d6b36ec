"""Forces of a state: those of energy terms, and the balance of loads and reactions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..model.ponds import Pond
from ..model.water_events import BasinResult

Array = NDArray[np.float64]


class PondResult(NamedTuple):
    """State of the water of a `Pond`.

    Attributes:
        pond: The pond.
        level: Height of the water [m]; minus infinity without water. Of several basins, that of the largest volume.
        volume: Its volume [m3].
        area: Wet area in plan [m2].
        lost: Volume that has run off over the rim or into drains [m3]; 0 for a given level.
        depth: Depth at each node of the membrane, 0 elsewhere, shape (n,) [m].
        pieces: Number of each wet piece at its nodes, from 0 on, -1 at dry nodes, shape (n,).
        basins: Rain in each basin; empty for a given level or volume.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 8, 8)
        >>> points[:, 2] = np.maximum(np.abs(points[:, 0]), np.abs(points[:, 1])) - 1  # a pyramid, upside down
        >>> tub = Structure(points, {"tub": Membrane(triangles, Fabric(1e9, 0.0), 1e6)}, [Support(range(len(points)))])
        >>> water = Analysis(tub).run([Stage("rain", [Pond("tub", volume=1 / 6)])])["rain"].ponds[0]
        >>> round(water.level, 6), water.deepest, water.separate
        (-0.5, 40, 1)
    """

    pond: Pond
    level: float
    volume: float
    area: float
    lost: float
    depth: Array
    pieces: NDArray[np.int64]
    basins: tuple[BasinResult, ...] = ()

    @property
    def deepest(self) -> int:
        """Node with the greatest depth."""
        return int(self.depth.argmax())

    @property
    def separate(self) -> int:
        """Number of pieces of the water that touch no other."""
        return int(self.pieces.max()) + 1


class TermResult(NamedTuple):
    """State of an energy term.

    Attributes:
        term: The term.
        factor: Its factor: 1 for a term of the structure, the load factor for one of the last stage.
        forces: Its forces on the nodes, shape (n, 3) [N].

    Example:
        >>> from dataclasses import dataclass
        >>> @dataclass(frozen=True)
        ... class Drag:
        ...     part: str
        ...     force: float  # [N/m]
        ...     def energy(self, state, parameters):
        ...         return -parameters.force * state.u[2]
        ...
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> drag = Analysis(rope).run([Stage("drag", [Drag("rope", -5.0)])])["drag"].terms[0]
        >>> drag.factor, drag.forces[:, 2].round(6).tolist()
        (1.0, [-7.5, -15.0, -7.5])
    """

    term: Any
    factor: float
    forces: Array


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Balance of all forces on the structure in its current shape; moments about the origin.

    Attributes:
        loads: Sum of the loads, shape (3,) [N].
        reactions: Sum of the reactions, shape (3,) [N].
        load_moment: Moment of the loads, shape (3,) [N m].
        reaction_moment: Moment of the reactions, shape (3,) [N m].
        residual: Largest unbalanced force at a free component [N].
        unbalanced: Largest unbalanced force at a free component of each node, shape (n,) [N].

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> balance = Analysis(rope).run([pull])["pull"].equilibrium
        >>> balance.loads.tolist(), balance.reactions.round(6).tolist(), balance.residual < 1e-6
        ([0.0, 0.0, -10.0], [0.0, 0.0, 10.0], True)
    """

    loads: Array
    reactions: Array
    load_moment: Array
    reaction_moment: Array
    residual: float
    unbalanced: Array
