"""Membranes in plan: geometry, prescribed stress, and the stress in space that follows from it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..geometry.sizes import SLIVER, aspects, measures, normals
from ..model.parts import Membrane

Array = NDArray[np.float64]
Field = Callable[[Array], ArrayLike]

UPRIGHT_SHARE = 1e-8  # plan component over vector, that counts as zero


class Plan(NamedTuple):
    """Membrane in plan.

    Attributes:
        cells: Nodes of the cells, shape (cells, 3).
        gradients: Gradients of the shape functions of their nodes, shape (cells, 2, 3) [1/m].
        areas: Plan areas, shape (cells,) [m2].
        stress: Stress along the axes of the plan, shape (cells, 2, 2) [N/m].
        frame: Warp and weft in plan as columns, shape (cells, 2, 2) [-].
    """

    cells: NDArray[np.int64]
    gradients: Array
    areas: Array
    stress: Array
    frame: Array

    def stiffness(self) -> Array:
        """Matrices of the cells for one coordinate, A B^T N B, shape (cells, 3, 3) [N/m]."""
        return np.asarray(np.einsum("c,cai,cab,cbj->cij", self.areas, self.gradients, self.stress, self.gradients))

    def deformation(self, points: Array) -> Array:
        """Gradients from the plan into space, or into another plan, shape (cells, 3 or 2, 2) [-]."""
        return np.asarray(np.einsum("cix,cai->cxa", points[self.cells], self.gradients))


def plan_of(name: str, part: Membrane, points: Array, axes: Array, field: Field | None) -> Plan:
    """Project a membrane on a plan.

    Args:
        name: Name of the membrane, for messages.
        part: The membrane.
        points: Positions of the nodes, shape (n, 3) [m].
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].
        field: Stress as a function of place; None for the prestress of the membrane.

    Raises:
        ValueError: A cell has no area in plan, the membrane folds over itself, or its stress or its warp are unfit.
    """
    plan = points @ axes[:, :2]
    upright = np.flatnonzero(aspects(np.column_stack([plan, np.zeros(len(plan))]), part.cells) > SLIVER)
    if len(upright):
        raise ValueError(
            f"Part {name!r}, cell {upright[0]} at {place(points, part.cells, upright[0])} has no area in plan; move "
            "its nodes apart there, or give another direction."
        )
    a, b, c = (plan[corner] for corner in part.cells.T)
    twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    sense = np.sign(twice.sum())
    folded = np.flatnonzero(twice * sense <= 0)
    if len(folded):
        raise ValueError(
            f"Part {name!r} folds over itself in plan at cell {folded[0]}, {place(points, part.cells, folded[0])}; "
            "unfold its plan there, or split it into parts that do not."
        )
    sides = np.stack([c - b, a - c, b - a], axis=2)
    gradients = np.stack([-sides[:, 1], sides[:, 0]], axis=1) / twice[:, None, None]
    frame = _plan_frame(name, part, points, axes, sense)
    wanted = _stress(name, part, points, field)
    return Plan(part.cells, gradients, np.abs(twice) / 2, frame @ wanted @ frame.swapaxes(1, 2), frame)


def _plan_frame(name: str, part: Membrane, points: Array, axes: Array, sense: float) -> Array:
    """Warp and weft in plan as columns, shape (cells, 2, 2) [-]."""
    given = np.broadcast_to(axes[:, 0] if part.warp is None else np.asarray(part.warp), (len(part.cells), 3))
    warp = given @ axes[:, :2]
    length = np.linalg.norm(warp, axis=1)
    gone = np.flatnonzero(length <= UPRIGHT_SHARE * np.linalg.norm(given, axis=1))
    if len(gone):
        raise ValueError(
            f"Part {name!r}, cell {gone[0]} at {place(points, part.cells, gone[0])}: its warp "
            f"{given[gone[0]].tolist()} vanishes in plan; give a vector with a direction there."
        )
    warp = warp / length[:, None]
    return np.stack([warp, sense * np.stack([-warp[:, 1], warp[:, 0]], axis=1)], axis=2)


def _stress(name: str, part: Membrane, points: Array, field: Field | None) -> Array:
    """Stress in plan along warp and weft, shape (cells, 2, 2) [N/m]."""
    if field is not None:
        try:
            value = validation.finite("its value", field(points[part.cells].mean(axis=1).T))
            n = len(part.cells)
            if value.shape not in {(), (n,), (2,), (n, 2), (2, 2), (n, 2, 2)}:
                raise ValueError(
                    f"it gives shape {value.shape}; give numbers, pairs along warp and weft, or tensors, for each of "
                    f"the {n} cells: ({n},), ({n}, 2) or ({n}, 2, 2)."
                )
            per_cell = value[:, None] if value.shape == (len(part.cells),) else value
            part = replace(part, prestress=per_cell)
        except ValueError as error:
            raise ValueError(f"stress of part {name!r}, as a function of place: {error}") from error
    tensors = part.prestress_tensors()
    least = np.linalg.eigvalsh(tensors)[:, 0]
    cell = int(least.argmin())
    if least[cell] <= 0:
        raise ValueError(
            f"Part {name!r}, cell {cell} at {place(points, part.cells, cell)}: its stress in plan is not positive, "
            f"with a principal value of {least[cell]:g}; give a tension in all directions."
        )
    return tensors


def cauchy(plan: Plan, points: Array, warp: Array | None = None) -> tuple[Array, Array]:
    """Cauchy stress times thickness in the frame of warp and weft, shape (cells, 2, 2) [N/m], and the warp (cells, 3).

    The warp is that of the plan, carried into space, if no unit tangents are given, shape (cells, 3).
    """
    gradient = plan.deformation(points)
    normal = normals(points, plan.cells)
    if warp is None:
        warp = np.einsum("cxa,ca->cx", gradient, plan.frame[:, :, 0])
        warp /= np.linalg.norm(warp, axis=1, keepdims=True)
    frame = np.stack([warp, np.cross(normal, warp)], axis=2)
    local = frame.swapaxes(1, 2) @ gradient
    ratio = measures(points, plan.cells) / plan.areas
    stress = local @ plan.stress @ local.swapaxes(1, 2) / ratio[:, None, None]
    return (stress + stress.swapaxes(1, 2)) / 2, warp


def place(points: Array, cells: NDArray[np.int64], cell: int) -> str:
    """Show the centre of a cell in a message."""
    return validation.format_point(points[cells[cell]].mean(axis=0))
