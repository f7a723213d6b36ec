"""Cone over a square: a sail meshed in plan, its shape from stress in plan, then snow and uplift [kN, m]."""

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis, Cable, Fabric, Membrane, PlanLoad, Pressure, RoundHole, Stage, Structure, Support, polyline,
    projected_stress, report, sail_mesh,
)  # fmt: skip

half, sag, stress = 6.0, 0.1, 2.0
radius = half / np.sin(2 * np.arctan(2 * sag))  # of the arcs of the edges, whose cables take stress times radius
corners = {name: (half * x, half * y, 0.0) for name, x, y in (("A", -1, -1), ("B", 1, -1), ("C", 1, 1), ("D", -1, 1))}
mesh = sail_mesh(corners, 0.7, sag=sag, holes={"ring": RoundHole((0, 0, 4.0), 0.8)})
edges = {name: Cable(polyline(line), 1.2e4, stress * radius) for name, line in mesh.lines.items() if name != "ring"}
parts = {"roof": Membrane(mesh.triangles, Fabric(Et=600.0, nu=0.3), stress), **edges}
held = [Support([mesh.nodes[name] for name in corners]), Support(np.unique(mesh.lines["ring"]))]
form = projected_stress(Structure(mesh.points, parts, held))

up = np.sign(form.structure.normals("roof")[0, 2])
stages = [
    Stage("form"),
    Stage("snow", [PlanLoad((0, 0, -0.6), "roof")], increments=2, after="form"),
    Stage("uplift", [Pressure(0.5 * up, "roof")], increments=2, after="form"),
]
results = Analysis(form.structure).run(stages)
assert results["form"].largest_displacement < 1e-12 * form.structure.size
if MPI.COMM_WORLD.rank == 0:
    principal = results["form"].membrane("roof").principal
    print(f"Stress in space: {principal.min():.2f} to {principal.max():.2f} kN/m; {stress} kN/m in plan")
    for name in ("snow", "uplift"):
        print(report(results[name], force_unit="kN"))
