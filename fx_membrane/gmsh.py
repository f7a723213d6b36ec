"""Structures from gmsh: a model in memory or a .msh file, in which physical names say what is what."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import validation
from .parts import Part
from .structure import Structure, Support

KINDS = ("point", "curve", "surface", "volume")  # by dimension
NODES = {1: 2, 2: 3}  # gmsh's element types of lines and triangles, and their numbers of nodes


def structure_from_gmsh(
    source: str | Path | None,
    parts: Mapping[str, Callable[[NDArray[np.int64]], Part]],
    supports: Mapping[str, str] | None = None,
    separate: Sequence[tuple[str, str]] = (),
) -> Structure:
    """Structure of the physical groups of a gmsh mesh.

    Lines of a physical curve on the edge of a physical surface share its nodes: a cable made of them is tied to the
    membrane. Nodes of `points` are those that the parts use, in the order of gmsh's numbers.

    Args:
        source: A file that gmsh can read, or None for the meshed model that is open in this process.
        parts: For each physical name, what makes a part of its cells (lines or triangles, of first order):
            `{"fabric": lambda cells: Membrane(cells, Fabric(Et=500e3, nu=0.3), prestress=1e3)}`.
        supports: For each physical name, the components that its nodes are held in: `{"corners": "xyz"}`. A group may
            be a part and a support: `{"fabric": "z"}` keeps a membrane flat.
        separate: Pairs of names of parts that lie on each other without being joined, see `Structure`.

    Raises:
        ValueError: The file is not a mesh; a physical name does not exist, or more than one group has it, as a curve
            and a surface; its cells are not lines or triangles of first order, or not those of the part to be made of
            them; a support is on no part.
    """
    import gmsh  # noqa: PLC0415  (not needed by structures made of arrays)

    if source is None:
        if not _meshed(gmsh.model):
            raise ValueError("The gmsh model that is open has no mesh; call gmsh.model.mesh.generate(2) before.")
        return _structure(gmsh.model, parts, supports or {}, separate)
    if not Path(source).is_file():
        raise ValueError(f"There is no file {source}; give the name of a gmsh mesh.")
    before = _current_model(gmsh)
    if before is None:
        gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        gmsh.model.add("fx_membrane")
        try:
            gmsh.merge(str(source))
        except Exception as error:  # gmsh raises nothing more precise
            raise ValueError(f"{source} is not a file that gmsh can read ({error}).") from None
        if not _meshed(gmsh.model):
            raise ValueError(
                f"{source} has no mesh that gmsh can read; give a .msh file, which `gmsh -2` makes of a geometry and "
                "gmsh.write of a meshed model."
            )
        return _structure(gmsh.model, parts, supports or {}, separate)
    finally:
        gmsh.model.remove()
        if before is None:
            gmsh.finalize()
        else:
            gmsh.model.setCurrent(before)


def _current_model(gmsh: Any) -> str | None:
    """Name of the model that is open; None where gmsh has not been started (gmsh 4.8 cannot be asked that)."""
    try:
        return str(gmsh.model.getCurrent())
    except Exception:
        return None


def _meshed(model: Any) -> bool:
    return len(model.mesh.getNodes()[0]) > 0


def _structure(
    model: Any,
    parts: Mapping[str, Callable[[NDArray[np.int64]], Part]],
    supports: Mapping[str, str],
    separate: Sequence[tuple[str, str]],
) -> Structure:
    tags, coordinates, _ = model.mesh.getNodes()
    groups = _groups(model, [*parts, *supports])
    cells = {name: _cells(model, name, groups[name]) for name in parts}
    used = np.unique(np.concatenate([part.ravel() for part in cells.values()]))
    row = np.full(int(tags.max()) + 1, -1, dtype=np.int64)
    row[used] = np.arange(len(used))
    position = np.empty((int(tags.max()) + 1, 3))
    position[tags.astype(np.int64)] = coordinates.reshape(-1, 3)
    held = []
    for name, components in supports.items():
        nodes = model.mesh.getNodesForPhysicalGroup(*groups[name])[0].astype(np.int64)
        if not len(nodes):
            raise ValueError(f"The support {name!r} has no nodes; mesh the physical group, with the parts it holds.")
        loose = nodes[row[nodes] < 0]
        if len(loose):
            raise ValueError(
                f"The support {name!r} has nodes that no part uses, {len(loose)} of {len(nodes)}, as gmsh's node "
                f"{loose[0]} at {validation.place(position[loose[0]])}; put it on a part."
            )
        held.append(Support(np.unique(row[nodes]), components))
    made = {name: _part(name, make, row[cells[name]]) for name, make in parts.items()}
    return Structure(position[used], made, held, separate)


def _part(name: str, make: Callable[[NDArray[np.int64]], Part], cells: NDArray[np.int64]) -> Part:
    """The part that a function makes of cells; what it refuses is told with the physical name."""
    try:
        return make(cells)
    except ValueError as error:
        what = "triangles, for a Membrane" if cells.shape[1] == 3 else "segments, for a Cable or a Mast"
        raise ValueError(f"The physical group {name!r} has {what}; they make no part: {error}") from error


def _groups(model: Any, wanted: Sequence[str]) -> dict[str, tuple[int, int]]:
    """Dimension and tag of the physical groups of some names, each of which must mean one group."""
    named: dict[str, list[tuple[int, int]]] = {}
    for group in model.getPhysicalGroups():
        named.setdefault(model.getPhysicalName(*group), []).append(group)
    for name in wanted:
        if name not in named:
            raise ValueError(f"The mesh has no physical group {name!r}; it has {sorted(named)}.")
        if len(named[name]) > 1:
            what = " and ".join(f"a {KINDS[dimension]} (tag {tag})" for dimension, tag in named[name])
            raise ValueError(
                f"The mesh has {len(named[name])} physical groups {name!r}, {what}; give each its own name."
            )
    return {name: named[name][0] for name in wanted}


def _cells(model: Any, name: str, group: tuple[int, int]) -> NDArray[np.int64]:
    """Node tags of the cells of a physical group, shape (cells, 2 or 3)."""
    dimension, _ = group
    found = []
    for entity in model.getEntitiesForPhysicalGroup(*group):
        for kind, _, nodes in zip(*model.mesh.getElements(dimension, entity), strict=True):
            if kind not in NODES:
                what = model.mesh.getElementProperties(kind)[0]
                raise ValueError(f"The physical group {name!r} has elements of type {what}; give lines or triangles.")
            found.append(np.asarray(nodes, dtype=np.int64).reshape(-1, NODES[kind]))
    if not found:
        raise ValueError(f"The physical group {name!r} has no cells; mesh it before it is made a structure.")
    return np.concatenate(found)
