"""Meshes of sails: drawn in plan, meshed by gmsh, and lifted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..model.digests import of_settings
from ..runtime.processes import refuse_differences, together
from .lifting import harmonic
from .plan_mesh import triangulated
from .round_hole import RoundHole
from .sail_plan import draw

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class SailMesh:
    """Mesh of a sail.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        triangles: Cells, counter-clockwise in plan, shape (cells, 3).
        lines: Nodes along each edge, hole and line, by name, shape (k,), for `polyline`; those around a hole end with
            the first. The edge from corner "A" to "B" is named "A-B".
        nodes: Node of each corner and each point, by name.

    Example:
        >>> mesh = sail_mesh({"A": (0, 0, 0), "B": (4, 0, 1), "C": (0, 4, 1)}, size=4.0)
        >>> list(mesh.lines), mesh.points[mesh.nodes["B"]].tolist()
        (['A-B', 'B-C', 'C-A'], [4.0, 0.0, 1.0])
        >>> edge = Cable(polyline(mesh.lines["A-B"]), 1e7)
    """

    points: Array
    triangles: NDArray[np.int64]
    lines: Mapping[str, NDArray[np.int64]]
    nodes: Mapping[str, int]

    def __repr__(self) -> str:
        return f"SailMesh({len(self.points)} points, {len(self.triangles)} triangles, lines {list(self.lines)})"


def sail_mesh(
    corners: Mapping[str, ArrayLike] | ArrayLike,
    size: float,
    sag: float | Mapping[str, float] = 0.0,
    holes: Mapping[str, RoundHole | ArrayLike] | None = None,
    lines: Mapping[str, Sequence[Any]] | None = None,
    points: Mapping[str, ArrayLike] | None = None,
    sizes: Mapping[str, float] | None = None,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> SailMesh:
    """Mesh a sail, drawn in the plan of x and y, as a start of form finding.

    Edges, holes, lines and points become nodes and edges of the mesh, so that cables and supports can be attached:
    `Cable(polyline(mesh.lines["A-B"]), ...)`, `Support([mesh.nodes["A"]])`. Heights between the given ones follow from
    a harmonic function, that is with the least slopes. gmsh runs in a process of its own: models open here stay.

    Args:
        corners: Corners in order round the plan, in either sense, by name, each of shape (2,), at height zero, or (3,)
            [m]; or as rows, shape (n, 2) or (n, 3), which are named "0", "1", ...
        size: Wanted length of the edges of cells [m].
        sag: Rise of the edges over their chords, towards the inside, as a share of the chord [-]; a number for all, or
            by edge. Edges with a sag are arcs in plan, those without are straight. A negative one bulges.
        holes: Holes by name: a `RoundHole`, or corners of a polygon, shape (k, 2) or (k, 3) [m].
        lines: Ridges and valleys by name, each a list of at least two points: names of corners or `points`, pairs (edge
            or hole, share of its length), or places, shape (2,) or (3,) [m]. A line takes its heights from its points,
            if all have one. Lines meet in common points only.
        points: Single points by name, as mast heads, each of shape (2,) or (3,) [m].
        sizes: Other sizes, by name of an edge, a hole, a line or a point [m]. A ring has at least 12 segments.
        comm: The processes that call: the first one meshes, all get the mesh.

    Raises:
        ValueError: The plan folds over itself, as where edges cross; a hole or a line is not inside, or touches an
            edge elsewhere than in a point of the line; a size is not positive, or larger than the plan; one place has
            two heights; a name is given twice, or unknown; the input differs between processes.
        ImportError: gmsh is not installed.

    Example:
        >>> corners = {"A": (0, 0, 3), "B": (8, 0, 0), "C": (8, 8, 3), "D": (0, 8, 0)}
        >>> mesh = sail_mesh(corners, size=1.0, sag=0.1, holes={"ring": RoundHole((4, 4, 5), 0.5)})
        >>> list(mesh.lines), mesh.points[mesh.nodes["C"]].tolist()
        (['A-B', 'B-C', 'C-D', 'D-A', 'ring'], [8.0, 8.0, 3.0])
        >>> edge = Cable(polyline(mesh.lines["A-B"]), axial_stiffness=1e7, prestress=15e3)
        >>> bool(np.allclose(mesh.points[mesh.lines["ring"], 2], 5.0))
        True
    """
    validation.communicator("sail_mesh comm", comm)
    with together(comm):
        drawing, nodes, plan = draw(corners, size, sag, holes, lines, points, sizes)
    digests = {"points": plan.points, "segments": plan.segments, "sizes": plan.sizes, "heights": drawing.heights}
    refuse_differences(comm, lambda: of_settings(digests))
    mesh = None
    with together(comm):
        if comm.rank == 0:
            ((flat, triangles),) = triangulated([plan])
            heights = np.full(len(flat), np.nan)
            heights[: len(drawing.heights)] = drawing.heights
            mesh = np.column_stack([flat, harmonic(flat, triangles, heights)]), triangles
    found, triangles = comm.bcast(mesh)
    return SailMesh(found, triangles, {name: drawing.lines[name] for name in drawing.curves}, nodes)
