"""Triangles between the segments of plans, by gmsh in a separate process."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..checks.values import counted
from ..runtime.child_process import run_script
from ..runtime.gmsh_process import NO_GMSH, not_started
from . import gmsh_script

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

DIGITS = 9  # of coordinates over the size of a plan: far below a cell, far above the rounding of a unit
BLOCK = 512  # segments compared with all others at a time
SECONDS = 24 * 3600  # gmsh ends by itself


@dataclass(frozen=True, eq=False)
class PlanSegments:
    """Segments of a plan, each of which remains one edge of the mesh.

    Attributes:
        points: Ends of the segments, and single nodes, shape (n, 2) [m].
        segments: Rows of their ends, shape (segments, 2).
        loops: 0 for segments of the rim, 1 and more for those of a hole, -1 for lines within; those of a loop follow
            each other, end to start. Shape (segments,).
        sizes: Wanted size of the cells at the points, shape (n,) [m].
        largest: Largest size wanted [m].
        field: Points (m, 2), triangles (k, 3) and sizes (m,) of a field of wanted sizes, instead of those at the
            points; empty without one.
        name: Name of the plan, for messages.
    """

    points: Array
    segments: Integers
    loops: Integers
    sizes: Array
    largest: float
    field: tuple[Array, Integers, Array] = field(
        default_factory=lambda: (np.zeros((0, 2)), np.zeros((0, 3), dtype=np.int64), np.zeros(0))
    )

    name: str = "the plan"


def triangulated(plans: Sequence[PlanSegments]) -> list[tuple[Array, Integers]]:
    """Mesh plans: points, shape (m, 2), those of the plan first, and triangles, counter-clockwise, shape (cells, 3).

    gmsh meshes each in its own size, on a grid: the last digit of a coordinate, which a unit changes, would change
    cells. One process meshes all, each as if it were alone.

    Raises:
        ValueError: Segments of one cross, or gmsh cannot mesh it.
        ImportError: gmsh is not installed.
    """
    for plan in plans:
        _check_crossings(plan)
    with tempfile.TemporaryDirectory(prefix="fx_membrane-") as name:
        folder = Path(name)
        for number, plan in enumerate(plans):
            _write(folder / f"plan-{number}.npz", plan)
        meshes = [folder / f"mesh-{number}.npz" for number in range(len(plans))]

        def work() -> str:
            done = sum(mesh.exists() for mesh in meshes)
            return f"gmsh has meshed {done} of {counted(len(plans), 'plan')}"

        code, words = run_script(gmsh_script.__file__, [str(len(plans))], folder, SECONDS, work)
        if code == NO_GMSH:
            raise not_started(words)
        if code:
            left = [plan.name for plan, mesh in zip(plans, meshes, strict=True) if not mesh.exists()]
            where = left[0] if left else plans[-1].name
            raise ValueError(f"gmsh cannot mesh {where} ({words}); give another size, or move its lines apart.")
        return [_read(mesh, plan) for plan, mesh in zip(plans, meshes, strict=True)]


def _frame(plan: PlanSegments) -> tuple[Array, float]:
    """Origin and size of the grid of a plan."""
    return plan.points.min(axis=0), float(np.ptp(plan.points, axis=0).max())


def _write(file: Path, plan: PlanSegments) -> None:
    field_points, field_triangles, field_sizes = plan.field
    origin, size = _frame(plan)
    np.savez(
        file,
        points=np.round((plan.points - origin) / size, DIGITS),
        segments=plan.segments,
        loops=plan.loops,
        sizes=np.round(plan.sizes / size, DIGITS),
        largest=np.round(plan.largest / size, DIGITS),
        field_points=np.round((field_points - origin) / size, DIGITS),
        field_triangles=field_triangles,
        field_sizes=np.round(field_sizes / size, DIGITS),
    )


def _read(file: Path, plan: PlanSegments) -> tuple[Array, Integers]:
    origin, size = _frame(plan)
    with np.load(file, allow_pickle=False) as mesh:
        points, triangles = origin + size * mesh["points"], mesh["triangles"]
    points[: len(plan.points)] = plan.points  # without the rounding of gmsh
    a, b, c = (points[corner] for corner in triangles.T)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    _check_edges(plan, triangles, len(points))
    return points, triangles


def _check_crossings(plan: PlanSegments) -> None:
    """Refuse segments that cross each other: some versions of gmsh never end with them."""
    start, end = plan.points[plan.segments].swapaxes(0, 1)
    way, size = end - start, _frame(plan)[1]
    for first in range(0, len(start), BLOCK):
        here = slice(first, first + BLOCK)
        sides = [_side(start[here, None], way[here, None], points[None]) for points in (start, end)]
        others = [_side(start[None], way[None], points[here, None]) for points in (start, end)]
        far = np.min([np.abs(side) for side in (*sides, *others)], axis=0) > 10.0**-DIGITS * size**2
        for one, other in np.argwhere((sides[0] * sides[1] < 0) & (others[0] * others[1] < 0) & far)[:1]:
            share = sides[0][one, other] / (sides[0][one, other] - sides[1][one, other])
            x, y = start[other] + share * way[other]
            raise ValueError(f"Lines of {plan.name} cross at ({x:.6g}, {y:.6g}); move them apart.")


def _side(start: Array, way: Array, point: Array) -> Array:
    """Twice the area of the triangle of a segment and a point, positive to its left [m2]."""
    along = point - start
    return np.asarray(way[..., 0] * along[..., 1] - way[..., 1] * along[..., 0])


def _check_edges(plan: PlanSegments, triangles: Integers, count: int) -> None:
    """Refuse a mesh without the segments of its plan."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    wanted = np.sort(plan.segments, axis=1)
    lost = np.flatnonzero(~np.isin(wanted @ [count, 1], edges @ [count, 1]))
    if len(lost):
        x, y = plan.points[plan.segments[lost[0]]].mean(axis=0)
        raise ValueError(
            f"gmsh loses a segment of {plan.name} at ({x:.6g}, {y:.6g}); give a smaller size, or move lines apart."
        )
