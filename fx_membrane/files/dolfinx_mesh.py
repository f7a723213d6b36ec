"""Structures from dolfinx meshes, by groups of tagged cells, edges and vertices."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from .. import _dolfinx
from ..checks import validation
from ..model.coincidence import COINCIDENT
from ..model.digests import fingerprints, of_settings
from ..model.structure import Structure
from ..runtime.processes import refuse_differences, together
from .groups import Groups, Makers, check_arguments, structure

# isort: split
from dolfinx.mesh import Mesh

SIMPLEX = ("vertices", "edges", "triangles", "tetrahedra")  # by dimension
CELL = ("point", "interval", "triangle", "tetrahedron")


def structure_from_dolfinx(
    mesh: Mesh | Sequence[Mesh],
    groups: Mapping[str, Any],
    parts: Makers,
    supports: Mapping[str, str] | None = None,
    separate: Sequence[tuple[str, str]] = (),
) -> Structure:
    """Structure of groups of a dolfinx mesh, the same on all its processes.

    Tagged edges of a mesh of triangles share its nodes: a cable made of them is tied to the membrane. Nodes of several
    meshes at the same place, within 1e-9 of their size, become one node; so a mesh of intervals, as of guys or masts,
    joins that of the fabric.

    `points` has the nodes of the parts in the order of their input numbers, `mesh.geometry.input_global_indices`, one
    mesh after the other. The cells of a part are in the order of `mesh.topology.original_cell_index`. Edges, and cells
    of a sub-mesh (`create_submesh`), have no input number: they are in the order of their nodes.

    Args:
        mesh: A mesh of straight simplices, in the plane (z = 0) or in space, or several. They may be distributed over
            processes; each must call this function.
        groups: For each name MeshTags and a value, or several values: `{"fabric": (cell_tags, 1), "rope": (edge_tags,
            [7, 8])}`; or a mesh, for all its cells.
        parts: For each name, a function that makes a part. It is given the cells (intervals or triangles) of that
            group, and the points if it takes two arguments: `{"fabric": lambda cells: Membrane(cells, Fabric(Et=500e3,
            nu=0.3), prestress=1e3)}`.
        supports: For each name, the constrained components of the nodes of that group: `{"corners": "xyz"}`.
        separate: Pairs of names of parts that lie on each other without being joined, see `Structure`. They must be in
            one mesh, with nodes of their own.

    Raises:
        ValueError: An argument is of another kind; cells are quadrilaterals, or curved; a name has no group, or its
            tags are of no mesh given or have no entity of that value; its cells are not intervals or triangles, or do
            not fit their part; a support is on no part; two nodes of one mesh coincide with one of another; an argument
            is not the same on all processes.
    """
    meshes = _checked_meshes(mesh)
    comm = meshes[0].comm
    with together(comm):
        check_arguments(parts, supports)
        wanted = {name: _group(name, groups, meshes) for name in dict.fromkeys([*parts, *(supports or {})])}
        for name in parts:
            _check_dimension(name, wanted[name])
        mine = [_nodes(msh) for msh in meshes], {name: _entities(group, meshes) for name, group in wanted.items()}
    refuse_differences(comm, lambda: of_settings(_asked(wanted, parts, supports)))
    gathered = comm.allgather(mine)
    numbers, points, first = _points([nodes for nodes, _ in gathered])
    found = {
        name: _rows(_merged([entities[name] for _, entities in gathered]), numbers[group.mesh], first[group.mesh])
        for name, group in wanted.items()
    }
    for name, group in wanted.items():
        _check_found(name, group, found[name], comm)
    joined = _joined(points, first)
    cells = {name: joined[found[name]] for name in parts}
    nodes = {name: joined[np.unique(found[name])] for name in supports or {}}
    inputs = np.concatenate(numbers)
    found_groups = Groups(points, cells, nodes, "group", lambda row: f"node {inputs[row]}")
    with together(comm):
        made = structure(found_groups, parts, supports or {}, separate)
    refuse_differences(comm, lambda: fingerprints(made))
    return made


class _Group(NamedTuple):
    """Tagged entities of one mesh, or all its cells.

    Attributes:
        mesh: Position of the mesh.
        dimension: Dimension of the entities.
        tags: MeshTags; None for all cells.
        values: Values of the entities.
    """

    mesh: int
    dimension: int
    tags: Any
    values: NDArray[np.int64]


class _Entities(NamedTuple):
    """Input numbers of the nodes of entities, shape (n, nodes), and input numbers of the entities, or None."""

    nodes: NDArray[np.int64]
    numbers: NDArray[np.int64] | None


def _checked_meshes(given: Any) -> list[Mesh]:
    meshes = [given] if isinstance(given, Mesh) else given
    if not isinstance(meshes, list | tuple) or not meshes or not all(isinstance(msh, Mesh) for msh in meshes):
        raise ValueError(f"mesh is {validation.short_repr(given)}; give a dolfinx Mesh, or a list of them.")
    for msh in meshes:
        kind, degree = _dolfinx.cell_name(msh), _dolfinx.geometry_degree(msh)
        if kind not in CELL:
            raise ValueError(f"The mesh has cells of the kind {kind}; give a mesh of triangles or of intervals.")
        if degree != 1:
            raise ValueError(
                f"The mesh has curved cells, of degree {degree}; give one with straight cells, of degree 1."
            )
        if MPI.Comm.Compare(msh.comm, meshes[0].comm) not in (MPI.IDENT, MPI.CONGRUENT):
            raise ValueError("The meshes are on different communicators; make them all on the same one.")
    return list(meshes)


def _group(name: str, groups: Any, meshes: list[Mesh]) -> _Group:
    """Find the entities that a name means."""
    validation.instance("groups", groups, Mapping)
    if name not in groups:
        raise ValueError(f"There is no group {name!r}; those given are {sorted(map(str, groups))}.")
    given, what = groups[name], f"The group {name!r}"
    if isinstance(given, Mesh):
        number = _position(f"{what} is a mesh", [given is msh for msh in meshes])
        return _Group(number, given.topology.dim, None, np.array([], dtype=np.int64))
    if not isinstance(given, list | tuple) or len(given) != 2 or not _dolfinx.is_tags(given[0]):
        raise ValueError(f"{what} is {validation.short_repr(given)}; give (MeshTags, value), or a mesh.")
    tags, values = given
    number = _position(f"{what} has MeshTags of a mesh", [_dolfinx.are_tags_of(tags, msh) for msh in meshes])
    return _Group(number, tags.dim, tags, validation.indices(f"{what}, value", values))


def _asked(wanted: Mapping[str, _Group], parts: Makers, supports: Mapping[str, str] | None) -> dict[str, Any]:
    """Arguments that must be the same on all processes, by subject."""
    groups = {
        f"group {name!r}": (group.mesh, group.dimension, group.tags is None, group.values)
        for name, group in wanted.items()
    }
    return {"names of the parts": list(parts), "supports": supports, **groups}


def _position(what: str, of: list[bool]) -> int:
    if True not in of:
        raise ValueError(f"{what} that is not given; add it to the meshes, mesh=[..., ...].")
    return of.index(True)


def _check_dimension(name: str, group: _Group) -> None:
    if group.dimension not in (1, 2):
        raise ValueError(
            f"The group {name!r} has {SIMPLEX[group.dimension]}; a part needs triangles, or edges or intervals."
        )


def _nodes(msh: Mesh) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Input numbers and positions of the nodes of this process."""
    return _dolfinx.input_nodes(msh), np.array(msh.geometry.x, dtype=np.float64)


