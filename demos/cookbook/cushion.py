"""Cushion of two foils under inner pressure, then snow on the upper one [kN, m]."""

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis, DistributedLoad, Fabric, Membrane, Pressure, Stage, Structure, Support, boundary_edges, rectangle, report,
)  # fmt: skip

flat, triangles = rectangle(4.0, 3.0, 20, 15)
edge = np.unique(boundary_edges(triangles))
inner = np.setdiff1d(np.arange(len(flat)), edge)
lower = np.arange(len(flat))  # the foils share the nodes of their edge
lower[inner] = len(flat) + np.arange(len(inner))
points = np.concatenate([flat, flat[inner]])
foil = Fabric(Et=180.0, nu=0.4)  # ETFE of 0.2 mm
parts = {"upper": Membrane(triangles, foil, 0.5), "lower": Membrane(lower[triangles], foil, 0.5)}
cushion = Structure(points, parts, [Support(edge)], separate=[("upper", "lower")])
up = np.sign(cushion.normals("upper")[0, 2]), np.sign(cushion.normals("lower")[0, 2])
air = [Pressure(0.4 * up[0], "upper"), Pressure(-0.4 * up[1], "lower")]
snow = [DistributedLoad((0, 0, -0.25), "upper")]
results = Analysis(cushion).run([Stage("air", air, increments=2), Stage("snow", snow, increments=2, after="air")])
rise = {name: state.displacement[:, 2].max() for name, state in results.items()}
assert rise["air"] > rise["snow"] > 0
assert np.isclose(results["air"].displacement[:, 2].min(), -rise["air"])  # both foils bulge alike
if MPI.COMM_WORLD.rank == 0:
    print("Rise of the upper foil [m]:", {name: round(float(value), 4) for name, value in rise.items()})
    print(report(results["snow"], force_unit="kN"))
