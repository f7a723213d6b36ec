"""Roofs on which rain stands in several basins."""

from typing import Any

import numpy as np

from fx_membrane import (
    Cable,
    DistributedLoad,
    Fabric,
    LoadedProblem,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
)

OWN_WEIGHT = Stage("own weight", [DistributedLoad((0, 0, -400.0), "roof")])


def ridged_roof():
    """Soft roof, 4 x 2, of two shallow hollows on both sides of a held ridge at x = -0.5, a little below its rim."""
    points, triangles = rectangle(4.0, 2.0, 16, 8)
    rim, ridge = np.unique(boundary_edges(triangles)), np.flatnonzero(points[:, 0] == -0.5)
    points[:, 2] = -0.005 * (1 - np.abs(points[:, 1])) * (1 - np.abs(points[:, 0] + 0.5) / 2.5)
    points[rim, 2] = 0.0
    return Structure(points, {"roof": Membrane(triangles, Fabric(2e5, 0.3), 2e3)}, [Support(np.union1d(rim, ridge))])


def roof_on_a_low_point():
    """Roof, 4 x 4, whose middle is held 12 cm below the rim."""
    points, triangles = rectangle(4.0, 4.0, 8, 8)
    middle = int(np.argmin(np.abs(points).sum(axis=1)))
    points[middle, 2] = -0.12
    rim = np.unique(boundary_edges(triangles))
    return Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3), 1.5e3)}, [Support([*rim, middle])])


def terraced_roof():
    """Soft roof of three bays, one lower than the other, within a higher rim, with cables between them that sag."""
    points, triangles = rectangle(6.0, 2.0, 24, 6)
    rim = np.unique(boundary_edges(triangles))
    along = points[:, 0] + 3
    bay = np.minimum(along // 2, 2).astype(int)
    share = along / 2 - bay
    base = np.interp(along, [0, 2, 4, 6], [0.12, 0.13, 0.08, 0.12])
    low = np.array([0.09, 0.04, -0.11])[bay]
    points[:, 2] = base + (low - base) * 4 * share * (1 - share) * (1 - points[:, 1] ** 2)
    points[rim, 2] = 0.12
    parts: dict[str, Any] = {"roof": Membrane(triangles, Fabric(2e5, 0.3), 2e3)}
    for place in (2, 4):
        line = np.flatnonzero(np.isclose(along, place))
        parts[f"ridge {place}"] = Cable(polyline(line[np.argsort(points[line, 1])]), 1e6, 4e3)
    return Structure(points, parts, [Support(rim)])


def tangent_rates(loaded: LoadedProblem, displacement, held, largest: float):
    """Observed orders of the distance between residuals and their tangent with its one-sided borders.

    Args:
        loaded: The problem.
        displacement: The state, shape (n, 3) [m].
        held: Components that do not move, shape (n, 3).
        largest: Largest distance from the state [m].
    """
    numbering = loaded.discretization
    x = numbering.to_petsc(displacement)
    way = numbering.to_petsc(np.where(held, 0.0, np.random.default_rng(1).normal(size=displacement.shape)))
    change = numbering.create_vector()
    loaded.tangent(x).mult(way, change)
    borders = loaded.borders(x, one_sided=True)
    for column, row, compliance in zip(borders.vectors, borders.rows, borders.compliances, strict=True):
        change.axpy(row.dot(way) / compliance, column)
    borders.free()
    errors = []
    for h in largest / 2.0 ** np.arange(4):
        moved = x.copy()
        moved.axpy(h, way)
        rest = loaded.residual(moved)
        rest.axpy(-1.0, loaded.residual(x))
        rest.axpy(-h, change)
        loaded.constraints.zero_constrained(rest)
        errors.append(rest.norm())
    return np.log2(np.divide(errors[:-1], errors[1:]))