def _entities(group: _Group, meshes: list[Mesh]) -> _Entities:
    """Entities of a group on this process; cells only where it owns them."""
    msh = meshes[group.mesh]
    topology, dimension = msh.topology, msh.topology.dim
    inputs, table = _dolfinx.input_nodes(msh), _dolfinx.geometry_table(msh.geometry)
    count = topology.index_map(dimension).size_local
    chosen = np.arange(count) if group.tags is None else group.tags.indices[np.isin(group.tags.values, group.values)]
    if group.dimension == dimension:
        chosen, numbers = chosen[chosen < count], _dolfinx.original_cells(msh)
        nodes = inputs[table.reshape(-1, dimension + 1)[chosen]]
        return _Entities(nodes, None if numbers is None else numbers[chosen])
    node = np.empty(len(inputs), dtype=np.int64)  # of each vertex
    node[topology.connectivity(dimension, 0).array] = inputs[table]
    if group.dimension == 0:
        return _Entities(node[chosen][:, None], None)
    vertices = topology.connectivity(group.dimension, 0).array.reshape(-1, group.dimension + 1)
    return _Entities(node[vertices[chosen]], None)


def _merged(shares: list[_Entities]) -> NDArray[np.int64]:
    """Input numbers of the nodes of all entities, in the order of their own numbers if they have any."""
    nodes = np.concatenate([share.nodes for share in shares])
    numbers = [share.numbers for share in shares if share.numbers is not None]
    if len(numbers) == len(shares):
        return np.asarray(nodes[np.argsort(np.concatenate(numbers))])
    return np.unique(np.sort(nodes, axis=1), axis=0)


