"""Elongations of a fabric measured in biaxial tests, between which compensation is interpolated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import ConvexHull

from ..checks import validation

Array = NDArray[np.float64]

COLLINEAR_DISTANCE = 1e-6  # distance of tests from one line over its length that counts as on it
TESTED_DISTANCE = 1e-2  # distance beyond tests over the size of the stress that counts as tested, within their accuracy


@dataclass(frozen=True, eq=False)
class BiaxialTests:
    """Elongations of a fabric under pairs of stresses along warp and weft, after conditioning, as in test reports.

    Args:
        stress: Stress along warp and weft in each test, shape (tests, 2) [N/m].
        elongation: Elongation along warp and weft there, change of length over unstressed length, shape (tests, 2) [-].

    Raises:
        ValueError: There are fewer than two tests, or the arrays differ in shape; a stress pair comes twice; an
            elongation is not between -0.2 and 0.2.

    Example:
        >>> tests = BiaxialTests(stress=[(2e3, 2e3), (4e3, 4e3)], elongation=[(0.004, 0.010), (0.006, 0.014)])
        >>> tests.at((3e3, 3e3)).round(6).tolist()
        [0.005, 0.012]
    """

    stress: ArrayLike
    elongation: ArrayLike

    def __post_init__(self) -> None:
        validation.store(self, validation.finite, "stress", "elongation")
        stress, found = np.asarray(self.stress), np.asarray(self.elongation)
        if stress.ndim != 2 or stress.shape[1:] != (2,) or len(stress) < 2 or found.shape != stress.shape:
            raise ValueError(
                f"BiaxialTests stress has shape {stress.shape} and elongation {found.shape}; give a (warp, weft) pair "
                "of each for at least two tests."
            )
        if len(np.unique(stress, axis=0)) < len(stress):
            raise ValueError("BiaxialTests stress has a pair twice; give the mean of these tests once.")
        if not (np.abs(found) <= 0.2).all():
            raise ValueError(
                f"BiaxialTests elongation reaches {found.flat[np.abs(found).argmax()]:g}; give change of length over "
                "length, as 0.012 for 1.2 %."
            )

    def at(self, stress: ArrayLike) -> Array:
        """Elongation along warp and weft under a pair of stresses, linear between tests, shape (2,) [-].

        A pair beyond the tests by up to 1 % of its size has the elongation of the nearest tested one.

        Raises:
            ValueError: The pair is outside the tests.
        """
        pair = validation.finite("stress", stress)
        tested, elongation = np.asarray(self.stress), np.asarray(self.elongation)
        line = _line_of(tested)
        if line is None:
            between = LinearNDInterpolator(tested, elongation, rescale=True)
            found = between(pair).ravel()
            if np.isfinite(found).all():
                return found
            hull = tested[ConvexHull(tested).vertices]
            nearest = _nearest(pair, hull, np.roll(hull, -1, axis=0))
            found = between(nearest + COLLINEAR_DISTANCE * (tested.mean(axis=0) - nearest)).ravel()
        else:
            order = np.argsort(line)
            nearest = _nearest(pair, tested[order[:-1]], tested[order[1:]])
            place = np.linalg.norm(nearest - tested[order[0]])
            found = np.array([np.interp(place, line[order] - line[order[0]], column) for column in elongation[order].T])
        if np.linalg.norm(pair - nearest) > TESTED_DISTANCE * np.linalg.norm(pair):
            raise ValueError(
                f"The stress pair ({pair[0]:.6g}, {pair[1]:.6g}) is outside the biaxial tests, {tested.tolist()}; add "
                "a test beyond it, or give factors."
            )
        return found


def _line_of(tested: Array) -> Array | None:
    """Places of tests along their line, as at one load ratio; None of tests that are on none."""
    away = tested - tested.mean(axis=0)
    along = np.linalg.svd(away)[2][0]
    line = away @ along
    beside = np.linalg.norm(away - np.outer(line, along), axis=1)
    return None if beside.max() > COLLINEAR_DISTANCE * np.ptp(line) else line


def _nearest(pair: Array, starts: Array, ends: Array) -> Array:
    """Place on segments that is nearest to a pair."""
    step = ends - starts
    share = np.clip(np.einsum("ij,ij->i", pair - starts, step) / np.einsum("ij,ij->i", step, step), 0.0, 1.0)
    places = starts + share[:, None] * step
    return np.asarray(places[np.linalg.norm(pair - places, axis=1).argmin()])
