"""Resident memory left behind by repeated work [MB], one line for each kind of work; it ends below a bound.

mpirun -n 2 python tests/memory_use.py BOUND
"""

import os
import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Membrane,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    equilibrium_path,
    rectangle,
    stability,
    updated_reference,
)

if "Open MPI" in MPI.Get_library_version():
    # Waiting processes yield their core: on one core to each other, on two to what else runs there, for a full slice.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

points, triangles = rectangle(10.0, 10.0, 24, 24)
rim = np.unique(boundary_edges(triangles))


def sheet(prestress):
    return Structure(points, {"fabric": Membrane(triangles, Fabric(5e5, 0.3), prestress=prestress)}, [Support(rim)])


SNOW = [Stage(f"snow {i}", [DistributedLoad((0, 0, -50.0 * (1 + i % 3)), "fabric")]) for i in range(6)]
AIR = Stage("air", [Pressure(100.0, "fabric")], increments=4)
taut, flat = Analysis(sheet(1e3)), Analysis(sheet(0.0))
state = taut.run(SNOW[:1])["snow 0"]


def conjugate_gradients(preconditioner):
    try:
        Analysis(sheet(1e3), ConjugateGradient(preconditioner=preconditioner, max_iterations=25)).run(SNOW[:1])
    except ConvergenceError:
        return
    raise AssertionError("so few iterations are not to suffice")


WORK = {
    "iterations of conjugate gradients": lambda: conjugate_gradients(None),
    "preconditioned ones": lambda: conjugate_gradients("tangent"),
    "stages": lambda: taut.run(SNOW),
    "stages with pressure": lambda: [taut.run([AIR]) for _ in range(2)],
    "stages that are stabilized or shifted": lambda: flat.run(SNOW[:4]),
    "analyses": lambda: [Analysis(sheet(1e3)).run(SNOW[:1]) for _ in range(6)],
    "stability": lambda: [stability(state, count=2) for _ in range(5)],
    "paths": lambda: equilibrium_path(sheet(1e3), Stage("path", SNOW[2].loads, increments=3)),
    "forms": lambda: [updated_reference(sheet(1e3)) for _ in range(12)],
}


def resident():
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def growth(act):
    """Largest growth of a process."""
    before = resident()
    act()
    return MPI.COMM_WORLD.allreduce(resident() - before, MPI.MAX)


def least_growth(act, bound):
    """Work that leaves memory behind does so at each of five repetitions, noise does not: one below the bound ends."""
    grown = []
    while len(grown) < 5 and min(grown, default=bound) >= bound:
        grown.append(growth(act))
    return min(grown)


for name, act in WORK.items():
    act()  # objects made once
    grown = least_growth(act, bound=float(sys.argv[1]))
    if MPI.COMM_WORLD.rank == 0:
        print(f"{name}: {grown:.2f} MB", flush=True)
