"""A flat square of triangles, its rim, and the parts that mesh files name."""

from fx_membrane import Cable, Fabric, Membrane, boundary_edges, rectangle

POINTS, TRIANGLES = rectangle(2.0, 2.0, 3, 3)
RIM = boundary_edges(TRIANGLES)
PARTS = {
    "Dach süd": lambda cells: Membrane(cells, Fabric(4e5, 0.3), 2e3),
    "edge": lambda cells: Cable(cells, 1e6, 1e2),
}
