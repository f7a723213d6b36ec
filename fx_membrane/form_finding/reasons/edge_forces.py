"""Edge and seam cables too weak for the stress of the membranes that they bound: which, and the force they need.

A force T below half the pull n L of a stress n over a span L has no form: the radius T / n of the arc is then below
half the span. Nor have arcs that cross each other or a held edge, see `edge_arcs`. For a stress that is constant in a
plane this is exact; elsewhere it is a guide. A cone between four corners needs a fifth less. A method may need more:
then its trials say how much. All methods name the force by this one rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...checks.values import format_point
from ...model.structure import Structure
from .edge_arcs import Conflict, conflicts_of, least_forces
from .edge_lines import EQUAL_FORCES, Edge, edges_of, held_segments, rims_of

Array = NDArray[np.float64]

DIGITS = 4  # of forces in words
FACTORS = (1.1, 1.25, 1.5, 2.0, 3.0)  # on the forces that edge cables need, tried in turn
GUIDED = 2.0  # factor on forces up to which a trial is worth the whole search
LISTED = 8  # parts named at most


@dataclass(frozen=True)
class WeakEdges:
    """Edges with cables, and the force that each needs.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        edges: All edges with cables.
        needs: Force or force density, as given, above which each has a form, its own if that is enough, shape (edges,).
        conflicts: Arcs that meet under the forces now, the worst first.
        by_rule: Needs by the rule of arcs, before any trial, shape (edges,).
        tried: True if the forces needed are those of a form found by trial.
    """

    points: Array
    edges: list[Edge]
    needs: Array
    conflicts: list[Conflict]
    by_rule: Array
    tried: bool = False

    @property
    def weak(self) -> list[int]:
        """Numbers of the edges that are too weak."""
        return [k for k, edge in enumerate(self.edges) if self.needs[k] > edge.given * (1 + EQUAL_FORCES)]

    @property
    def largest(self) -> float:
        """Largest ratio of a force needed to the force there [-]."""
        return max(float(need) / edge.given for need, edge in zip(self.needs, self.edges, strict=True))

    @property
    def words(self) -> str:
        """Sentence on the edge that lacks most, without its full stop; empty if none is too weak."""
        if not self.weak:
            return ""
        ratios = {k: self.needs[k] / self.edges[k].given for k in self.weak}
        lacking = [
            k for k, ratio in ratios.items() if ratio >= max(ratios.values()) * (1 - EQUAL_FORCES)
        ]  # with one force
        conflict = next((one for one in self.conflicts if set(lacking) & set(one.edges)), None)
        worst = max(lacking, key=lambda k: self.edges[k].need)
        words = self._of_span(worst) if conflict is None else self._of_conflict(conflict)
        named = {worst} if conflict is None else set(conflict.edges)
        where = "cables at seams" if self.edges[worst].is_seam else "edge cables"
        return f"Some {where} are too weak: {words}{self._by_trial(worst)}{self._others(named)}{self._guide}"

    @property
    def _guide(self) -> str:
        """Tell that less may do in space, where the rule of arcs is a guide."""
        ends = np.concatenate([edge.ends for edge in self.edges])
        away = self.points - self.points[ends].mean(axis=0)
        heights = np.abs(away @ np.linalg.svd(away, full_matrices=False)[2][-1])
        is_flat = heights.max() <= EQUAL_FORCES * np.abs(away).max()
        return "" if is_flat or self.tried else "; by the rule of arcs, in space mostly sufficient: less may do"

    def trials(self) -> Iterator[WeakEdges]:
        """Give forces to try, in turn, rounded up as in words: of the edges too weak, or of all if none is."""
        if self.weak:
            yield self._with(self.needs, False)
        for factor in FACTORS:
            yield self._with(factor * self.needs, True)

    def _by_trial(self, k: int) -> str:
        """Tell that forces needed are those of a trial, and that of the rule where it is less."""
        if not self.tried:
            return ""
        edge, rule = self.edges[k], self.by_rule[k]
        return (
            f", as by trial; {edge.shown(rule)} by the rule of arcs"
            if rule > edge.given * (1 + EQUAL_FORCES)
            else ", as by trial"
        )

    def _with(self, needs: Array, tried: bool) -> WeakEdges:
        chosen, rounded = self.weak or list(range(len(self.edges))), self.needs.copy()
        rounded[chosen] = [_rounded_up(float(need)) for need in needs[chosen]]
        return replace(self, needs=rounded, tried=tried)

    def forces(self, forces: Mapping[str, Array], margin: float) -> dict[str, Array]:
        """Return forces of cables, by name, shape (cells,) [N], raised above their need by a margin where too weak."""
        given = {name: force.copy() for name, force in forces.items()}
        for k in self.weak:
            edge, need = self.edges[k], (1 + margin) * self.needs[k]
            if np.ptp(forces[edge.part]) <= EQUAL_FORCES * forces[edge.part].max():  # a cable of one force keeps to one
                given[edge.part] = np.maximum(given[edge.part], need)
            else:
                given[edge.part][edge.cells] *= need / edge.given
        return given

    def _of_span(self, k: int) -> str:
        edge = self.edges[k]
        stress = 2 * edge.need / edge.span
        need, rule = self.needs[k], ""
        if not self.tried:
            need = edge.given_for(np.pi / 2)
            rule = f", stress times {'segments over pi' if edge.by_density else 'half the span'}"
        where = " at the seam" if edge.is_seam else ""
        pull = "difference of the stresses on both sides" if edge.is_seam else "stress"
        return (
            f"that of part {edge.part!r}{where} around {format_point(edge.middle)} has {edge.shown(edge.given)} over a "
            f"span of {edge.span:.4g}; the {pull} of {stress:.4g} there needs more than {edge.shown(need)}{rule}"
        )

    def _of_conflict(self, conflict: Conflict) -> str:
        """Tell of edges whose arcs would meet, the one that needs most first."""
        among = sorted(conflict.edges, key=lambda k: -self.needs[k])
        mine, weak = [self.edges[k] for k in among], [k for k in among if k in self.weak]
        names = " and ".join(dict.fromkeys(repr(edge.part) for edge in mine))
        have = " and ".join("a force to be found" if edge.is_found else edge.shown(edge.given) for edge in mine)
        spans = " and ".join(f"{edge.span:.4g}" for edge in mine)
        need = " and ".join(self.edges[k].shown(self.needs[k]) for k in weak)
        middles = " and ".join(format_point(edge.middle) for edge in mine)
        if conflict.other is not None:
            return (
                f"that of part {names} around {middles} has {have} over a span of {spans}. As an arc of radius "
                f"force over stress it would meet the held edge around {format_point(conflict.other)}; it needs more "
                f"than {need}"
            )
        where, there = f"around {middles}", ""
        if conflict.node is not None:
            where, there = f"that meet at node {conflict.node}, {format_point(self.points[conflict.node])},", "there "
        who = "they need"
        if len(weak) < len(mine):
            edge = self.edges[weak[0]]
            who = f"that of part {edge.part!r} around {format_point(edge.middle)} needs"
        return (
            f"those of part {names} {where} have {have} over spans of {spans}, and would cross {there}as arcs of "
            f"radius force over stress; {who} more than {need}"
        )

    def _others(self, named: set[int]) -> str:
        """List the need of every part, where more edges than those named are too weak."""
        if set(self.weak) <= named:
            return ""
        by_part: dict[str, int] = {}
        for k in self.weak:
            most = by_part.setdefault(self.edges[k].part, k)
            by_part[self.edges[k].part] = max(most, k, key=lambda each: float(self.needs[each]))
        listed = ", ".join(
            f"{name!r} {self.edges[k].shown(self.needs[k])}" for name, k in list(by_part.items())[:LISTED]
        )
        more = f" and {len(by_part) - LISTED} more" if len(by_part) > LISTED else ""
        return f"; by part: {listed}{more}"


def _rounded_up(force: float) -> float:
    """Round up to the digits of words."""
    unit = 10.0 ** (np.floor(np.log10(force)) - DIGITS + 1)
    return float(f"{np.ceil(force / unit * (1 - EQUAL_FORCES)) * unit:.{DIGITS}g}")


def weak_edges(
    structure: Structure,
    points: Array,
    stresses: Mapping[str, Array],
    forces: Mapping[str, Array],
    densities: Mapping[str, Array] = MappingProxyType({}),
    told: Mapping[str, Array] = MappingProxyType({}),
    found: Mapping[str, NDArray[np.bool_]] = MappingProxyType({}),
) -> WeakEdges:
    """Find the edge cables that are too weak.

    Args:
        structure: The structure.
        points: Its shape, shape (n, 3) [m].
        stresses: By membrane, stress in space, shape (cells, 3, 3) [N/m].
        forces: By cable, its force, shape (cells,) [N].
        densities: By cable, the force density of the cells that are given by it, zero of others, shape (cells,) [N/m].
        told: By cable, force to tell instead of that, which is its horizontal part, shape (cells,) [N].
        found: By cable, its cells whose force is found, for a given geometry, shape (cells,).
    """
    rim, seams = rims_of(structure, points, stresses)
    edges = edges_of(structure, points, rim, forces, densities, told, found)
    conflicts = conflicts_of(points, edges, *held_segments(structure, rim, edges))
    edges += [edge._replace(is_seam=True) for edge in edges_of(structure, points, seams, forces, densities, told)]
    needs, met = least_forces(edges, conflicts)
    return WeakEdges(points, edges, needs, met, needs)
