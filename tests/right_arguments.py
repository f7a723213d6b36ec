"""Right arguments of every public function and class, and the kind of each."""

import numpy as np
from dolfinx.mesh import create_unit_square
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Axial,
    Cable,
    CableDensity,
    CableForce,
    CableLength,
    CableSag,
    ConjugateGradient,
    DistributedLoad,
    EdgeAngle,
    Fabric,
    Mast,
    Membrane,
    MooneyRivlin,
    NeoHooke,
    Newton,
    OrthotropicFabric,
    ParaViewSeries,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    RadialDirection,
    RigidBody,
    Ring,
    RoundHole,
    Slide,
    Stage,
    SteepestDescent,
    Structure,
    Support,
    WorkLimit,
    boundary_edges,
    edges_where,
    equilibrium_path,
    force_density,
    load_results,
    masts_and_stays,
    natural_force_density,
    natural_frequencies,
    plot,
    polyline,
    prescribed_stress,
    projected_stress,
    read_compas,
    rectangle,
    report,
    save_results,
    stability,
    structure_from_dolfinx,
    structure_from_file,
    structure_from_gmsh,
    tension_direction,
    to_dolfinx,
    updated_reference,
    write_mesh,
    write_paraview,
    write_report,
    write_scene,
    write_tables,
)

POINTS = np.array([[-1.0, 0, 0], [0, 0, 0.3], [1, 0, 0]])
ARCH = Structure(POINTS, {"arch": Mast([[0, 1], [1, 2]], 1e6, mass=1.0)}, [Support([0, 2]), Support(1, "y")])
LOAD = Stage("load", [PointLoad(1, (0, 0, -100.0))])
RESULTS = Analysis(ARCH, comm=MPI.COMM_SELF).run([LOAD])
STATE = RESULTS["load"]
HISTORY = STATE.increments[0].iterations
SQUARE, TRIANGLES = rectangle(1.0, 1.0, 1, 1)
SHEET = Structure(SQUARE, {"sheet": Membrane(TRIANGLES, Fabric(1e5, 0.3), 1e3)}, [Support(range(4))])
FORM = updated_reference(SHEET)
BAR = {"cells": [[0, 1], [1, 2]], "axial_stiffness": 1e6, "prestress": [1.0, 2.0], "mass": 1.0, "material": None}
BARS = {"cells": "rows", "axial_stiffness": "number", "prestress": "array", "mass": "number", "material": "object?"}
MODULUS = {"cells": [[0, 1]], "E": 1e9, "area": 1e-4, "prestress": 0.0, "density": 1.0}
MODULI = {"cells": "rows", "E": "number", "area": "number", "prestress": "array", "density": "number"}
SPREAD = {"load": [0.0, 0.0, 1.0], "part": "sheet", "cells": [0]}, {"load": "array", "part": "text", "cells": "rows?"}
FIRST_ORDER = {"preconditioner": None, "rtol": 1e-3, "max_iterations": 5}
FIRST_ORDERS = {"preconditioner": "object?", "rtol": "number", "max_iterations": "whole"}
UNITS = {"force_unit": "text", "energy_unit": "text"}
UNIT_NAMES = {"force_unit": "N", "length_unit": "m"}
UNIT_KINDS = dict.fromkeys(UNIT_NAMES, "text")
OWN_UNITS = dict.fromkeys(UNIT_NAMES, "text?")  # those of the results, if not given
WRITER = {"results": RESULTS, "folder": "a", **UNIT_NAMES}, {"results": "object", "folder": "path", **OWN_UNITS}
COMM = {"comm": MPI.COMM_SELF}
MESH = create_unit_square(MPI.COMM_SELF, 1, 1)
MODES = {"state": STATE, "count": 1, **COMM}, {"state": "object", "count": "whole", "comm": "object"}

