"""Derivatives of forces and energies of cells by their shape, from differences between moved copies of the cells."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
from numpy.typing import NDArray

from .cells import Block

Array = NDArray[np.float64]

FIRST = 1e-5  # length of a difference for first derivatives, over the size of the cell
SECOND = 1e-3  # the same, for second ones
COLUMNS = 16384  # cells and copies of them taken at once: few calls for small meshes, arrays that fit a cache for all


def slopes_by_shape(block: Block, corners: Array, multipliers: Array, length: Array) -> tuple[Array, Array]:
    """First derivatives of forces and energies, shapes (cells, 3 k, 3 k) and (k, 3, cells).

    Args:
        block: The cells.
        corners: Their corners, shape (k, 3, cells) [m].
        multipliers: The multipliers at them, of the same shape.
        length: Sizes of the cells, shape (cells,) [m].
    """
    count, cells, step = 3 * len(corners), len(length), FIRST * length
    up, down = np.eye(count), -np.eye(count)
    rise = [
        np.concatenate(
            [part.reshape(count, -1, cells) for part in _of_copies(block.forces, corners, multipliers, step, moves)],
            axis=1,
        )
        for moves in (up, down)
    ]
    energies = [
        np.concatenate([*_of_copies(block.energies, corners, multipliers, step, moves)]) for moves in (up, down)
    ]
    slopes = (energies[0] - energies[1]) / (2 * step)
    return np.moveaxis((rise[0] - rise[1]) / (2 * step), -1, 0), slopes.reshape(corners.shape)


def curvatures_by_shape(block: Block, corners: Array, multipliers: Array, length: Array) -> Array:
    """Second derivatives of energies, shape (cells, 3 k, 3 k); see `slopes_by_shape`."""
    count, cells, step = 3 * len(corners), len(length), SECOND * length
    i, j = np.tril_indices(count)
    moves = np.concatenate([np.zeros((1, count)), np.eye(count), np.eye(count)[i] + np.eye(count)[j]])
    energies = np.concatenate([*_of_copies(block.energies, corners, multipliers, step, moves)])
    here, single, both = energies[0], energies[1 : count + 1], energies[count + 1 :]
    found = np.zeros((count, count, cells))
    found[i, j] = found[j, i] = (both - single[i] - single[j] + here) / step**2
    return np.ascontiguousarray(np.moveaxis(found, -1, 0))


def _of_copies(
    function: Callable[[Array, Array], Array], corners: Array, multipliers: Array, step: Array, moves: Array
) -> Iterator[Array]:
    """Values of a function of corners and multipliers for copies of the cells, some at a time.

    Args:
        function: The function.
        corners: Corners of the cells, shape (k, 3, cells) [m].
        multipliers: The multipliers at them.
        step: Length of a motion, shape (cells,) [m].
        moves: Steps of each component of the corners in each copy, shape (copies, 3 k) [-].
    """
    at_once = max(1, COLUMNS // max(1, len(step)))
    for first in range(0, len(moves), at_once):
        moved = moves[first : first + at_once].T.reshape(*corners.shape[:2], -1, 1) * step
        yield function(corners[:, :, None] + moved, multipliers)
