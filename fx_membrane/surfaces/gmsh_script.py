"""Triangles between the segments of a plan, by gmsh, as a script: `python -P gmsh_script.py plan.npz mesh.npz`.

It runs in a separate process: models open in gmsh elsewhere are unchanged. It needs gmsh and numpy only, never MPI.
"""

import sys
from typing import Any

import numpy as np

NO_GMSH, NOT_MESHED = 3, 4  # exit codes


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
    """Take sizes from a field on triangles, or from the segments around."""
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


def _main(source: str, target: str) -> None:
    try:
        import gmsh  # noqa: PLC0415  (its absence has an exit code)

        gmsh.initialize(readConfigFiles=False)
    except Exception as error:
        print(error, file=sys.stderr)
        sys.exit(NO_GMSH)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.logger.start()
    failure = ""
    try:
        with np.load(source, allow_pickle=False) as plan:
            _draw(gmsh.model, plan)
            _set_sizes(gmsh, plan)
        gmsh.model.mesh.generate(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        triangles = gmsh.model.mesh.getElementsByType(2)[1]
    except Exception as error:  # gmsh raises nothing more precise
        failure = str(error) or type(error).__name__
    errors = [line.removeprefix("Error: ") for line in gmsh.logger.get() if line.startswith("Error")]
    if failure or errors:
        print((errors or [failure])[0], file=sys.stderr)
        sys.exit(NOT_MESHED)
    order = np.argsort(tags)
    rows = np.searchsorted(tags[order], triangles).reshape(-1, 3)
    np.savez(target, points=coordinates.reshape(-1, 3)[order, :2], triangles=rows.astype(np.int64))


if __name__ == "__main__":
    _main(*sys.argv[1:])
