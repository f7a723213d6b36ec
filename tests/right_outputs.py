"""Right arguments of readers, writers and pictures, and the kind of each."""

import numpy as np

from fx_membrane import (
    Fabric,
    Membrane,
    ParaViewSeries,
    RoundHole,
    load_results,
    plot,
    read_compas,
    report,
    save_results,
    structure_from_dolfinx,
    structure_from_file,
    structure_from_gmsh,
    tension_direction,
    to_dolfinx,
    write_mesh,
    write_paraview,
    write_report,
    write_scene,
    write_tables,
)
from right_subjects import (
    ARCH,
    COMM,
    HISTORY,
    MESH,
    OWN_UNITS,
    POINTS,
    RESULTS,
    STATE,
    UNIT_KINDS,
    UNIT_NAMES,
    UNITS,
    WRITER,
)

OUTPUTS = {
    report: (
        {"result": STATE, "nodes": [0], "first": 1, "force_unit": "N", "length_unit": "m"},
        {"result": "object", "nodes": "list of rows", "first": "whole", "force_unit": "text", "length_unit": "text"},
    ),
    structure_from_gmsh: (
        {"source": "no such.msh", "parts": {"a": len}, "supports": {}, "separate": ()},
        {"source": "object", "parts": "object", "supports": "table?", "separate": "list"},
    ),
    structure_from_dolfinx: (
        {"mesh": MESH, "groups": {"a": MESH}, "parts": {"a": lambda cells: Membrane(cells, Fabric(1e5, 0.3))},
         "supports": {}, "separate": ()},
        {"mesh": "object", "groups": "object", "parts": "object", "supports": "table?", "separate": "list"},
    ),
    structure_from_file: (
        {"source": "roof.obj", "parts": {"default": lambda cells: Membrane(cells, Fabric(1e5, 0.3))},
         "supports": {}, "separate": (), "weld": 1e-3,
         "split_quadrilaterals": True, "unit": "m"},
        {"source": "object", "parts": "object", "supports": "table?", "separate": "list", "weld": "number?",
         "split_quadrilaterals": "truth", "unit": "object?"},
    ),
    read_compas: ({"source": "net.json"}, {"source": "path"}),
    write_mesh: (
        {"shape": ARCH, "path": "a.msh", "length_unit": "m"},
        {"shape": "object", "path": "object", "length_unit": "text?"},
    ),
    save_results: ({"results": RESULTS, "path": "a"}, {"results": "object", "path": "path"}),
    load_results: ({"path": "results", "classes": ()}, {"path": "path", "classes": "list"}),
    write_tables: WRITER,
    write_paraview: WRITER,
    write_report: (
        {"results": RESULTS, "path": "a.html", "title": "Roof", "pictures": False, "scene": None, "patterns": None,
         **UNIT_NAMES},
        {"results": "object", "path": "object", "title": "text?", "pictures": "truth", "scene": "object?",
         "patterns": "object?",
         **OWN_UNITS},
    ),
    write_scene: (
        {"results": RESULTS, "path": "a.html", "title": "Roof", **UNIT_NAMES},
        {"results": "object", "path": "object", "title": "text?", **OWN_UNITS},
    ),
    ParaViewSeries: (
        {"folder": "a", "append": False, **UNIT_NAMES}, {"folder": "path", "append": "truth", **UNIT_KINDS}
    ),
    type(STATE).to_dataframe: ({"self": STATE, "part": None, **UNIT_NAMES}, {"part": "object?", **UNIT_KINDS}),
    RoundHole: ({"centre": [0.0, 0.0], "radius": 1.0}, {"centre": "array", "radius": "number"}),
    to_dolfinx: ({"state": STATE, "part": "arch", **COMM}, {"state": "object", "part": "object", "comm": "object"}),
    tension_direction: (
        {"strain": np.eye(2)[None].tolist(), "Et_warp": [2e5], "Et_weft": [1e5], "nu": [0.2], "Gt": [1e4]},
        dict.fromkeys(("strain", "Et_warp", "Et_weft", "nu", "Gt"), "array"),
    ),
    plot.convergence: ({"result": STATE, "path": "a", "force_unit": "N", "energy_unit": "J"},
                       {"result": "object", "path": "path", **UNITS}),
    plot.compare_convergence: (
        {"histories": {"one": HISTORY}, "seconds": {"one": 1.0}, "path": "a", "force_unit": "N", "energy_unit": "J"},
        {"histories": "object", "seconds": "object", "path": "path", **UNITS},
    ),
    plot.wireframe: (
        {"points": POINTS, "parts": ARCH.parts, "path": "a", "view": None, "labels": [], "first": 0},
        {"points": "array", "parts": "object", "path": "path", "view": "array?", "labels": "list of rows",
         "first": "whole"},
    ),
    plot.contours: (
        {"result": STATE, "fields": {"height": POINTS[:, 2]}, "path": "a", "scale": 1.0, "view": [0.0, -1.0, 0.5],
         "mirror": None, "antisymmetric": (), "ranges": None, "smoothed": (), "lines": (), "spacing": None,
         "forces": False, "axes": False, **UNIT_NAMES},
        {"result": "object", "fields": "object", "path": "path", "scale": "number", "view": "array",
         "mirror": "object?", "antisymmetric": "list", "ranges": "table?", "smoothed": "list", "lines": "list",
         "spacing": "number?", "forces": "truth", "axes": "truth", **UNIT_KINDS},
    ),
}  # fmt: skip
