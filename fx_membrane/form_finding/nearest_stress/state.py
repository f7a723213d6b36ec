"""Structure, loads and wishes of the nearest stress: its shapes in equilibrium, and the form of the last one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures, normals
from ...geometry.vector_columns import columns, rows
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
from .cells import BarBlock, Block, LoadBlock, MembraneBlock, mean_stress, norm_of
from .equilibrium import State
from .guide import CableGuide
from .lines_of_mesh import mesh_lines
from .mesh_control import MeshControl
from .ratios import check_ratios, check_tension, power, relative

Array = NDArray[np.float64]

# Share of the wish that a principal stress, or the force of a bar, keeps at least; forms are the same with 0.005.
MIN_STRESS_SHARE = 0.05


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
        acting = {name: self.acting(name) for name in structure.bars}
        motions = motions_of(structure) if balance is None else balance.motions
        self.control = MeshControl(structure, motions, mesh_lines(structure, acting))
        spread = [load for load in loads if not isinstance(load, PointLoad)]
        loaded = [LoadBlock(loaded_cells(structure, load), load) for load in spread]
        self.blocks: list[Block] = [*self.membranes.values(), *self.bars.values(), *loaded]
        points = [load for load in loads if isinstance(load, PointLoad)]
        self.point_loads = nodal_loads(structure, points, structure.points)
        self.control.guide.bind(structure.points, self.control.lines.segments, self._pulls)

    def _pulls(self, points: Array) -> Array:
        """Sum the forces wished for of bars and the loads at the nodes, shape (n, 3) [N]."""
        found = self.point_loads.copy()
        for bar in self.bars.values():
            corners = columns(points[bar.cells])
            np.add.at(found, bar.cells, -rows(bar.forces(corners, np.zeros_like(corners))))
        return found

    def _bars(self) -> dict[str, BarBlock]:
        """Bars with a force and a free end; the others take no part. Those of constraints count for no difference."""
        forces = self.bar_forces(self.structure.points, None)
        stress = mean_stress(self.membranes, self.structure.points) or max(
            (np.abs(force).max() for force in forces.values()), default=1.0
        )
        found = {}
        for name, force in forces.items():
            acting = self.acting(name)
            if acting.any():
                width = np.where(self.given(name), np.inf, force / stress)
                found[name] = BarBlock(self.structure.parts[name].cells[acting], force[acting], width[acting])
        return found

    def bar_forces(self, points: Array, densities: Mapping[str, Array] | None) -> dict[str, Array]:
        """List forces of bars, wished for or given by constraints in a shape, by part, shape (cells,) [N]."""
        bars = self.structure.bars
        forces = {name: part.prestress_tensors().ravel() for name, part in bars.items()}
        if self.cables is not None:
            asked = self.cables.forces(points, self.cables.first if densities is None else densities)
            forces = {name: np.where(self.given(name), asked[name], force) for name, force in forces.items()}
        return forces

    def given(self, name: str) -> NDArray[np.bool_]:
        """Cells of a bar whose force is given by a constraint, shape (cells,)."""
        count = len(self.structure.parts[name].cells)
        return np.zeros(count, dtype=bool) if self.cables is None else self.cables.given[name]

    def on(self, points: Array) -> NearestProblem:
        """Problem with the directions that wishes have on the surface in a shape, shape (n, 3) [m].

        Raises:
            ValueError: There is none on this surface.
        """
        if all(wish.along is None for wish in self.wishes.values()):
            return self
        found = copy(self)
        found.wishes = {name: wish.on(points) for name, wish in self.wishes.items()}
        found.membranes = {name: replace(block, wish=found.wishes[name]) for name, block in self.membranes.items()}
        found.blocks = [*found.membranes.values(), *self.blocks[len(self.membranes) :]]
        return found

    def at(self, state: State) -> NearestProblem:
        """Problem with the directions of wishes and the forces of constraints as they are in a state."""
        if self.cables is None:
            return self.on(state.points)
        forces, found = self.bar_forces(state.points, state.densities), copy(self.on(state.points))
        found.bars = {}
        for name, bar in self.bars.items():
            acting = self.acting(name)
            force = np.where(self.given(name)[acting], forces[name][acting], bar.force)
            growth = self.cables.growth(name, acting, columns(state.points[bar.cells]))
            found.bars[name] = replace(bar, force=force, growth=growth)
        loaded = self.blocks[len(self.membranes) + len(self.bars) :]
        found.blocks = [*found.membranes.values(), *found.bars.values(), *loaded]
        return found

    def _first_plans(self) -> dict[str, Plan]:
        """Membranes in the first shape, with the stress wished for."""
        points, found = self.structure.points, {}
        for name, block in self.membranes.items():
            triangles = block.triangles(points[block.cells])
            found[name] = reference_of(block.cells, points, triangles.frame[:, 0], triangles.wish)
        return found

    def state(
        self,
        points: Array,
        multipliers: Array,
        least: float = MIN_STRESS_SHARE,
        before: Mapping[str, Array] | None = None,
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
        ratios = self.on(points)._ratios(points, plans, densities)
        check_ratios(ratios, least)
        norm, area = norm_of(self.membranes, self.bars, points, ratios)
        return State(points, multipliers, plans, densities, reactions, ratios, area, norm)

    def densities(
        self, points: Array, multipliers: Array, before: Mapping[str, Array] | None = None
    ) -> dict[str, Array]:
        """Force densities of bars, by part, shape (cells,) [N/m]; those of constraints from those of a shape before.

        Raises:
            RuntimeError: A bar has shrunk to nothing.
        """
        if gone := collapse_of(self.structure, points, only_bars=True):
            raise RuntimeError(gone)
        found = {}
        given = {} if self.cables is None else self.cables.densities(points, before)
        for name, part in self.structure.bars.items():
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
            ratios[name] = relative(found, triangles.wish)
        for name, bar in self.bars.items():
            force = densities[name][self.acting(name)] * measures(points, bar.cells)
            ratios[name] = np.where(np.isfinite(bar.width), force / bar.force, 1.0)
        return ratios

    def at_rest(self, state: State) -> State:
        """State without multipliers, as a start from which `towards` leads to the wish."""
        none = np.zeros_like(state.points)
        return self.measured(state.points, none, state.plans, state.densities, state.reactions, 0.0)

    def towards(self, start: State, share: float) -> NearestProblem:
        """Problem between a state and the wish: its stress on the way to the wish, its mesh to an even one.

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
        here, warps = self.on(points), {}
        for name, wish in here.wishes.items():
            corners = points[wish.part.cells]
            warps[name] = wish.at(corners, normals(points, wish.part.cells))[0]
            if wish.direction is None:
                warps[name] = warp_at(name, wish.part, points)
        parts, forces = stressed(structure, points, state.plans, state.densities, warps)
        wishes = self.bar_forces(points, state.densities)
        for name, block in here.membranes.items():
            wishes[name] = block.triangles(points[block.cells]).wish
        motions = motions_of(structure) if self.balance is None else self.balance.motions
        form = handed_over(structure, motions, points, (parts, forces), state.reactions, steps, converged)
        return replace(form, wish=wishes, remarks=(*remarks, *form.remarks))
