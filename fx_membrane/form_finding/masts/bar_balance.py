"""Form of bars alone, where the steps of form finding find none: as of a mast between guys.

A step takes the force of a bar for a force per length: a mast that pushes has negative stiffness then. The lengths are
found here from the balance of the forces themselves, by least squares with a trust region.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.sparse import csr_matrix

from ...checks import validation
from ...model.structure import Structure

Array = NDArray[np.float64]

# Ranges: tests/benchmarks/form_finding_constants.py, on 15 guyed masts: upright, oblique, loaded, near their limit.
# Accepted unbalanced force, relative to the largest of a bar; forms are the same from 3e-13 to 1e-11.
BALANCED_FORCE = 1e-12
# Share of its first length, below which a bar counts as shrunk to a point; the same from 1e-3 to 1e-2.
SHRUNK_LENGTH = 3e-3
# Numbers of steps, tried in turn, in which the unbalanced forces of the first shape are let go; the same with a third.
NUMBERS_OF_STEPS = (1, 5, 20)
# Maximum number of evaluations in each; the same from 20 to 200, fewer lose masts near their limit.
MAX_EVALUATIONS = 40
EPS = 1e-15  # tolerance of each: all digits
FOLLOWED = 1e-6  # unbalanced force, above which a step has lost its way; the same from 1e-7 to 1e-5
MAX_TURN = 45.0  # angle by which a free mast has turned, above which it is told [degrees]
ZERO_COORDINATE = 1e-9  # coordinate over the size, that is rounding: of words
MIN_TURN_COSINE = 0.5  # cosine of the angle by which a mast turns at most


def has_free_masts(structure: Structure) -> bool:
    """Return True if the structure has bars only, with a free mast among them."""
    free = ~structure.supported.all(axis=1)
    bars = structure.bars.values()
    return not structure.membranes and any(part.is_strut and bool(free[part.cells].any()) for part in bars)


def balanced_points(structure: Structure, loads: Array, pulse: Callable[[str], None]) -> Array | None:
    """Positions of the nodes in which forces of bars, each the prestress, balance loads on the nodes.

    Args:
        structure: The first shape, of bars alone.
        loads: Loads on the nodes, shape (n, 3) [N].
        pulse: Told at each try how far the search is.

    Returns:
        Positions, shape (n, 3) [m]; None where none were found.
    """
    parts = structure.parts.values()
    cells = np.concatenate([part.cells for part in parts])
    forces = np.concatenate([part.prestress_tensors().ravel() for part in parts])
    used = np.zeros(len(structure.points), dtype=bool)
    used[cells] = True
    free = ~structure.supported & used[:, None]
    force, size = np.abs(forces).max(), structure.size

    def placed(unknowns: Array) -> Array:
        points = structure.points.copy()
        points[free] = unknowns * size
        return points

    def residual(unknowns: Array) -> Array:
        direction = _lines(placed(unknowns), cells)[1]
        total = loads.copy()
        for end, sign in zip(cells.T, (1, -1), strict=True):
            np.add.at(total, end, sign * forces[:, None] * direction)
        return np.asarray(total[free] / force)

    def jacobian(unknowns: Array) -> csr_matrix:
        pulse(f"balance of bars, unbalanced share of the largest force {np.abs(residual(unknowns)).max():.1e}")
        length, direction = _lines(placed(unknowns), cells)
        across = np.eye(3) - direction[:, :, None] * direction[:, None, :]
        blocks = (forces / length)[:, None, None] * across * (size / force)
        return _assembled(blocks, cells, free)

    start = structure.points[free] / size
    first = residual(start)
    for count in NUMBERS_OF_STEPS:
        x = start
        for left in np.linspace(1, 0, count + 1)[1:]:  # share of the first unbalanced forces
            rest = left * first
            x = least_squares(
                lambda x, rest=rest: residual(x) - rest,
                x,
                jacobian,
                xtol=EPS,
                ftol=EPS,
                gtol=EPS,
                max_nfev=MAX_EVALUATIONS,
            ).x
            if np.abs(residual(x) - rest).max() > FOLLOWED:
                break
        points = placed(x)
        if np.abs(residual(x)).max() <= BALANCED_FORCE and is_standing(structure, points):
            return points
    return None


def is_standing(structure: Structure, points: Array) -> bool:
    """Return True if no bar has shrunk to a point, and no mast has turned by more than 60 degrees."""
    for part in structure.parts.values():
        first, before = _lines(structure.points, part.cells)
        now, after = _lines(points, part.cells)
        turned = part.is_strut and (np.sum(before * after, axis=1) < MIN_TURN_COSINE).any()
        if turned or (now < SHRUNK_LENGTH * first).any():
            return False
    return True


def _lines(points: Array, cells: NDArray[np.int64]) -> tuple[Array, Array]:
    """Lengths of bars, shape (cells,) [m], and their directions, shape (cells, 3)."""
    way = points[cells[:, 1]] - points[cells[:, 0]]
    length = np.maximum(np.linalg.norm(way, axis=1), np.finfo(float).tiny)
    return length, way / length[:, None]


def _assembled(blocks: Array, cells: NDArray[np.int64], free: NDArray[np.bool_]) -> csr_matrix:
    """Assemble the derivative of the forces on the free components from blocks of bars, shape (cells, 3, 3)."""
    number = np.full(free.shape, -1)
    number[free] = np.arange(free.sum())
    signs = np.array([[-1, 1], [1, -1]])
    rows = np.broadcast_to(number[cells][:, :, None, :, None], (len(cells), 2, 2, 3, 3))
    columns = np.broadcast_to(number[cells][:, None, :, None, :], rows.shape)
    values = signs[None, :, :, None, None] * blocks[:, None, None]
    kept = (rows >= 0) & (columns >= 0)
    return csr_matrix((values[kept], (rows[kept], columns[kept])), shape=(free.sum(), free.sum()))


def fallen_mast(structure: Structure, points: Array, guided: NDArray[np.bool_] | None = None) -> str:
    """Tell of a mast with a free end that has fallen from its first direction, in words; empty without one.

    Args:
        structure: The first shape, with the forces prescribed.
        points: The form, shape (n, 3) [m].
        guided: Nodes with a constraint of their own, which tells of them, shape (n,); none if not given.
    """
    free = ~structure.supported.all(axis=1)
    for name, part in structure.parts.items():
        if part.is_strut:
            (length, then), (now, after) = (_lines(place, part.cells) for place in (structure.points, points))
            cosine, pushes = np.sum(then * after, axis=1), part.prestress_tensors().ravel() != 0
            loose = free[part.cells].any(axis=1)
            if guided is not None:
                loose &= ~guided[part.cells].all(axis=1)
            # The length of a mast with a force is found with it; one without a force keeps neither.
            upright = np.where(pushes, cosine, np.minimum(cosine, cosine * now / length))
            for cell in np.flatnonzero(loose & (upright < np.cos(np.radians(MAX_TURN))))[:1]:
                head = part.cells[cell][free[part.cells[cell]]][-1]
                place = np.where(np.abs(points[head]) > ZERO_COORDINATE * structure.size, points[head], 0.0)
                return _fallen(f"{cell} of part {name!r}", pushes[cell], cosine[cell], length[cell], now[cell], place)
    return ""


def _fallen(who: str, pushes: bool, cosine: float, first: float, now: float, head: Array) -> str:
    """Tell how a mast has fallen, and what would hold it."""
    turn = f"turned by {np.degrees(np.arccos(np.clip(cosine, -1, 1))):.0f} degrees from its start"
    where = f"its end to {validation.format_point(head)}"
    if pushes:
        return (
            f"the mast in cell {who} has {turn}, {where}: there the forces given balance, and nothing "
            "holds it upright. Hold its head by supports and add mast and stays by masts_and_stays; or change the "
            "forces that meet there."
        )
    return (
        f"the mast in cell {who} has no force, and has {turn}, its length from {first:.4g} to "
        f"{now:.4g}, {where}: it holds nothing there. Hold its head by supports and add mast and stays by "
        "masts_and_stays; or give its force as prestress, or its length by a RigidBody of its ends."
    )
