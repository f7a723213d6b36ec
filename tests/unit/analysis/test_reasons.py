"""Reasons that a stage gives where it ends: the cause comes first, and no advice contradicts it."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PointLoad,
    Stage,
    Structure,
    Support,
    boundary_edges,
    polyline,
    rectangle,
    updated_reference,
)

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")


def reason(structure, stages, solver=Newton()):
    """Return the message, after the load factors."""
    with pytest.raises(ConvergenceError) as error:
        Analysis(structure, solver).run(stages)
    return str(error.value).split("): ", 1)[1]


def test_mast_whose_guys_are_slack_bears_no_load():
    """The third guy is missing, the prestress of the others goes; forces are in kN."""
    points = [[0, 0, 0], [0, 0, 4.0], [3, 0, 0], [-1.5, 2.598, 0]]
    guys = Cable([[1, 2], [1, 3]], 12e3, prestress=1.0)
    structure = Structure(points, {"mast": Mast([[0, 1]], 2e5), "guys": guys}, [Support([0, 2, 3])])
    down = PointLoad(1, (0, 0, -0.5))
    words = reason(structure, [Stage("rest"), Stage("down", [down], after="rest")])
    for fact in ("mechanism", "slack parts", "node 1", "mast 'mast' (cell 0)", "'guys': no load is safe", "Add cables"):
        assert fact in words
    assert "largest load" not in words
    assert "give it prestress" not in words  # they were given it


def test_pole_that_falls_beside_a_roof_is_named_first():
    points, triangles = rectangle(8, 6, 4, 4)
    points = np.column_stack([points[:, :2], points[:, 0] * points[:, 1] / 12])
    n, edge = len(points), np.unique(boundary_edges(triangles))
    parts = {
        "roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3),
        "valley": Cable(polyline(10 + np.arange(5)), 1e7, prestress=2e4),
        "pole": Mast([[n, n + 1]], 2e8),
        "guys": Cable([[n + 1, n + 2], [n + 1, n + 3]], 1e6),
    }
    points = np.vstack([points, [[15, 0, 0], [15, 0, 4.0], [18, 0, 0], [13.5, 2.598, 0]]])
    structure = Structure(points, parts, [Support([*edge, n, n + 2, n + 3])])
    loads = [DistributedLoad((0, 0, -600), "roof"), PointLoad(n + 1, (6, 10.0, -10))]
    words = reason(structure, [Stage("snow", loads)], Newton(max_iterations=40))
    assert words.startswith(f"mast 'pole' (cell 0, at node {n + 1}) has turned by")
    assert "has all its stays" in words
    assert "'guys' is slack in 2 of 2 cells" in words
    assert "largest load" not in words
    assert "more increments" not in words


def test_mast_without_one_of_its_stays_is_named_first():
    """A sail on two masts, and prestress alone."""
    points, triangles = rectangle(10.0, 10.0, 24, 24)
    x, y = points[:, 0], points[:, 1]
    points = np.column_stack([(x - y) / 2**0.5, (x + y) / 2**0.5, 0 * x])
    d, n = 10 / 2**0.5, len(points)
    points[:, 2] = 2.5 + 1.5 * (points[:, 0] ** 2 - points[:, 1] ** 2) / d**2
    W, E, S, N = map(int, (points[:, 0].argmin(), points[:, 0].argmax(), points[:, 1].argmin(), points[:, 1].argmax()))
    sail = {
        "fabric": Membrane(triangles, Fabric(800.0, 0.2), prestress=2.5),
        "edges": Cable(boundary_edges(triangles), 2e4, prestress=25.0),
    }
    shape = updated_reference(Structure(points, sail, [Support([W, E, S, N])])).structure
    feet = [[-d + 0.8, 0, 0], [d - 0.8, 0, 0], [-d - 3, -2.5, 0], [d + 3, 2.5, 0], [d + 3, -2.5, 0]]
    masts = Mast([[n, W], [n + 1, E]], 3e5, prestress=-62.0)
    stays = Cable([[n + 2, W], [n + 3, E], [n + 4, E]], 2e4, prestress=32.0)
    structure = Structure(
        np.vstack([shape.points, feet]),
        {**shape.parts, "masts": masts, "stays": stays},
        [Support([S, N, *range(n, n + 5)])],
    )
    words = reason(structure, [Stage("prestress")], Newton(max_iterations=60))
    assert words.startswith(f"mast 'masts' (cell 0, at node {W}) has turned by")
    assert "has all its stays" in words
    assert "give it prestress" not in words