# Correct arguments of each function, and the kind of each argument.
CASES = {
    Fabric: ({"Et": 1e5, "nu": 0.3}, {"Et": "number", "nu": "number"}),
    Fabric.from_modulus: ({"E": 1e9, "nu": 0.3, "thickness": 1e-3}, dict.fromkeys(("E", "nu", "thickness"), "number")),
    OrthotropicFabric: (
        {"Et_warp": 2e5, "Et_weft": 1e5, "nu": 0.2, "Gt": 1e4},
        dict.fromkeys(("Et_warp", "Et_weft", "nu", "Gt"), "number"),
    ),
    NeoHooke: ({"Gt": 1e5}, {"Gt": "number"}),
    NeoHooke.from_modulus: ({"E": 1e6, "thickness": 1e-3}, dict.fromkeys(("E", "thickness"), "number")),
    MooneyRivlin: ({"C10t": 1e5, "C01t": 1e4}, {"C10t": "number", "C01t": "number"}),
    MooneyRivlin.from_moduli: (
        {"C10": 1e6, "C01": 1e5, "thickness": 1e-3}, dict.fromkeys(("C10", "C01", "thickness"), "number"),
    ),
    Axial: ({"axial_stiffness": 1e5}, {"axial_stiffness": "number"}),
    Membrane: (
        {"cells": [[0, 1, 2], [0, 2, 3]], "material": Fabric(1e5, 0.3), "prestress": [1.0, 2.0], "warp": [1.0, 0, 0],
         "compression_stiffness": 1e-3, "mass": 1.0},
        {"cells": "rows", "material": "object", "prestress": "array", "warp": "array?",
         "compression_stiffness": "number", "mass": "number"},
    ),
    Cable: ({**BAR, "compression_stiffness": 1e-3}, {**BARS, "compression_stiffness": "number"}),
    Mast: (BAR, BARS),
    Cable.from_modulus: (MODULUS, MODULI),
    Mast.from_modulus: (MODULUS, MODULI),
    Support: ({"nodes": [0, 1], "components": "z"}, {"nodes": "rows", "components": "object"}),
    PointLoad: ({"nodes": [0, 1], "force": [0.0, 0.0, 1.0]}, {"nodes": "rows", "force": "array"}),
    DistributedLoad: SPREAD,
    PlanLoad: SPREAD,
    Pressure: ({"pressure": 1.0, "part": "a", "cells": [0]}, {"pressure": "number", "part": "text", "cells": "rows?"}),
    PrescribedDisplacement: (
        {"nodes": [0, 1], "displacement": [0.0, 0.0, 1.0], "components": "z"},
        {"nodes": "rows", "displacement": "array", "components": "object"},
    ),
    Stage: (
        {"name": "snow", "loads": (), "displacements": (), "increments": 2, "after": "wind"},
        {"name": "text", "loads": "list", "displacements": "list", "increments": "whole", "after": "text?"},
    ),
    Structure: (
        {"points": POINTS.tolist(), "parts": ARCH.parts, "supports": ARCH.supports, "separate": (), "terms": ()},
        {"points": "array", "parts": "object", "supports": "list", "separate": "list", "terms": "list"},
    ),
    Structure.part: ({"self": ARCH, "name": "arch", "kind": Mast}, {"name": "object", "kind": "object"}),
    Structure.parts_of: ({"self": ARCH, "kind": Mast}, {"kind": "object"}),
    type(STATE).mast: ({"self": STATE, "name": "arch"}, {"name": "object"}),
    type(STATE).cable: ({"self": STATE, "name": "arch"}, {"name": "object"}),
    type(STATE).membrane: ({"self": STATE, "name": "arch"}, {"name": "object"}),
    Newton: (
        {"rtol": 1e-3, "max_iterations": 5, "line_search": False},
        {"rtol": "number", "max_iterations": "whole", "line_search": "truth"},
    ),
    SteepestDescent: (FIRST_ORDER, FIRST_ORDERS),
    ConjugateGradient: ({"beta": "PR", **FIRST_ORDER}, {"beta": "object", **FIRST_ORDERS}),
    WorkLimit: ({"iterations": 5, "seconds": 1.0}, {"iterations": "whole?", "seconds": "number?"}),
    rectangle: (
        {"width": 1.0, "height": 1.0, "columns": 2, "rows": 2, "diagonals": "left"},
        {"width": "number", "height": "number", "columns": "whole", "rows": "whole", "diagonals": "object"},
    ),
    polyline: ({"nodes": [0, 1]}, {"nodes": "rows"}),
    boundary_edges: ({"triangles": TRIANGLES}, {"triangles": "rows"}),
    edges_where: (
        {"points": SQUARE, "triangles": TRIANGLES, "on": lambda x: x[0] > 0},
        {"points": "array", "triangles": "rows", "on": "object"},
    ),
    force_density: (
        {"points": POINTS.tolist(), "branches": [[0, 1], [1, 2]], "q": [1.0, 2.0], "fixed": [Support([0, 2])],
         "loads": None, "constraints": (), "tolerance": 0.1, "max_iterations": 2},
        {"points": "array", "branches": "rows", "q": "array", "fixed": "object", "loads": "array?",
         "constraints": "list", "tolerance": "number", "max_iterations": "whole"},
    ),
    masts_and_stays: (
        {"form": FORM, "bars": {"stay": Cable([[0, 4]], 1e6)}, "points": [[-2.0, 0.0, 0.0]], "heads": [0],
         "components": "x"},
        {"form": "object", "bars": "object", "points": "array", "heads": "rows?", "components": "object"},
    ),
    CableForce: (
        {"part": "edge", "force": 1.0, "cells": [0, 1], "horizontal": True},
        {"part": "text", "force": "number", "cells": "rows?", "horizontal": "truth"},
    ),
    CableDensity: ({"part": "edge", "density": 1.0, "cells": [0, 1]},
                   {"part": "text", "density": "number", "cells": "rows?"}),
    CableLength: ({"part": "edge", "length": 1.0, "cells": [0, 1]},
                  {"part": "text", "length": "number", "cells": "rows?"}),
    CableSag: (
        {"part": "edge", "sag": 1.0, "cells": [0, 1], "along": [0.0, 0, 1]},
        {"part": "text", "sag": "number", "cells": "rows?", "along": "array?"},
    ),
    EdgeAngle: ({"part": "edge", "angle": 30.0, "cells": [0, 1]},
                {"part": "text", "angle": "number", "cells": "rows?"}),
    Slide: ({"nodes": [0, 1], "direction": [0.0, 0, 1], "normal": None},
            {"nodes": "rows", "direction": "array?", "normal": "array?"}),
    Ring: ({"nodes": [0, 1, 2], "radius": 1.0}, {"nodes": "rows", "radius": "number?"}),
    RigidBody: ({"nodes": [0, 1]}, {"nodes": "rows"}),
    natural_force_density: (
        {"structure": SHEET, "loads": (), "iterations": 2, "tolerance": 0.1, "constraints": ()},
        {"structure": "object", "loads": "list", "iterations": "whole", "tolerance": "number", "constraints": "list"},
    ),
    RadialDirection: ({"origin": [0.0, 0.0, 0.0], "axis": [0.0, 0.0, 1.0]}, {"origin": "array", "axis": "array"}),
    prescribed_stress: (
        {"structure": SHEET, "loads": (), "stress": {}, "warp": {}, "tolerance": 0.1, "max_iterations": 2,
         "constraints": ()},
        {"structure": "object", "loads": "list", "stress": "table?", "warp": "table?", "tolerance": "number",
         "max_iterations": "whole", "constraints": "list"},
    ),
    projected_stress: (
        {"structure": SHEET, "loads": (), "stress": {}, "cables": "force", "direction": [0.0, 0.0, 1.0],
         "tolerance": 0.1, "max_iterations": 2, "constraints": ()},
        {"structure": "object", "loads": "list", "stress": "table?", "cables": "object", "direction": "array",
         "tolerance": "number", "max_iterations": "whole", "constraints": "list"},
    ),
    updated_reference: (
        {"structure": SHEET, "loads": (), "tolerance": 0.1, "max_iterations": 2, **COMM, "constraints": ()},
        {"structure": "object", "loads": "list", "tolerance": "number", "max_iterations": "whole",
         "comm": "object", "constraints": "list"},
    ),
    natural_frequencies: MODES,
    stability: MODES,
    equilibrium_path: (
        {"start": ARCH, "stage": LOAD, "load_factor": 1.0, "displacement": None, "max_points": 2, "rtol": 1e-6,
         "limit": WorkLimit(), **COMM},
        {"start": "object", "stage": "object", "load_factor": "number?", "displacement": "object?",
         "max_points": "whole", "rtol": "number", "limit": "object", "comm": "object"},
    ),
    Analysis: (
        {"structure": ARCH, "solver": Newton(), "limit": WorkLimit(), "progress": False, **COMM},
        {"structure": "object", "solver": "object", "limit": "object", "progress": "truth", "comm": "object"},
    ),
    Analysis.run: (
        {"self": Analysis(ARCH, comm=MPI.COMM_SELF), "stages": [LOAD], "checkpoint_file": None, "observe": None},
        {"stages": "list", "checkpoint_file": "path?", "observe": "object?"},
    ),
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
        {"results": RESULTS, "path": "a.html", "title": "Roof", "pictures": False, "scene": None,
         **UNIT_NAMES},
        {"results": "object", "path": "object", "title": "text?", "pictures": "truth", "scene": "object?",
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
