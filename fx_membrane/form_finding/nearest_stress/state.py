"""Shapes in exact equilibrium on the way to the nearest stress, and the form that the last one makes."""

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.measures import measures, normals
from ...model.loads import PointLoad
from ...model.structure import Structure
from ..balance.constrained_balance import Balance, ConstrainedBalance
from ..balance.membrane_balance import balanced, collapse_of, loaded_cells, nodal_loads, stressed
from ..cell_reference import reference_of, warp_at
from ..constraints.hand_over import handed_over
from ..constraints.motions import motions_of
from ..form import Form, FormStep
from ..plan import Plan, cauchy
from ..wishes import Wish
from .cells import BarBlock, Block, LoadBlock, MembraneBlock, square_root
from .guide import CableGuide
from .mesh_control import MeshControl
from .mesh_lines import mesh_lines
from .ratios import check_ratios, check_tension, differences, power

Array = NDArray[np.float64]

LEAST = 0.05  # share of the wish that a principal stress, or the force of a bar, keeps at least


class State(NamedTuple):
    """Shape in exact equilibrium.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        multipliers: Multipliers of equilibrium, shape (n, 3) [m2/N].
        plans: References of the membranes, with their stress there.
        densities: Force densities of bars, by part, shape (cells,) [N/m].
        reactions: Forces of supports, shape (n, 3) [N].
        ratios: Stress over wish, by part: w^-1/2 s w^-1/2 in the frame of the wish, shape (cells, 2, 2), and T / T_w,
            shape (cells,) [-].
        area: Area of the membranes [m2], or of the strips that bars count as, without one.
        norm: Sum of areas times squared differences from the wish [m2].
    """

    points: Array
    multipliers: Array
    plans: dict[str, Plan]
    densities: dict[str, Array]
    reactions: Array
    ratios: dict[str, Array]
    area: float
    norm: float

    @property
    def mean(self) -> float:
        """Root of the mean squared relative difference of stress and wish [-]."""
        return float(np.sqrt(self.norm / self.area))

    @property
    def largest(self) -> float:
        """Largest relative difference of a principal stress, or of the force of a bar, from the wish [-]."""
        return max((float(differences(ratio).max(initial=0.0)) for ratio in self.ratios.values()), default=0.0)


