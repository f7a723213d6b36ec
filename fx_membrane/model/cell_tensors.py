"""Symmetric tensors of cells in the warp/weft frame, from the notations that users give: number, pair, tensor."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def of_membrane(what: str, given: ArrayLike, cells: int) -> NDArray[np.float64]:
    """Tensors of all cells, shape (cells, 2, 2), from numbers, (warp, weft) pairs or tensors.

    Raises:
        ValueError: The shape is none of these.
    """
    value = np.asarray(given)
    if value.shape in ((), (1,), (cells, 1)):
        return np.broadcast_to(value.reshape(-1, 1, 1) * np.eye(2), (cells, 2, 2))
    if value.shape == (2,) or (value.shape == (cells, 2) and cells != 2):
        return np.broadcast_to(value.reshape(-1, 2, 1) * np.eye(2), (cells, 2, 2))
    if value.shape not in ((2, 2), (cells, 2, 2)):
        raise ValueError(
            f"{what} has shape {value.shape}; give a number, a (warp, weft) pair or a (2, 2) tensor, "
            f"or one of these for each of the {cells} cells: ({cells}, 1), ({cells}, 2) or ({cells}, 2, 2)."
        )
    return np.broadcast_to(value, (cells, 2, 2))


def of_bar(what: str, given: ArrayLike, cells: int) -> NDArray[np.float64]:
    """Numbers of all cells, shape (cells, 1, 1), from a number, or one per cell.

    Raises:
        ValueError: The shape is neither.
    """
    value = np.asarray(given)
    if value.shape not in ((), (cells,)):
        raise ValueError(f"{what} has shape {value.shape}; give a number or one for each of the {cells} cells.")
    return np.broadcast_to(value.reshape(-1, 1, 1), (cells, 1, 1))


def once(tensors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Tensors without the copies of one that all cells share, shape (1, d, d); as given where they have their own.

    A property of all cells is found in a thousandth of the time.
    """
    return tensors[:1] if tensors.strides[0] == 0 else tensors


def are_isotropic(tensors: NDArray[np.float64]) -> bool:
    """Return True if tensors (n, 2, 2) are multiples of the identity, which have no direction."""
    tensors = once(tensors)
    return np.array_equal(tensors, tensors[:, :1, :1] * np.eye(2))


def check_symmetry(what: str, tensors: NDArray[np.float64]) -> None:
    """Refuse tensors (n, d, d) that are not symmetric."""
    tensors = once(tensors)
    skew = np.flatnonzero((tensors != tensors.swapaxes(1, 2)).any(axis=(1, 2)))
    if len(skew):
        tensor = tensors[skew[0]].tolist()
        raise ValueError(f"{what} {tensor} is not symmetric; give [[warp, shear], [shear, weft]].")
