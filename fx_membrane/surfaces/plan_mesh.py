"""Triangles between the segments of a plan, by gmsh in a separate process."""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..runtime.child_process import run_script
from . import gmsh_script

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

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
    """

    points: Array
    segments: Integers
    loops: Integers
    sizes: Array
    largest: float
    field: tuple[Array, Integers, Array] = field(
        default_factory=lambda: (np.zeros((0, 2)), np.zeros((0, 3), dtype=np.int64), np.zeros(0))
    )


def triangulated(plan: PlanSegments) -> tuple[Array, Integers]:
    """Mesh a plan: points, shape (m, 2), those of the plan first, and triangles, counter-clockwise, shape (cells, 3).

    Raises:
        ValueError: gmsh cannot mesh it.
        ImportError: gmsh is not installed.
    """
    with tempfile.TemporaryDirectory(prefix="fx_membrane-") as folder:
        field_points, field_triangles, field_sizes = plan.field
        np.savez(
            Path(folder, "plan.npz"),
            points=plan.points,
            segments=plan.segments,
            loops=plan.loops,
            sizes=plan.sizes,
            largest=plan.largest,
            field_points=field_points,
            field_triangles=field_triangles,
            field_sizes=field_sizes,
        )
        code, words = run_script(
            gmsh_script.__file__, ["plan.npz", "mesh.npz"], Path(folder), SECONDS, "gmsh has meshed a plan"
        )
        if code == gmsh_script.NO_GMSH:
            raise ImportError(
                f"gmsh does not start ({words}); install it: apt install python3-gmsh, or pip install gmsh."
            )
        if code:
            raise ValueError(f"gmsh cannot mesh the plan ({words}); give another size, or move its lines apart.")
        with np.load(Path(folder, "mesh.npz"), allow_pickle=False) as mesh:
            points, triangles = mesh["points"], mesh["triangles"]
    points[: len(plan.points)] = plan.points  # without the rounding of gmsh
    a, b, c = (points[corner] for corner in triangles.T)
    turned = (b - a)[:, 0] * (c - a)[:, 1] < (b - a)[:, 1] * (c - a)[:, 0]
    triangles[turned] = triangles[turned][:, [0, 2, 1]]
    _check_edges(plan, triangles, len(points))
    return points, triangles


def _check_edges(plan: PlanSegments, triangles: Integers, count: int) -> None:
    """Refuse a mesh without the segments of its plan."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    wanted = np.sort(plan.segments, axis=1)
    lost = np.flatnonzero(~np.isin(wanted @ [count, 1], edges @ [count, 1]))
    if len(lost):
        x, y = plan.points[plan.segments[lost[0]]].mean(axis=0)
        raise ValueError(
            f"gmsh loses a segment of the plan at ({x:.6g}, {y:.6g}); give a smaller size there, or move lines apart."
        )
