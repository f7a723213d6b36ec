"""Force densities of cables and masts, from their prestress as force, horizontal force or force density."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...model.parts import Line, Part
from ...model.structure import Structure
from ..plan import UPRIGHT_SHARE, place
from ..reasons.unheld import lone_head

Array = NDArray[np.float64]
Measures = NDArray[np.str_]

MEASURES = ("horizontal force", "force", "force density")
FARTHEST = 1e9  # factor on a force density, beyond which a step is not accelerated
EARLIER_STEPS = 8  # number of earlier steps that the next one takes into account


def check_bars(structure: Structure) -> None:
    """Refuse bars whose prestress a linear system of positive force densities does not hold.

    Raises:
        ValueError: A cable is in compression; a mast with a force has an end that is not held.
    """
    free = ~structure.supported.all(axis=1)
    for name, part in structure.bars.items():
        force = part.prestress_tensors().ravel()
        if part.is_strut:
            unfit = np.flatnonzero((force != 0) & free[part.cells].any(axis=1))
            reason = (
                "has an end that is not held; hold its head in form finding, and add the mast by masts_and_stays; give "
                "its length by a RigidBody of its ends, without prestress; or find its head by updated_reference."
            )
        else:
            unfit = np.flatnonzero(force < 0)
            reason = "is in compression, which no cable carries; give a tension."
        if len(unfit):
            ends = part.cells[unfit[0]]
            if part.is_strut and (lone := lone_head(structure, int(ends[free[ends]][0]))):
                reason = f"has an end that is not held. {lone}; then add the mast there by masts_and_stays."
            where = place(structure.points, part.cells, unfit[0])
            raise ValueError(
                f"Part {name!r}, cell {unfit[0]} at {where}, with the prestress {force[unfit[0]]:g}, {reason}"
            )


def densities_of(
    bars: Mapping[str, Line], points: Array, axes: Array, measure: str | Mapping[str, Measures]
) -> dict[str, Array]:
    """Force densities of bars by their prestress and their length in a shape, by part, shape (cells,) [N/m].

    Args:
        bars: Cables, masts and ropes by name; the forces of masts are true ones.
        points: The shape, shape (n, 3) [m].
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].
        measure: Meaning of the prestress of cables, one of `MEASURES`, or one for each cell by part.

    Raises:
        ValueError: A cable of given horizontal force has no length in plan.
    """
    found = {}
    for name, part in bars.items():
        force = part.prestress_tensors().ravel()
        given = measure if isinstance(measure, str) else measure[name]
        length = measured_lengths(name, part, points, axes, given, force != 0)
        found[name] = np.divide(force, length, where=force != 0, out=np.zeros(len(force)))
    return found


def measured_lengths(
    name: str, part: Part, points: Array, axes: Array, measure: str | Measures, loaded: NDArray[np.bool_]
) -> Array:
    """Ratio of the prestress of a bar to its force density in a shape, shape (cells,) [m]; 1 for a force density.

    Raises:
        ValueError: A loaded cable of given horizontal force has no length in plan.
    """
    length = measures(points, part.cells)
    if part.is_strut:
        return length
    kinds = np.broadcast_to(np.asarray(measure), len(length))
    flat = measures(points @ axes[:, :2] @ axes[:, :2].T, part.cells)
    upright = np.flatnonzero((flat <= UPRIGHT_SHARE * length) & loaded & (kinds == "horizontal force"))
    if len(upright):
        raise ValueError(
            f"Part {name!r}, cell {upright[0]} at {place(points, part.cells, upright[0])} has no length in plan, so no "
            'horizontal force; give its force, with cables="force".'
        )
    return np.where(kinds == "force density", 1.0, np.where(kinds == "horizontal force", flat, length))


def difference(densities: Mapping[str, Array], wanted: Mapping[str, Array]) -> float:
    """Largest relative difference of force densities from those wanted, both by part; of zero ones, none."""
    differences = [
        np.abs(q[wanted[name] != 0] / wanted[name][wanted[name] != 0] - 1).max(initial=0.0)
        for name, q in densities.items()
    ]
    return float(max(differences, default=0.0))


class Acceleration:
    """Anderson's acceleration of the steps towards force densities, on their logarithms: they stay positive.

    Plain steps move nodes along an edge by little: the finer the mesh, the more of them. Where the difference grows,
    the earlier steps are forgotten.

    Args:
        largest: Largest factor on a force density in a step.

    Source:
        H. F. Walker, P. Ni, Anderson acceleration for fixed-point iterations, SIAM Journal on Numerical Analysis 49
        (2011) 1715-1735.
    """

    def __init__(self, largest: float = np.inf) -> None:
        self._largest = np.log(largest)
        self._points: list[Array] = []
        self._steps: list[Array] = []

    def __call__(self, densities: Mapping[str, Array], wanted: Mapping[str, Array]) -> dict[str, Array]:
        """Force densities of the next step, from those of this one and those that its shape asks for."""
        if not wanted:
            return {}
        loaded = {name: q != 0 for name, q in wanted.items()}
        now, then = (
            np.concatenate([np.log(np.abs(q[loaded[name]])) for name, q in values.items()])
            for values in (densities, wanted)
        )
        if self._steps and np.linalg.norm(then - now) > np.linalg.norm(self._steps[-1]):
            self._points, self._steps = [], []
        self._points = [*self._points[-EARLIER_STEPS:], now]
        self._steps = [*self._steps[-EARLIER_STEPS:], then - now]
        following = then
        if len(self._steps) > 1 and len(now):
            change = np.diff(self._steps, axis=0).T
            share = np.linalg.lstsq(change, self._steps[-1], rcond=1e-10)[0]
            following = then - (np.diff(self._points, axis=0).T + change) @ share
            if not np.abs(following - now).max() < np.log(FARTHEST):  # no step at all towards a form that collapses
                following = then
        if np.isfinite(self._largest):
            following = now + np.clip(following - now, -self._largest, self._largest)
        ends = np.cumsum([mask.sum() for mask in loaded.values()])[:-1]
        found = {name: np.zeros(len(q)) for name, q in wanted.items()}
        for (name, mask), part in zip(loaded.items(), np.split(following, ends), strict=True):
            found[name][mask] = np.sign(wanted[name][mask]) * np.exp(part)
        return found
