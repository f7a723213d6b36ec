"""Triangles between the segments of plans, by gmsh, as a script: `python -P gmsh_script.py 24`.

It meshes plan-0.npz to plan-23.npz in its folder into mesh-0.npz to mesh-23.npz. It runs in a separate process: models
open in gmsh elsewhere are unchanged. It needs gmsh and numpy only, never MPI, and imports the package by its name.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fx_membrane.runtime.gmsh_process import started_gmsh, without_errors


def _draw(model: Any, plan: Any) -> None:
    """Draw one gmsh curve for each segment, which remains one edge of the mesh."""
    for tag, ((x, y), size) in enumerate(zip(plan["points"].tolist(), plan["sizes"].tolist(), strict=True), 1):
        model.geo.addPoint(x, y, 0.0, size, tag)
    segments = plan["segments"]
    for tag, (a, b) in enumerate((segments + 1).tolist(), 1):
        model.geo.addLine(a, b, tag)
    tags = np.arange(1, len(segments) + 1)
    loops = [model.geo.addCurveLoop(tags[plan["loops"] == loop].tolist()) for loop in range(plan["loops"].max() + 1)]
    model.geo.addPlaneSurface(loops, 1)
    model.geo.synchronize()
    for tag in tags.tolist():
        model.mesh.setTransfiniteCurve(tag, 2)
    within = tags[plan["loops"] < 0].tolist()
    if within:
        model.mesh.embed(1, within, 2, 1)
    on_segments = np.isin(np.arange(len(plan["points"])), segments)
    single = (np.flatnonzero(~on_segments) + 1).tolist()
    if single:
        model.mesh.embed(0, single, 2, 1)


def _set_sizes(gmsh: Any, plan: Any) -> None:
    """Set sizes by a field on triangles, or by the segments around."""
    if len(plan["field_triangles"]):
        corners = plan["field_points"][plan["field_triangles"]]
        flat = np.concatenate([corners, np.zeros((len(corners), 3, 1))], axis=2).transpose(0, 2, 1).reshape(-1, 9)
        values = plan["field_sizes"][plan["field_triangles"]]
        view = gmsh.view.add("size")
        gmsh.view.addListData(view, "ST", len(corners), np.column_stack([flat, values]).ravel())
        field = gmsh.model.mesh.field.add("PostView")  # of the first view
        gmsh.model.mesh.field.setAsBackgroundMesh(field)
        for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary"):
            gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.MeshSizeMax", float(plan["largest"]))


def _mesh(gmsh: Any, source: str) -> tuple[Any, Any, Any]:
    """Mesh the plan of a file; return the tags and coordinates of nodes, and the tags of the nodes of triangles."""
    with np.load(source, allow_pickle=False) as plan:
        _draw(gmsh.model, plan)
        _set_sizes(gmsh, plan)
    gmsh.model.mesh.generate(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    return tags, coordinates, gmsh.model.mesh.getElementsByType(2)[1]


def _main(count: str) -> None:
    for number in range(int(count)):
        gmsh = started_gmsh()  # anew, so that each plan is meshed as if alone
        tags, coordinates, triangles = without_errors(gmsh, partial(_mesh, gmsh, f"plan-{number}.npz"))
        gmsh.finalize()
        order = np.argsort(tags)
        rows = np.searchsorted(tags[order], triangles).reshape(-1, 3)
        part = Path(f"mesh-{number}.part.npz")
        np.savez(part, points=coordinates.reshape(-1, 3)[order, :2], triangles=rows.astype(np.int64))
        part.replace(f"mesh-{number}.npz")  # whole once it is there


if __name__ == "__main__":
    _main(*sys.argv[1:])
