"""Balance of stress about an axis: (r n_radial)' = n_tangential, and the choice that is exact and nearest to a wish."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...checks.values import format_point
from ...geometry.sizes import lengths, normals
from ...geometry.topology import boundary_edges
from ..nearest_stress.equilibrium import State
from ..nearest_stress.state import NearestProblem
from ..plan import Plan
from ..wishes import RadialDirection
from .sewn_surfaces import cells_of, joined_membranes, listed

Array = NDArray[np.float64]

EQUAL_STRESSES = 1e-9  # relative difference of stresses that counts as rounding
MISSED = 0.02  # distance of the axis from the lines through cells along their stress, over their length
UNBALANCED = 0.02  # mean of (r n_radial)' - n_tangential over the latter, above which a stress does not balance
TENSE = 0.9  # share of n_radial that c / r takes away at most
DEGREE = 3  # of the polynomial in r that r n_radial is compared with


class ExactChoice(NamedTuple):
    """Stress n_radial = c / r + d with n_tangential = d, which balances about an axis."""

    c: float
    d: float

    @property
    def words(self) -> str:
        """Clause that names it."""
        return f"n_radial = {self.d:.4g} + c / r with n_tangential = {self.d:.4g} is exact for any c; c = {self.c:.4g}"


def exact_choice(radial: Array, tangential: Array, r: Array, areas: Array) -> ExactChoice:
    """Exact choice of tension nearest to stresses of cells, by least squares over areas, all of shape (cells,)."""
    d = float(areas @ tangential / areas.sum())
    c = float((areas / r) @ (radial - d) / np.sum(areas / r**2))
    return ExactChoice(max(c, -TENSE * d * float(r.min())), d)


def remarks_of(problem: NearestProblem, state: State) -> tuple[str, ...]:
    """Sentences on wishes about an axis that have no surface of revolution: that of their family which is exact.

    They are told only where the shape found is a surface of revolution, to the accuracy of its mesh.
    """
    found = []
    for names in joined_membranes(problem.structure, problem.membranes):
        directions = [problem.membranes[name].wish.direction for name in names]
        direction = directions[0]
        triangles = [block.triangles(state.points[block.cells]) for block in map(problem.membranes.get, names) if block]
        wish, areas = (np.concatenate([getattr(one, what) for one in triangles]) for what in ("wish", "areas"))
        if not isinstance(direction, RadialDirection) or np.ptp(wish, axis=0).max() > EQUAL_STRESSES * wish.max():
            continue
        if any(other != direction for other in directions):
            continue
        cells = cells_of(problem.structure, names)
        radial, tangential = float(wish[0, 0, 0]), float(wish[0, 1, 1])
        if abs(radial - tangential) <= EQUAL_STRESSES * radial or abs(wish[0, 0, 1]) > EQUAL_STRESSES * radial:
            continue
        if not _is_of_revolution(state.points, cells, direction):
            continue
        r = lengths(direction.arms(state.points[cells].mean(axis=1)))
        choice = exact_choice(wish[:, 0, 0], wish[:, 1, 1], r, areas)
        of_parts = listed(names)
        found.append(
            f"{of_parts[0].upper()}{of_parts[1:]}: about an axis equilibrium demands (r n_radial)' = n_tangential, so "
            f"the constant {radial:g} and {tangential:g} have no form there. {choice.words} is nearest to the wish."
        )
    return tuple(found)


def unbalanced(plan: Plan, flat: Array, axes: Array) -> str:
    """Tell of a stress in plan that is radial and tangential about a point and does not balance; empty otherwise.

    Args:
        plan: The membrane in plan.
        flat: Positions of the nodes in plan, shape (n, 2) [m].
        axes: Axes of the plan in space as columns, shape (3, 2) [-].
    """
    centres = flat[plan.cells].mean(axis=1)
    for along in (plan.frame[:, :, 0], plan.frame[:, :, 1], *np.linalg.eigh(plan.stress)[1].transpose(2, 0, 1)):
        around = np.stack([-along[:, 1], along[:, 0]], axis=1)
        radial, shear, tangential = (
            np.einsum("ca,cab,cb->c", one, plan.stress, other)
            for one, other in ((along, along), (along, around), (around, around))
        )
        centre = _meeting(centres, along, plan.areas)
        if centre is not None and (np.abs(shear) <= EQUAL_STRESSES * radial).all():
            break
    else:
        return ""
    r = lengths(centres - centre)
    slope = _slope(r, r * radial, plan.areas)
    share = plan.areas / plan.areas.sum()
    gap = np.sqrt(share @ (slope - tangential) ** 2) / (share @ tangential)
    if gap <= UNBALANCED:
        return ""
    choice = exact_choice(radial, tangential, r, plan.areas)
    where = axes @ np.where(np.abs(centre) > EQUAL_STRESSES * r.mean(), centre, 0.0)
    return (
        f"about the axis at {format_point(where)} in plan equilibrium demands (r n_radial)' = "
        f"n_tangential, but these are {share @ slope:.4g} and {share @ tangential:.4g} in the mean; {choice.words} is "
        "nearest."
    )


def _is_of_revolution(points: Array, cells: NDArray[np.int64], direction: RadialDirection) -> bool:
    """Return True if boundaries are circles about the axis, and normals meet it, to the accuracy of a mesh."""
    arms = direction.arms(points)
    axis = np.asarray(direction.axis) / np.linalg.norm(np.asarray(direction.axis))
    edges = boundary_edges(cells)
    way = points[edges[:, 1]] - points[edges[:, 0]]
    middle = arms[edges].mean(axis=1)
    r = lengths(middle)
    along = np.abs(np.stack([np.sum(way * middle, axis=1) / r, way @ axis]))  # zero on a circle
    if (along.max(axis=0) > lengths(way) ** 2 / (2 * r)).any():
        return False
    centre = arms[cells].mean(axis=1)
    around = np.cross(axis, centre) / lengths(centre)[:, None]
    size = lengths(points[cells] - points[cells].mean(axis=1, keepdims=True)).max(axis=1)
    skew = np.abs(np.sum(normals(points, cells) * around, axis=1))
    return bool((skew <= size / lengths(centre)).all())


def _meeting(centres: Array, along: Array, areas: Array) -> Array | None:
    """Point where lines through cells along unit vectors meet, shape (2,) [m]; None if they do not."""
    across = np.eye(2) - along[:, :, None] * along[:, None, :]
    matrix = np.einsum("c,cab->ab", areas, across)
    if np.linalg.eigvalsh(matrix)[0] <= EQUAL_STRESSES * areas.sum():
        return None
    point = np.linalg.solve(matrix, np.einsum("c,cab,cb->a", areas, across, centres))
    away = centres - point
    miss = np.einsum("cab,cb->ca", across, away)
    return point if lengths(miss).max() <= MISSED * lengths(away).mean() else None


def _slope(r: Array, values: Array, areas: Array) -> Array:
    """Differentiate values by r, as a polynomial by least squares over areas, shape (cells,)."""
    scale = r.mean()
    fit = np.polyfit(r / scale, values, DEGREE, w=np.sqrt(areas))
    return np.asarray(np.polyval(np.polyder(fit), r / scale) / scale)