class NearestProblem:
    """Structure, loads and wishes, and the cells that they make.

    Args:
        structure: The first mesh.
        loads: Loads that the form balances.
        wishes: Wishes for its membranes.
        ratios: Factors of the wishes on the way to them, by part, as `State.ratios`.
        balance: Balance under constraints; none without them.
    """

    def __init__(
        self,
        structure: Structure,
        loads: Sequence[Any],
        wishes: Mapping[str, Wish],
        ratios: Mapping[str, Array] | None = None,
        balance: ConstrainedBalance | None = None,
    ) -> None:
        self.structure, self.loads, self.wishes, self.balance = structure, loads, wishes, balance
        self.free = (~structure.supported & structure.used[:, None]).ravel()
        given = ratios or {}
        self.membranes = {name: MembraneBlock(wish.part.cells, wish, given.get(name)) for name, wish in wishes.items()}
        self.cables = None if balance is None else CableGuide(structure, balance, self._first_plans())
        self.bars = {name: replace(bar, force=bar.force * given.get(name, 1.0)) for name, bar in self._bars().items()}
        acting = {name: self.acting(name) for name, part in structure.parts.items() if part.dimension == 1}
        motions = motions_of(structure) if balance is None else balance.motions
        self.control = MeshControl(structure, motions, mesh_lines(structure, acting))
        spread = [load for load in loads if not isinstance(load, PointLoad)]
        loaded = [LoadBlock(loaded_cells(structure, load), load) for load in spread]
        self.blocks: list[Block] = [*self.membranes.values(), *self.bars.values(), *loaded]
        points = [load for load in loads if isinstance(load, PointLoad)]
        self.point_loads = nodal_loads(structure, points, structure.points)

    def _bars(self) -> dict[str, BarBlock]:
        """Bars with a force and a free end; the others take no part. Those of constraints count for no difference."""
        forces = self._forces(self.structure.points, None)
        stress = self._mean_stress() or max((np.abs(force).max() for force in forces.values()), default=1.0)
        found = {}
        for name, force in forces.items():
            acting = self.acting(name)
            if acting.any():
                width = np.where(self.given(name), np.inf, force / stress)
                found[name] = BarBlock(self.structure.parts[name].cells[acting], force[acting], width[acting])
        return found

    def _forces(self, points: Array, densities: Mapping[str, Array] | None) -> dict[str, Array]:
        """List forces of bars, wished for or given by constraints in a shape, by part, shape (cells,) [N]."""
        bars = {name: part for name, part in self.structure.parts.items() if part.dimension == 1}
        forces = {name: part.prestress_tensors().ravel() for name, part in bars.items()}
        if self.cables is not None:
            asked = self.cables.forces(points, self.cables.first if densities is None else densities)
            forces = {name: np.where(self.given(name), asked[name], force) for name, force in forces.items()}
        return forces

    def given(self, name: str) -> NDArray[np.bool_]:
        """Cells of a bar whose force is given by a constraint, shape (cells,)."""
        count = len(self.structure.parts[name].cells)
        return np.zeros(count, dtype=bool) if self.cables is None else self.cables.given[name]

    def at(self, state: State) -> "NearestProblem":
        """Problem with the forces of constraints as they are in a state."""
        if self.cables is None:
            return self
        forces, found = self._forces(state.points, state.densities), copy(self)
        found.bars = {}
        for name, bar in self.bars.items():
            acting = self.acting(name)
            force = np.where(self.given(name)[acting], forces[name][acting], bar.force)
            growth = self.cables.growth(name, acting, state.points[bar.cells])
            found.bars[name] = replace(bar, force=force, growth=growth)
        found.blocks = [
            *self.membranes.values(),
            *found.bars.values(),
            *self.blocks[len(self.membranes) + len(self.bars) :],
        ]
        return found

    def _first_plans(self) -> dict[str, Plan]:
        """Membranes in the first shape, with the stress wished for."""
        points, found = self.structure.points, {}
        for name, block in self.membranes.items():
            triangles = block.triangles(points[block.cells])
            found[name] = reference_of(block.cells, points, triangles.frame[:, 0], triangles.wish)
        return found

    def _mean_stress(self) -> float:
        """Mean of the stress wished for, over the first areas [N/m]; zero without a membrane."""
        total = area = 0.0
        for block in self.membranes.values():
            triangles = block.triangles(self.structure.points[block.cells])
            total += float(np.sum(triangles.areas * np.trace(triangles.wish, axis1=1, axis2=2) / 2))
            area += float(triangles.areas.sum())
        return total / area if area else 0.0

    def state(
        self, points: Array, multipliers: Array, least: float = LEAST, before: Mapping[str, Array] | None = None
    ) -> State:
        """Shape in exact equilibrium with the corrected stress that multipliers make in a shape near it.

        Args:
            points: Positions of the nodes, shape (n, 3) [m].
            multipliers: Multipliers, shape (n, 3) [m2/N].
            least: Share of the wish that a principal stress, or the force of a bar, keeps at least.
            before: Force densities of bars in a shape before; those of lines of given geometry start from them.

        Raises:
            RuntimeError: There is none; the loads grow without bound; a stress is no tension.
            ValueError: A warp becomes normal to its cell; stresses differ too much for the number of digits.
        """
        plans = {}
        for name, block in self.membranes.items():
            triangles, stress = block.stresses(points[block.cells], multipliers[block.cells])
            plans[name] = reference_of(block.cells, points, triangles.frame[:, 0], stress)
        densities = self.densities(points, multipliers, before)
        check_tension(plans)
        found = self.balanced(points, plans, densities)
        return self.measured(found.points, multipliers, plans, found.densities, found.reactions, least)

    def balanced(self, start: Array, plans: dict[str, Plan], densities: dict[str, Array]) -> Balance:
        """Balance with stresses and force densities, near a shape, under the constraints.

        Raises:
            RuntimeError, ValueError: There is none.
        """
        if self.cables is not None:
            return self.cables.balanced(start, plans, densities)
        points, reactions = balanced(self.structure, self.loads, start, plans, densities)
        return Balance(points, reactions, {}, densities)

    def measured(
        self,
        points: Array,
        multipliers: Array,
        plans: dict[str, Plan],
        densities: dict[str, Array],
        reactions: Array,
        least: float,
    ) -> State:
        """State of a shape in equilibrium, compared with the wish.

        Raises:
            RuntimeError: It collapses, or a stress is below the least share of the wish.
        """
        if not np.isfinite(points).all():
            raise RuntimeError("the shape collapses")
        if gone := collapse_of(self.structure, points):
            raise RuntimeError(gone)
        ratios = self._ratios(points, plans, densities)
        check_ratios(ratios, least)
        norm, area = self._norm(points, ratios)
        return State(points, multipliers, plans, densities, reactions, ratios, area, norm)

    def densities(
        self, points: Array, multipliers: Array, before: Mapping[str, Array] | None = None
    ) -> dict[str, Array]:
        """Force densities of bars, by part, shape (cells,) [N/m]; those of constraints from those of a shape before."""
        found = {}
        given = {} if self.cables is None else self.cables.densities(points, before)
        for name, part in self.structure.parts.items():
            if part.dimension == 1:
                force = part.prestress_tensors().ravel().copy()
                if block := self.bars.get(name):
                    acting = self.acting(name)
                    force[acting] = block.tensions(points[block.cells], multipliers[block.cells])
                found[name] = force / measures(points, part.cells)
                if name in given:
                    found[name] = np.where(self.given(name), given[name], found[name])
        return found

    def acting(self, name: str) -> NDArray[np.bool_]:
        """Cells of bars that take part, shape (cells,)."""
        part = self.structure.parts[name]
        free = self.free.reshape(-1, 3).any(axis=1)
        loaded = (part.prestress_tensors().ravel() > 0) | self.given(name)
        return np.asarray(loaded & free[part.cells].any(axis=1))

    def _ratios(self, points: Array, plans: Mapping[str, Plan], densities: Mapping[str, Array]) -> dict[str, Array]:
        ratios = {}
        for name, block in self.membranes.items():
            triangles = block.triangles(points[block.cells])
            found = cauchy(plans[name], points, triangles.frame[:, 0])[0]
            inverse = np.linalg.inv(square_root(triangles.wish))
            ratios[name] = inverse @ found @ inverse
        for name, bar in self.bars.items():
            force = densities[name][self.acting(name)] * measures(points, bar.cells)
            ratios[name] = np.where(np.isfinite(bar.width), force / bar.force, 1.0)
        return ratios

    def _norm(self, points: Array, ratios: Mapping[str, Array]) -> tuple[float, float]:
        norm = area = strips = 0.0
        for name, block in self.membranes.items():
            areas = measures(points, block.cells)
            norm += float(areas @ np.sum((ratios[name] - np.eye(2)) ** 2, axis=(1, 2)))
            area += float(areas.sum())
        for name, bar in self.bars.items():
            strip = measures(points, bar.cells) * np.where(np.isfinite(bar.width), bar.width, 0.0)
            norm += float(strip @ (ratios[name] - 1) ** 2)
            strips += float(strip.sum())
        return norm, area or strips or 1.0

    def towards(self, start: State, share: float) -> "NearestProblem":
        """Problem whose wish is on the way from the stress of a state to the wish, and its mesh on that to an even one.

        Args:
            start: The state, in exact equilibrium with the wish of share zero.
            share: Share of the way.
        """
        ratios = {name: power(ratio, 1 - share) for name, ratio in start.ratios.items()}
        problem = NearestProblem(self.structure, self.loads, self.wishes, ratios, self.balance)
        problem.control.rest = (1 - share) * problem.control.forces(start.points)
        return problem

    def form(self, state: State, steps: tuple[FormStep, ...], converged: bool, remarks: tuple[str, ...]) -> Form:
        """Make the form of a state."""
        structure, points = self.structure, state.points
        warps = {}
        for name, wish in self.wishes.items():
            corners = points[wish.part.cells]
            warps[name] = wish.at(corners, normals(points, wish.part.cells))[0]
            if wish.direction is None:
                warps[name] = warp_at(name, wish.part, points)
        parts, forces = stressed(structure, points, state.plans, state.densities, warps)
        wishes = self._forces(points, state.densities)
        for name, block in self.membranes.items():
            wishes[name] = block.triangles(points[block.cells]).wish
        motions = motions_of(structure) if self.balance is None else self.balance.motions
        form = handed_over(structure, motions, points, (parts, forces), state.reactions, steps, converged)
        return replace(form, wish=wishes, remarks=(*remarks, *form.remarks))
