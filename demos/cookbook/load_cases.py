"""Load cases from one prestressed state, and their tables as CSV [kN, m]."""

import csv
from pathlib import Path

from mpi4py import MPI

from fx_membrane import (
    Analysis, DistributedLoad, Fabric, Membrane, PlanLoad, Pressure, Stage, Structure, Support, boundary_edges,
    rectangle, updated_reference, write_tables,
)  # fmt: skip

points, triangles = rectangle(6.0, 6.0, 18, 18)
points[:, 2] = points[:, 0] * points[:, 1] / 9.0
film = Membrane(triangles, Fabric(Et=600.0, nu=0.3), prestress=2.0)
form = updated_reference(Structure(points, {"film": film}, [Support(sorted({*boundary_edges(triangles).ravel()}))]))
stages = [
    Stage("form"),
    Stage("snow", [PlanLoad((0, 0, -0.6), "film")], increments=2, after="form"),
    Stage("uplift", [Pressure(0.5, "film")], increments=2, after="form"),
    Stage("weight", [DistributedLoad((0, 0, -0.01), "film")], increments=2, after="form"),
]
results = Analysis(form.structure).run(stages)
write_tables(results, "load_cases", force_unit="kN")
if MPI.COMM_WORLD.rank == 0:
    for file in sorted(Path("load_cases").glob("*.csv")):
        with open(file, newline="", encoding="utf-8-sig") as text:
            head, *rows = csv.reader(text)
        print(f"{file}: {len(rows)} rows of {', '.join(head)}")
assert len(results) == 4
