"""Structures from gmsh: a model in memory or a .msh file, by its physical names."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import paths
from ..model.structure import Structure
from . import gmsh_file
from .gmsh_reader import GmshMesh, Group, mesh_of_model
from .groups import Groups, Makers, check_arguments, structure

KINDS = ("point", "curve", "surface", "volume")  # by dimension
CELLS = ("Line 2", "Triangle 3")  # gmsh's names of the element types of first order


def structure_from_gmsh(
    source: str | Path | None,
    parts: Makers,
    supports: Mapping[str, str] | None = None,
    separate: Sequence[tuple[str, str]] = (),
) -> Structure:
    """Structure of the physical groups of a gmsh mesh.

    Lines of a physical curve on the edge of a physical surface share its nodes: a cable made of them is tied to the
    membrane. `points` has the nodes of the parts, in the order of gmsh's numbers.

    Args:
        source: A mesh file of gmsh, format 2 or 4, or None for the meshed model open in this process. Files are read in
            a separate process: models open in gmsh here are unchanged.
        parts: For each physical name, a function that makes a part. It is given the cells (lines or triangles, of first
            order), and the points if it takes two arguments: `{"fabric": lambda cells: Membrane(cells, Fabric(Et=500e3,
            nu=0.3), prestress=1e3)}`.
        supports: For each physical name, the constrained components of its nodes: `{"corners": "xyz"}`. A group may be
            a part and a support: `{"fabric": "z"}` keeps a membrane flat.
        separate: Pairs of names of parts that lie on each other without being joined, see `Structure`.

    Raises:
        ValueError: An argument is of another kind; the file is not a mesh, or gmsh does not end on it; no model is
            open, or it has no mesh; a physical name does not exist, or more than one group has it, as a curve and a
            surface; its cells are not lines or triangles of first order, or do not fit its part; a support is on no
            part.
        ImportError: gmsh is not installed.
    """
    if source is not None:
        paths.path("source", source, spare=0)
    check_arguments(parts, supports)
    mesh = _open_mesh() if source is None else gmsh_file.read(source)
    return _structure(mesh, parts, supports or {}, separate)


def _open_mesh() -> GmshMesh:
    """Read the mesh of the model that is open in this process, without changing the model."""
    gmsh = sys.modules.get("gmsh")
    if gmsh is None or not _has_model(gmsh):
        raise ValueError(
            "No gmsh model is open in this process; call gmsh.initialize() and mesh a model before, or give the name "
            "of a mesh file."
        )
    mesh = mesh_of_model(gmsh.model)
    if not len(mesh.tags):
        raise ValueError("The gmsh model that is open has no mesh; call gmsh.model.mesh.generate(2) before.")
    return mesh


def _has_model(gmsh: Any) -> bool:
    if hasattr(gmsh, "isInitialized") and not gmsh.isInitialized():  # from gmsh 4.9 on
        return False
    try:
        return bool(gmsh.model.list())  # gmsh 4.8 has none before it is initialized
    except Exception:  # and fails once it is finalized; gmsh raises nothing more precise
        return False


def _structure(
    mesh: GmshMesh, parts: Makers, supports: Mapping[str, str], separate: Sequence[tuple[str, str]]
) -> Structure:
    named = _groups(mesh, [*parts, *supports])
    groups = Groups(
        points=mesh.points,
        cells={name: _rows(mesh, _cells(named[name])) for name in parts},
        nodes={name: _rows(mesh, named[name].nodes) for name in supports},
        kind="physical group",
        label=lambda row: f"gmsh's node {mesh.tags[row]}",
    )
    return structure(groups, parts, supports, separate)


def _rows(mesh: GmshMesh, tags: NDArray[np.int64]) -> NDArray[np.int64]:
    """Rows of node tags in the points of the mesh."""
    rows = np.searchsorted(mesh.tags, tags).clip(max=len(mesh.tags) - 1)
    missing = tags[mesh.tags[rows] != tags]
    if missing.size:
        raise ValueError(f"The mesh has cells at node {missing[0]}, which it lacks; write it again with gmsh.write.")
    return rows


def _groups(mesh: GmshMesh, wanted: Sequence[str]) -> dict[str, Group]:
    """Find the physical groups of some names; each name must mean one group."""
    named: dict[str, list[Group]] = {}
    for group in mesh.groups:
        named.setdefault(group.name, []).append(group)
    for name in wanted:
        if name not in named:
            raise ValueError(f"The mesh has no physical group {name!r}; it has {sorted(named)}.")
        if len(named[name]) > 1:
            what = " and ".join(f"a {KINDS[group.dimension]} (tag {group.tag})" for group in named[name])
            raise ValueError(
                f"The mesh has {len(named[name])} physical groups {name!r}, {what}; give each its own name."
            )
    return {name: named[name][0] for name in wanted}


def _cells(group: Group) -> NDArray[np.int64]:
    """Node tags of the cells of a physical group, shape (cells, 2 or 3)."""
    for kind in group.cells:
        if kind not in CELLS:
            raise ValueError(f"The physical group {group.name!r} has elements of type {kind}; give lines or triangles.")
    if len(group.cells) != 1:
        raise ValueError(f"The physical group {group.name!r} has no cells; mesh it before it is made a structure.")
    return next(iter(group.cells.values()))
