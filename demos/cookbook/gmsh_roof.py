"""Roof from gmsh: groups of the mesh become parts and supports; then its soap-film form, and snow [kN, m]."""

import gmsh
from mpi4py import MPI

from fx_membrane import (
    Analysis, Cable, Fabric, Membrane, PlanLoad, Stage, report, structure_from_file, updated_reference,
)  # fmt: skip

if MPI.COMM_WORLD.rank == 0:  # the first process draws; all read
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geometry = gmsh.model.geo
    corners = [geometry.addPoint(*place, 0.6) for place in ((0, 0, 0), (8, 0, 3), (8, 6, 0), (0, 6, 3))]
    sides = [geometry.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
    surface = geometry.addSurfaceFilling([geometry.addCurveLoop(sides)])
    geometry.synchronize()
    for name, dimension, tags in (("roof", 2, [surface]), ("edges", 1, sides), ("corners", 0, corners)):
        gmsh.model.setPhysicalName(dimension, gmsh.model.addPhysicalGroup(dimension, tags), name)
    gmsh.model.mesh.generate(2)
    gmsh.write("roof.msh")
    gmsh.finalize()
MPI.COMM_WORLD.barrier()

fabric = Fabric(Et=600.0, nu=0.3)
structure = structure_from_file(
    "roof.msh",
    {
        "roof": lambda cells: Membrane(cells, fabric, prestress=2.0),
        "edges": lambda cells: Cable(cells, axial_stiffness=1.2e4, prestress=20.0),
    },
    supports={"corners": "xyz"},
)
form = updated_reference(structure)
stages = [Stage("form"), Stage("snow", [PlanLoad((0, 0, -0.6), "roof")], increments=2, after="form")]
results = Analysis(form.structure).run(stages)
assert results["form"].largest_displacement < 1e-12 * structure.size
if MPI.COMM_WORLD.rank == 0:
    print(report(results["snow"], force_unit="kN"))
