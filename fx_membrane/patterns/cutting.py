"""Cutting of membranes along seams into strips."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike

from ..checks import validation
from ..form_finding.form import Form
from ..model.parts import Membrane
from ..model.structure import Structure
from ..surfaces.remeshing import Size
from ..surfaces.surface_lines import SurfaceLine
from .curved_nodes import curved
from .cut_surface import split_along
from .parted import in_strips
from .strips import Strips
from .strips_of_size import of_size


def cut_strips(
    shape: Structure | Form,
    seams: Sequence[SurfaceLine | str],
    part: str | None = None,
    *,
    size: Size | None = None,
    names: Sequence[str] | None = None,
    roll_width: float | None = None,
    warp: Mapping[str, ArrayLike] | None = None,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
) -> Strips:
    """Cut membranes along seams into strips, each of them a membrane of its own.

    Triangles are split where seams cross them, so that the area remains the same. A seam that passes a node at less
    than 0.05 of the shortest edge there is led through the node. That moves the seam sideways by no more than this
    distance. Nodes of the structure keep their numbers; new nodes on seams come after them. Cables, masts, supports and
    other parts remain, with the new nodes on their edges.

    With a size all membranes are meshed anew, as by `remeshed`: nodes on seams, borders and cables are shared. They
    lie on the curved surface and lines that the cells approximate. Seams then keep their lines to 0.0005 of the
    shortest edge, apart from those led through a corner of the rim. `Strips.nodes` has the new numbers of nodes.

    The warp of each strip follows its axis: the principal axis of the strip laid out by a conformal map. A strip about
    as wide as long, as a corner piece, takes the axis of its least width: of several as narrow that nearest to the
    warp of the membrane. The prestress remains the same in space: where it has a direction, it is turned to the new
    warp, cell by cell.

    Args:
        shape: The structure or form.
        seams: Lines on the membranes, as of `geodesic`; or names of cables along which they are cut. They begin and end
            at borders or at other seams, and may cross.
        part: Name of the membrane that is cut; None for all.
        size: Wanted length of the edges of cells, a number or a function of places as in `remeshed` [m]; None for the
            cells as they are, split along the seams.
        names: Names of the strips, in their order; by default "strip 1" and so on, where several membranes are cut
            "roof 1" and so on. The first strip is that beside the first seam; a neighbour follows each one.
        roll_width: Width of the roll without allowances for welds: the most that a strip may have, laid out flat,
            across its axis [m].
        warp: Directions of the warp of some strips by name, in place of their axes; their means count, projected on
            the cells, each shape (3,).
        comm: With a size, the processes that call: the first one meshes, all get the strips.

    Raises:
        ValueError: A seam is not on the surface, ends within it, crosses itself or coincides with another one; a strip
            is no disc, folds when laid flat, or is wider than the roll; a name is missing, or taken; a warp is no
            direction in a strip. With a size, as `remeshed`.

    Warns:
        NarrowStripWarning: The mean width of a strip is less than 2 % of the largest one.

    Example:
        >>> points, triangles = rectangle(4.0, 3.0, 8, 6)
        >>> roof = Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3)}, [Support([0, 8, 54, 62])])
        >>> seams = [geodesic(roof, (-2, y, 0), (2, y, 0)) for y in (-0.6, 0.6)]
        >>> strips = cut_strips(roof, seams)
        >>> strips.names
        ('strip 1', 'strip 2', 'strip 3')
        >>> [edge.name for edge in strips.edges_of("strip 1")]
        ['seam 1', 'border 1', 'border 2', 'border 3']
    """
    validation.instance("cut_strips shape", shape, Structure | Form)
    structure = shape.structure if isinstance(shape, Form) else shape
    if roll_width is not None:
        roll_width = validation.positive("cut_strips roll_width", roll_width)
    parts = _parts(structure, part)
    validation.listed("seams", seams, "lines", "", isinstance(seams, str | SurfaceLine))
    validation.instance("cut_strips warp", warp, Mapping | None)
    axes = {name: validation.direction(f"warp of strip {name!r}", axis) for name, axis in (warp or {}).items()}
    split = split_along(structure, list(seams), parts, finest=size is not None)
    strips = in_strips(split, parts, names, roll_width, axes)
    count = len(structure.points)
    if size is None:
        found = replace(strips, nodes=np.arange(count))
    else:
        found = of_size(strips, curved(structure, split.mesh), count, size, comm)
    if isinstance(shape, Form):
        found = replace(found, force_unit=shape.force_unit, length_unit=shape.length_unit)
    return found


def _parts(structure: Structure, part: str | None) -> list[str]:
    """Names of the membranes that are cut."""
    if part is None:
        found = list(structure.parts_of(Membrane))
        if not found:
            raise ValueError(f"The structure has no membrane to cut; its parts are {list(structure.parts)}.")
    else:
        structure.part(part, Membrane)
        found = [part]
    for name in found:
        structure.check_sides(name)
    return found
