"""Arrays of a gmsh model; as a script, those of a mesh file: `python -P gmsh_reader.py mesh.msh arrays.npz SECONDS`.

The script runs in a separate process, since a damaged file may end it. So it needs gmsh and numpy only, never MPI, and
imports the package by its name.
"""

from __future__ import annotations

import os
import resource
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fx_membrane.runtime.gmsh_process import started_gmsh, without_errors


@dataclass(frozen=True)
class Group:
    """A physical group.

    Attributes:
        name: Physical name.
        dimension: 0 to 3.
        tag: Number of the group.
        cells: Node tags of its cells, (cells, nodes of a cell), by gmsh's name of the element type ("Triangle 3").
        nodes: Node tags of the group.
    """

    name: str
    dimension: int
    tag: int
    cells: dict[str, NDArray[np.int64]]
    nodes: NDArray[np.int64]


@dataclass(frozen=True)
class GmshMesh:
    """Node tags (n,), positions of the nodes (n, 3), and the physical groups."""

    tags: NDArray[np.int64]
    points: NDArray[np.float64]
    groups: list[Group]


def mesh_of_model(model: Any) -> GmshMesh:
    """Read the mesh of the current gmsh model, in the order of gmsh's node tags."""
    tags, coordinates, _ = model.mesh.getNodes()
    order = np.argsort(tags)
    return GmshMesh(
        tags=np.asarray(tags, dtype=np.int64)[order],
        points=np.reshape(coordinates, (-1, 3))[order],
        groups=[_group(model, *group) for group in model.getPhysicalGroups()],
    )


def _group(model: Any, dimension: int, tag: int) -> Group:
    cells: dict[str, list[NDArray[np.int64]]] = {}
    for entity in model.getEntitiesForPhysicalGroup(dimension, tag):
        for kind, _, nodes in zip(*model.mesh.getElements(dimension, entity), strict=True):
            name, _, _, size, *_ = model.mesh.getElementProperties(kind)
            cells.setdefault(name, []).append(np.asarray(nodes, dtype=np.int64).reshape(-1, size))
    return Group(
        name=model.getPhysicalName(dimension, tag),
        dimension=dimension,
        tag=tag,
        cells={name: np.concatenate(found) for name, found in cells.items()},
        nodes=np.asarray(model.mesh.getNodesForPhysicalGroup(dimension, tag)[0], dtype=np.int64),
    )


def save(mesh: GmshMesh, path: str | Path) -> None:
    """Write a mesh for `load`: arrays only, without code that Python would run."""
    arrays: dict[str, Any] = {
        "tags": mesh.tags,
        "points": mesh.points,
        "groups": np.array([(group.dimension, group.tag) for group in mesh.groups], dtype=np.int64).reshape(-1, 2),
        "names": np.array([group.name for group in mesh.groups], dtype=np.str_),
    }
    for i, group in enumerate(mesh.groups):
        arrays[f"{i} nodes"] = group.nodes
        arrays |= {f"{i} cells {kind}": cells for kind, cells in group.cells.items()}
    np.savez(path, **arrays)


def load(path: str | Path) -> GmshMesh:
    """Load the mesh that `save` wrote."""
    with np.load(path, allow_pickle=False) as arrays:
        groups = [
            Group(
                name=str(arrays["names"][i]),
                dimension=int(dimension),
                tag=int(tag),
                cells={key.removeprefix(f"{i} cells "): arrays[key] for key in arrays if key.startswith(f"{i} cells ")},
                nodes=arrays[f"{i} nodes"],
            )
            for i, (dimension, tag) in enumerate(arrays["groups"])
        ]
        return GmshMesh(arrays["tags"], arrays["points"], groups)


def _limit(kind: int, value: int) -> None:
    """Limit a resource of this process; the kernel ends it there, even without its parent."""
    _, hard = resource.getrlimit(kind)
    resource.setrlimit(kind, (value if hard == resource.RLIM_INFINITY else min(value, hard), hard))


def _main(source: str, target: str, seconds: str) -> None:
    # Counts in a damaged file ask for any amount of memory; sound ones need about ten times the size of the file.
    _limit(resource.RLIMIT_AS, 4 * 2**30 + 200 * os.path.getsize(source))
    _limit(resource.RLIMIT_CPU, int(seconds))
    gmsh = started_gmsh()
    without_errors(gmsh, lambda: gmsh.merge(source))
    save(mesh_of_model(gmsh.model), target)


if __name__ == "__main__":
    _main(*sys.argv[1:])