def _points(
    shares: list[list[tuple[NDArray[np.int64], NDArray[np.float64]]]],
) -> tuple[list[NDArray[np.int64]], NDArray[np.float64], NDArray[np.int64]]:
    """Input numbers of the nodes of each mesh; positions of all, one mesh after the other; first row of each."""
    numbers, points = [], []
    for parts in zip(*shares, strict=True):
        number, first = np.unique(np.concatenate([part[0] for part in parts]), return_index=True)
        numbers.append(number)
        points.append(np.concatenate([part[1] for part in parts])[first])
    first_rows = np.cumsum([0, *map(len, numbers)])
    return numbers, np.concatenate(points), first_rows


def _rows(nodes: NDArray[np.int64], numbers: NDArray[np.int64], first: int) -> NDArray[np.int64]:
    return np.searchsorted(numbers, nodes) + first


def _check_found(name: str, group: _Group, rows: NDArray[np.int64], comm: MPI.Intracomm) -> None:
    """Refuse a group without entities; collective."""
    if len(rows):
        return
    known = [] if group.tags is None else np.unique(np.concatenate(comm.allgather(group.tags.values))).tolist()
    raise ValueError(
        f"The group {name!r} has no {SIMPLEX[group.dimension]} with the tag {group.values.tolist()}; those that the "
        f"tags have are {known}."
    )


def _joined(points: NDArray[np.float64], first: NDArray[np.int64]) -> NDArray[np.int64]:
    """Row of the node that stands for each node: the first of those of other meshes at the same place."""
    rows = np.arange(len(points))
    if len(first) == 2:
        return rows
    mesh = np.repeat(np.arange(len(first) - 1), np.diff(first))
    size = np.ptp(points, axis=0).max()
    pairs = cKDTree(points).query_pairs(COINCIDENT * size, output_type="ndarray")
    pairs = pairs[mesh[pairs[:, 0]] != mesh[pairs[:, 1]]]
    graph = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(points), len(points)))
    _, piece = connected_components(graph, directed=False)
    _, kept, count = np.unique(np.column_stack([piece, mesh]), axis=0, return_index=True, return_counts=True)
    if (count > 1).any():
        where = validation.format_point(points[kept[np.argmax(count > 1)]])
        raise ValueError(f"Two nodes of one mesh and a node of another are all at {where}; join or part those two.")
    _, representative = np.unique(piece, return_index=True)
    return np.asarray(representative[piece])
