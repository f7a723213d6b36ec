"""Limits of wishes for stress, in words: open edges, cables too weak for their span, and wishes that have a form."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from ...checks import validation
from ...geometry.measures import measures, normals
from ...geometry.topology import boundary_edges
from ...model.parts import Bar, Membrane
from ...model.structure import Structure
from ..form import FormStep
from ..nearest_stress.cells import MembraneBlock
from ..nearest_stress.state import NearestProblem, State, differences
from ..plan import place
from ..wishes import RadialDirection

Array = NDArray[np.float64]


class WeakEdge(NamedTuple):
    """Edge cable whose force over the stress of the membrane is a radius below half of its span."""

    part: str
    ends: tuple[int, int]
    span: float
    force: float
    stress: float

    def words(self, points: Array) -> str:
        """Tell of it, with the rule and the force that would do."""
        a, b = (validation.format_point(points[end]) for end in self.ends)
        return (
            f"the edge cable {self.part!r} between {a} and {b} is too weak for its span of {self.span:.4g}: an edge is "
            f"an arc of the radius R = T / n, force over stress, of at least half the span, and {self.force:.4g} over "
            f"{self.stress:.4g} is {self.force / self.stress:.4g}; {self.stress * self.span / 2:.4g} would do."
        )


def check_edges(structure: Structure) -> None:
    """Refuse an edge of a membrane that neither a bar with a force, nor a support, nor another membrane holds.

    Raises:
        ValueError: There is one.
    """
    held = structure.supported.any(axis=1)
    bars = [
        part.cells[part.prestress_tensors().ravel() > 0] for part in structure.parts.values() if isinstance(part, Bar)
    ]
    others = {name: boundary_edges(part.cells) for name, part in structure.parts.items() if isinstance(part, Membrane)}
    for name, edges in others.items():
        holding = [*bars, *(cells for other, cells in others.items() if other != name)]
        taken = {tuple(pair) for pair in np.sort(np.concatenate([np.zeros((0, 2), int), *holding]), axis=1).tolist()}
        free = edges[~held[edges].all(axis=1)]
        for pair in np.sort(free, axis=1).tolist():
            if tuple(pair) not in taken:
                where = validation.format_point(structure.points[pair].mean(axis=0))
                raise ValueError(
                    f"Part {name!r} has an edge at {where} with neither cable nor support, where no stress across it "
                    "balances; put a cable there, or hold its nodes."
                )


def reason_of(
    problem: NearestProblem, state: State, steps: Sequence[FormStep], failure: str, tolerance: float, far: float
) -> str:
    """Tell of the reason for which a form is not that of the wish, in words; empty if it is the nearest one."""
    weak = weak_edges(problem)
    settled = bool(steps) and steps[-1].change <= tolerance
    if not failure and settled and state.mean <= far and not weak:
        return ""
    where = _worst(problem, state)
    if failure:
        # A neck away from the edges stays with stronger cables: then both are named.
        words = [weak[0].words(problem.structure.points)] if weak else []
        words += [] if weak and _is_at_edge(problem, state) else [_neck(problem, state)]
        cause = " Besides, ".join(words)
        return f"it is not that of the wish: {failure}. The reason: {cause} {where}"
    if weak:
        return f"{weak[0].words(problem.structure.points)} {where}"
    if state.mean > far:
        return f"its stress is far from the wish, by {100 * state.mean:.3g} % in the mean. {where}"
    return (
        f"it has not settled: step {len(steps)}, the last, changed it by {steps[-1].change if steps else np.inf:.3g}, "
        f"more than the tolerance {tolerance:g}; allow more steps (max_iterations=...). {where}"
    )


def weak_edges(problem: NearestProblem) -> list[WeakEdge]:
    """Edge cables too weak for their span, the weakest first."""
    structure, found = problem.structure, []
    bars = np.concatenate([np.zeros((0, 2), dtype=np.int64), *(block.cells for block in problem.bars.values())])
    count = np.bincount(bars.ravel(), minlength=len(structure.points))
    for name, block in problem.bars.items():
        for line in _lines(structure, block.cells, (count == 2) & ~structure.supported.any(axis=1)):
            cells, ends = block.cells[line], _ends(block.cells[line])
            stress = _pull(problem, cells)
            if stress is None or len(ends) != 2:
                continue
            span = float(np.linalg.norm(structure.points[ends[1]] - structure.points[ends[0]]))
            force = float(block.force[line].mean())
            if force < stress * span / 2:
                found.append(WeakEdge(name, (ends[0], ends[1]), span, force, stress))
    return sorted(found, key=lambda edge: edge.force / (edge.stress * edge.span))


def remarks_of(problem: NearestProblem, state: State) -> tuple[str, ...]:
    """Sentences on wishes about an axis: that of their family which is exact."""
    found = []
    for name, block in problem.membranes.items():
        direction = block.wish.direction
        triangles = block.triangles(state.points[block.cells])
        wish = triangles.wish
        if not isinstance(direction, RadialDirection) or np.ptp(wish, axis=0).max() > 1e-9 * wish.max():
            continue
        radial, tangential = float(wish[0, 0, 0]), float(wish[0, 1, 1])
        if abs(radial - tangential) <= 1e-9 * radial or abs(wish[0, 0, 1]) > 1e-9 * radial:
            continue
        r = np.linalg.norm(direction.arms(state.points[block.cells].mean(axis=1)), axis=1)
        c = (radial - tangential) * float(np.sum(triangles.areas / r) / np.sum(triangles.areas / r**2))
        found.append(
            f"Part {name!r}: about an axis equilibrium demands (r n_radial)' = n_tangential, so the constant "
            f"{radial:g} and {tangential:g} have no form there. n_radial = {tangential:g} + c / r with n_tangential = "
            f"{tangential:g} is exact for any c; c = {c:.4g} is nearest to the wish."
        )
    return tuple(found)


def _worst(problem: NearestProblem, state: State) -> str:
    """Tell of the cell whose stress is farthest from the wish."""
    name, cell = _farthest(state)
    cells = problem.membranes[name].cells if name in problem.membranes else problem.bars[name].cells
    return (
        f"The stress is farthest from the wish in part {name!r}, cell {cell} at {place(state.points, cells, cell)}, by "
        f"{100 * state.largest:.3g} %; form.differences has all."
    )


def _is_at_edge(problem: NearestProblem, state: State) -> bool:
    """Return True if the cell farthest from the wish has a node on a cable."""
    name, cell = _farthest(state)
    on = np.concatenate([np.zeros(0, dtype=np.int64), *(block.cells.ravel() for block in problem.bars.values())])
    return name in problem.bars or bool(np.isin(problem.membranes[name].cells[cell], on).any())


def _farthest(state: State) -> tuple[str, int]:
    """Part and cell whose stress is farthest from the wish."""
    sizes = {name: differences(ratio) for name, ratio in state.ratios.items()}
    name = max(sizes, key=lambda name: float(sizes[name].max(initial=0.0)))
    return name, int(sizes[name].argmax())


def _neck(problem: NearestProblem, state: State) -> str:
    """Tell of the place where the membrane closes to a neck, or of the ring that is too far."""
    shrunk, where = 1.0, ""
    for name, block in problem.membranes.items():
        now = np.sqrt(measures(state.points, block.cells))
        ratio = now / np.median(now)
        cell = int(ratio.argmin())
        if not where or ratio[cell] < shrunk:
            shrunk, where = float(ratio[cell]), f"part {name!r}, at {place(state.points, block.cells, cell)}"
    return (
        f"no surface of such stress spans the supports; it closes to a neck in {where}. Bring the rings nearer to each "
        "other, make the ring larger, wish for more stress from ring to ring than around them, or give the stress in "
        "plan, projected_stress."
    )


def _pull(problem: NearestProblem, cells: NDArray[np.int64]) -> float | None:
    """Mean of the stress wished for across an edge, over its length [N/m]; None if the bars are on no edge."""
    points = problem.structure.points
    wanted = {tuple(pair) for pair in np.sort(cells, axis=1).tolist()}
    total = length = 0.0
    for block in problem.membranes.values():
        edges = boundary_edges(block.cells)
        on = np.array([tuple(pair) in wanted for pair in np.sort(edges, axis=1).tolist()], dtype=bool)
        if on.any():
            stress, size = _across(block, points, edges[on])
            total, length = total + float(stress @ size), length + float(size.sum())
    return total / length if length else None


def _across(block: MembraneBlock, points: Array, edges: NDArray[np.int64]) -> tuple[Array, Array]:
    """Stress wished for across edges, in the cells beside them, shape (edges,) [N/m], and their lengths [m]."""
    n = len(points)
    sides = np.concatenate([block.cells[:, [0, 1]], block.cells[:, [1, 2]], block.cells[:, [2, 0]]])
    key = np.sort(sides, axis=1) @ [n, 1]
    order = np.argsort(key)
    side = order[np.searchsorted(key[order], np.sort(edges, axis=1) @ [n, 1])]
    cell = side % len(block.cells)
    triangles = block.triangles(points[block.cells])
    way = points[edges[:, 1]] - points[edges[:, 0]]
    size = np.linalg.norm(way, axis=1)
    outward = np.cross(way / size[:, None], normals(points, block.cells)[cell])
    local = np.einsum("eax,ex->ea", triangles.frame[cell], outward)
    return np.einsum("ea,eab,eb->e", local, triangles.wish[cell], local), size


def _lines(structure: Structure, cells: NDArray[np.int64], inner: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Bars in lines that end where nodes are held or other bars meet them, as numbers of their cells."""
    n = len(structure.points)
    ends = [np.flatnonzero(inner[corner]) for corner in cells.T]
    rows = np.concatenate(ends)
    columns = np.concatenate([corner[at] for corner, at in zip(cells.T, ends, strict=True)])
    links = sparse.coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(cells), n)).tocsr()
    label = connected_components(links @ links.T, directed=False)[1]
    return [np.flatnonzero(label == each) for each in range(label.max() + 1)]


def _ends(cells: NDArray[np.int64]) -> list[int]:
    node, count = np.unique(cells, return_counts=True)
    return [int(each) for each in node[count == 1]]
