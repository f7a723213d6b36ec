"""Forms are compiled once: not again by another structure of the same parts, a stage or another process."""

COMPILED = """
from fx_membrane import *

def analyse(n):
    points, triangles = rectangle(1.0, 1.0, n, n)
    edges, half = boundary_edges(triangles), len(triangles) // 2
    woven = OrthotropicFabric(Et_warp=1e5 * n, Et_weft=8e4, nu=0.3, Gt=2e4)
    parts = {
        f"fabric {n}": Membrane(triangles[:half], Fabric(Et=1e5 * n, nu=0.3), prestress=1e3 * n),
        f"woven {n}": Membrane(triangles[half:], woven, prestress=1e3 * n, warp=(1.0, n, 0)),
        f"cable {n}": Cable(edges, 1e6 * n, 1e3),
    }
    supports = [Support(edges[edges[:, 0] > 0, 0])]
    analysis = Analysis(Structure(points, parts, supports))
    count()
    snow = Stage("snow", [DistributedLoad((0, 0, -n), f"fabric {n}")], [PrescribedDisplacement(0, (0, 0, 0.1))])
    ice = [DistributedLoad((0, 0, -n), f"cable {n}"), PointLoad(0, (0, 0, n))]
    analysis.run([snow, Stage("ice", ice, after="snow")])
    count()

for n in (2, 3, 4):
    analyse(n)
"""


def test_nothing_is_compiled_twice(compiled_code):
    counts = compiled_code(COMPILED)  # nor by another process
    assert counts[0] > 0
    assert counts == [counts[0]] * 6  # not by another structure of the same kind, nor by a stage
