"""Restart: a run out of time leaves its states in a checkpoint, and the next one goes on from there [kN, m]."""

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis, ConvergenceError, DistributedLoad, Fabric, Membrane, Stage, Structure, Support, WorkLimit, boundary_edges,
    rectangle,
)  # fmt: skip

say = print if MPI.COMM_WORLD.rank == 0 else (lambda *_: None)
points, triangles = rectangle(6.0, 6.0, 20, 20)
held = Support(np.unique(boundary_edges(triangles)))
structure = Structure(points, {"film": Membrane(triangles, Fabric(Et=600.0, nu=0.3), prestress=3.0)}, [held])
stages = [
    Stage("prestress"),
    Stage("snow", [DistributedLoad((0, 0, -0.6), "film")], increments=4, after="prestress"),
    Stage("more snow", [DistributedLoad((0, 0, -0.6), "film")], increments=4, after="snow"),
]
short = Analysis(structure, limit=WorkLimit(iterations=14))
try:
    short.run(stages, checkpoint_file="restart.checkpoint")
except ConvergenceError as stop:
    say(f"Stopped in {stop}\nKept: {list(stop.results)}")
results = Analysis(structure).run(stages, checkpoint_file="restart.checkpoint")  # as a script that starts again
direct = Analysis(structure).run(stages)
for name in results:
    difference = np.abs(results[name].displacement - direct[name].displacement).max()
    assert difference <= 1e-9 * direct["more snow"].largest_displacement
    say(f"{name}: {results[name].largest_displacement:.4f} m, {len(results[name].history)} iterations in all")
