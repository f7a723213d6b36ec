"""DXF by ezdxf: faces, lines and points by layer."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from .drawing import Drawing

UNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m", 7: "km", 10: "yd", 14: "dm"}  # $INSUNITS
IMPERIAL = ("in", "ft", "yd")
BY_BLOCK = "0"  # layer of entities in a block that are on the layer of its INSERT


def read(file: Path) -> Drawing:
    """Read 3DFACE, MESH and polyface entities as faces, LINE and POLYLINE as lines, POINT as points, blocks included.

    An entity on layer 0 in a block is on the layer of the INSERT, as DXF has it. So it is in nested blocks. Curved
    entities (ARC, SPLINE, a bulge of a polyline) and faces with more than four corners are left out: their layer is
    refused where it is asked for.

    Raises:
        ValueError: It is no DXF file.
        ImportError: ezdxf is not installed.
    """
    try:
        import ezdxf  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError("DXF files need the package ezdxf; install it by pip install 'fx-membrane[dxf]'.") from None
    try:
        document = ezdxf.readfile(file)
    except Exception as error:  # damaged files fail anywhere in ezdxf
        raise ValueError(f"{file} is no DXF file that can be read ({error or type(error).__name__}).") from None
    points: list[Any] = []
    cells: dict[tuple[str, int], list[list[int]]] = {}
    refused: dict[str, str] = {}
    left_out: dict[str, int] = {}
    for entity, layer in _entities(document.modelspace(), BY_BLOCK, ()):
        try:
            found_corners = list(_cells(f"{file}: layer {layer!r} has ", entity))
        except ValueError as error:
            refused.setdefault(layer, str(error))
            continue
        if not found_corners:
            left_out[entity.dxftype()] = left_out.get(entity.dxftype(), 0) + 1
        for corners in found_corners:
            rows = list(range(len(points), len(points) + len(corners)))
            points += corners
            cells.setdefault((layer, len(rows)), []).append(rows)
    drawing = Drawing(str(file), "layer", np.array([tuple(point) for point in points], dtype=np.float64).reshape(-1, 3))
    for (layer, count), found in cells.items():
        drawing.add(layer, np.array(found, dtype=np.int64).reshape(-1, count))
    drawing.loose, drawing.refused, drawing.left_out = True, refused, left_out
    drawing.unit = UNITS.get(int(document.header.get("$INSUNITS", 0)), "")
    return drawing


def _entities(entities: Iterable[Any], layer: str, blocks: tuple[str, ...]) -> Iterator[tuple[Any, str]]:
    """Entities with their layers, those of blocks in their places.

    Args:
        entities: Those of the drawing, or of one INSERT of a block.
        layer: Layer of what is on layer 0.
        blocks: Names of the blocks around them; a block within itself is left out.
    """
    from ezdxf import disassemble  # noqa: PLC0415

    for entity in entities:
        own = layer if entity.dxf.layer == BY_BLOCK else entity.dxf.layer
        if entity.dxftype() != "INSERT":
            yield from ((piece, own) for piece in disassemble.recursive_decompose([entity]))
        elif entity.dxf.name not in blocks:
            for insert in entity.multi_insert() if entity.mcount > 1 else [entity]:
                yield from _entities(insert.virtual_entities(), own, (*blocks, entity.dxf.name))


def _cells(where: str, entity: Any) -> Iterator[list[Any]]:
    """Corners of the cells of an entity."""
    kind = entity.dxftype()
    if kind == "POINT":
        yield [entity.dxf.location]
    elif kind == "LINE":
        yield [entity.dxf.start, entity.dxf.end]
    elif kind == "3DFACE":
        yield _face(where, entity.wcs_vertices())
    elif kind == "MESH":
        from ezdxf.math import Vec3  # noqa: PLC0415

        for face in entity.faces:
            yield _face(where, Vec3.list(entity.vertices[row] for row in face))
    elif kind == "POLYLINE" and entity.is_poly_face_mesh:
        for polygon in entity.faces():
            yield _face(where, [vertex.dxf.location for vertex in polygon if vertex.is_poly_face_mesh_vertex])
    elif kind == "POLYLINE" and entity.is_polygon_mesh:
        yield from _grid(entity)
    elif kind in ("POLYLINE", "LWPOLYLINE"):
        yield from _chain(where, entity)
    elif kind in ("ARC", "CIRCLE", "ELLIPSE", "SPLINE"):
        raise ValueError(f"{where}a curve ({kind}); draw it as a polyline whose segments are the cells.")


def _face(where: str, corners: list[Any]) -> list[Any]:
    """Corners of a face, each once: 3DFACE repeats the last one of a triangle."""
    distinct = [corner for row, corner in enumerate(corners) if row == 0 or not corner.isclose(corners[row - 1])]
    if len(distinct) > 1 and distinct[0].isclose(distinct[-1]):
        distinct.pop()
    if len(distinct) not in (3, 4):
        raise ValueError(f"{where}a face with {len(distinct)} corners at {tuple(corners[0])}; give triangles or four.")
    return distinct


def _grid(entity: Any) -> Iterator[list[Any]]:
    """Quadrilaterals of a polygon mesh of m by n vertices."""
    net = entity.get_mesh_vertex_cache()
    columns = (entity.dxf.m_count, entity.dxf.n_count)
    for i in range(columns[0] - 1 + entity.is_m_closed):
        for j in range(columns[1] - 1 + entity.is_n_closed):
            up, right = (i + 1) % columns[0], (j + 1) % columns[1]
            yield [net[i, j], net[up, j], net[up, right], net[i, right]]


def _chain(where: str, entity: Any) -> Iterator[list[Any]]:
    if entity.has_arc:
        raise ValueError(f"{where}a polyline with arcs; draw it with straight segments, which are the cells.")
    corners = list(entity.vertices_in_wcs() if entity.dxftype() == "LWPOLYLINE" else entity.points_in_wcs())
    if entity.is_closed and len(corners) > 2:
        corners.append(corners[0])
    yield from (list(pair) for pair in pairwise(corners))
