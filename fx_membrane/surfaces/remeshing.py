"""New meshes of found shapes, with their prestress."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..form_finding.form import Form
from ..geometry.sizes import measures
from ..model.digests import fingerprints, of_settings
from ..model.parts import Membrane, Part
from ..model.ropes import refuse_ropes
from ..model.structure import Structure
from ..model.supports import Support
from ..runtime.processes import refuse_differences, together
from .renewed_mesh import NewMesh, new_mesh

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Size = float | Callable[[Array], ArrayLike]


@dataclass(frozen=True, eq=False, repr=False)
class Remeshed:
    """Structure on a new mesh.

    Attributes:
        structure: The structure, with the stress of the old one as prestress.
        nodes: For each node of the old structure its number in the new one, -1 if it is gone, shape (old nodes,).

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> rim = Support(np.unique(boundary_edges(triangles)))
        >>> sheet = Structure(points, {"sheet": Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)}, [rim])
        >>> finer = remeshed(sheet, 0.5)
        >>> len(finer.structure.points) > len(points)
        True
        >>> finer.structure.points[finer.nodes[2]].round(6).tolist(), points[2].tolist()  # a corner
        ([1.0, -1.0, 0.0], [1.0, -1.0, 0.0])
    """

    structure: Structure
    nodes: Integers

    def __repr__(self) -> str:
        return f"Remeshed({self.structure!r})"


def remeshed(
    shape: Structure | Form, size: Size, keep: ArrayLike = (), comm: MPI.Intracomm = MPI.COMM_WORLD
) -> Remeshed:
    """Mesh the membranes of a structure or a form anew, with cells of a wanted size.

    Rims, seams, held lines, and cables and masts along edges remain lines of edges, with corners, ends and crossings.
    Nodes held alone and those of bars off the membranes stay where they are. A ring keeps a segment for each 30
    degrees; cells grow from there to the wanted size. New nodes are on the curved surface, and on the curved lines,
    that the old nodes stand for: their distance from it falls as the third power of the old mesh size.

    Stress and warp are interpolated in the frame of warp and weft: a constant stress stays constant, a linear one
    linear; their error falls as the square of the old mesh size. Forces of bars are interpolated along their lines. The
    new structure is near equilibrium: a form finding of one step, or a stage without loads, moves it a little. The mean
    falls as the square of the old mesh size; the largest has a logarithm more.

    Args:
        shape: The structure or form.
        size: Wanted length of the edges of cells [m]; a number, or a function of places, called with shape (3, k), that
            returns shape (k,).
        keep: Further nodes that stay where they are, as those of point loads, shape (k,).
        comm: The processes that call: the first one meshes, all get the structure.

    Raises:
        ValueError: The size is not positive, or larger than the membranes; there is no membrane; one has no rim, only
            one side, or cannot be flattened without a fold; a term has data per cell; the input differs between
            processes.
        ImportError: gmsh is not installed.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> points[:, 2] = points[:, 0] * points[:, 1]
        >>> rim = boundary_edges(triangles)
        >>> parts = {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3), "edge": Cable(rim, 1e7, 2e4)}
        >>> fine = remeshed(Structure(points, parts, [Support([0, 4, 20, 24])]), size=0.25)
        >>> fine.structure.supports[0].nodes.tolist() == fine.nodes[[0, 4, 20, 24]].tolist()
        True
        >>> round(float(np.asarray(fine.structure.parts["edge"].prestress)), 6)
        20000.0
    """
    validation.communicator("remeshed comm", comm)
    with together(comm):
        validation.instance("remeshed shape", shape, Structure | Form)
        structure = shape.structure if isinstance(shape, Form) else shape
        refuse_ropes("remeshed", structure)
        kept = validation.indices("keep", keep, empty=True)
        structure.check_nodes("keep", kept)
        sizes = _checked_size(structure, size)
    refuse_differences(
        comm, lambda: fingerprints(structure) | of_settings({"keep": kept, "size": sizes(structure.points)})
    )
    mesh = None
    with together(comm):
        if comm.rank == 0:
            mesh = new_mesh(structure, sizes, kept)
    mesh = comm.bcast(mesh)
    with together(comm):
        return Remeshed(_structure(structure, mesh), mesh.nodes)


def _checked_size(structure: Structure, size: Any) -> Callable[[Array], Array]:
    """Check the wanted size; return it as a function of places, shape (k, 3) to (k,)."""
    for name, part in structure.parts.items():
        if np.ptp(part.natural_tensors(), axis=0).any():
            raise ValueError(
                f"Part {name!r} has a natural stretch that differs from cell to cell, which new cells cannot take; "
                "leave it out by dataclasses.replace(part, natural_stretch=1.0), and give that of the new cells."
            )
    membranes = list(structure.parts_of(Membrane).values())
    if not membranes:
        raise ValueError(f"The structure has no membrane to mesh anew; its parts are {list(structure.parts)}.")
    for name in structure.parts:
        structure.check_sides(name)
    used = np.concatenate([part.cells.ravel() for part in membranes])
    extent = float(np.ptp(structure.points[used], axis=0).max())
    if callable(size):
        values = validation.finite("size, as a function of places,", size(structure.points.T))
        if values.shape != (len(structure.points),) or values.min() <= 0 or values.min() > extent:
            raise ValueError(
                f"size, as a function of places, gives {validation.short_repr(values)}; it must give positive numbers, "
                f"one for each place, less than the size of the membranes, {extent:g}."
            )
        _check_count(structure, values, extent)
        return lambda places: np.asarray(size(places.T), dtype=np.float64)
    number = validation.positive("size", size)
    if number > extent:
        raise ValueError(f"size is {number:g}, more than that of the membranes, {extent:g}; give that of their cells.")
    _check_count(structure, np.full(len(structure.points), number), extent)
    return lambda places: np.full(len(places), number)


def _check_count(structure: Structure, sizes: Array, extent: float) -> None:
    """Refuse sizes at the nodes, shape (n,) [m], that make more cells than gmsh meshes."""
    for part in structure.parts_of(Membrane).values():
        least = sizes[part.cells].max(axis=1)  # of a cell, so that a single fine place is no fault
        if float(np.sum(measures(structure.points, part.cells) / least**2)) > validation.MAX_INTEGER / 10:
            raise ValueError(
                f"size is {least.min():g}, for membranes of the size {extent:g}: too many cells; give a larger one."
            )


def _structure(structure: Structure, mesh: NewMesh) -> Structure:
    parts: dict[str, Part] = {}
    for name, part in structure.parts.items():
        natural = part.natural_tensors()[0]  # the same in all cells
        one = (
            natural.item()
            if natural.size == 1
            else part.natural_stretch
            if np.ndim(part.natural_stretch) == 0
            else natural
        )
        changes: dict[str, Any] = {"cells": mesh.cells[name], "natural_stretch": one}
        if name in mesh.prestress:
            changes["prestress"] = mesh.prestress[name]
        if name in mesh.warp:
            changes["warp"] = mesh.warp[name]
        parts[name] = replace(part, **changes)
    supports = [
        Support(nodes, support.components) for nodes, support in zip(mesh.supports, structure.supports, strict=True)
    ]
    return replace(structure, points=mesh.points, parts=parts, supports=supports)
