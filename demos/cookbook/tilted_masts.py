"""Hypar sail whose two high corners stand on tilted masts with two stays each [kN, m]."""

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis, Cable, Fabric, Mast, Membrane, Pressure, Stage, Structure, Support, masts_and_stays, polyline,
    projected_stress, report, sail_mesh,
)  # fmt: skip

corners = {"south": (0, -7, 1.0), "east": (7, 0, 4.0), "north": (0, 7, 1.0), "west": (-7, 0, 4.0)}
mesh = sail_mesh(corners, 0.8, sag=0.12)
edges = {name: Cable(polyline(line), axial_stiffness=2e4, prestress=28.0) for name, line in mesh.lines.items()}
parts = {"sail": Membrane(mesh.triangles, Fabric(Et=800.0, nu=0.3), prestress=2.5), **edges}
sail = Structure(mesh.points, parts, [Support([mesh.nodes[name] for name in corners])])
form = projected_stress(sail)

n, east, west = len(form.points), mesh.nodes["east"], mesh.nodes["west"]
feet = [(6.2, 0, 0), (-6.2, 0, 0)]
anchors = [(side * 10.0, y, 0) for side in (1, -1) for y in (2.5, -2.5)]
bars = {
    "masts": Mast([[n, east], [n + 1, west]], axial_stiffness=3e5),
    "stays": Cable([[n + 2, east], [n + 3, east], [n + 4, west], [n + 5, west]], axial_stiffness=2e4),
}
guyed = masts_and_stays(form, bars, [*feet, *anchors])
results = Analysis(guyed.structure).run([Stage("form"), Stage("wind", [Pressure(0.5, "sail")], after="form")])
assert results["form"].largest_displacement < 1e-12 * sail.size
if MPI.COMM_WORLD.rank == 0:
    print("Forces in balance [kN]:", {name: np.round(guyed.forces[name], 2).tolist() for name in bars})
    print(report(results["wind"], [east, west], force_unit="kN"))
