"""Structures that several tests use: a square sheet, an arch that snaps through, one of all parts; and comparisons."""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

POINTS, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
INCLINED = POINTS + np.array([[0, 0, 0.2 * x * y + 0.1 * x] for x, y, _ in POINTS])
EDGE = np.unique(boundary_edges(TRIANGLES))
CENTRE = 12
FABRIC = Fabric(Et=1e5, nu=0.3)
SNOW = DistributedLoad((0, 0, -200.0), "fabric")
WIND = DistributedLoad((30.0, 0, 250.0), "fabric", range(8))
TOO_MUCH = DistributedLoad((0, 0, -1e8), "fabric")  # in four full Newton steps
LIFT = PrescribedDisplacement(CENTRE, (0.01, 0, 0.1))


def rotation(seed):
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return Q * np.sign(np.linalg.det(Q))


def sheet(*supports, prestress=1e3, points=POINTS, triangles=TRIANGLES):
    """Flat membrane, held along its edge by default."""
    fabric = Membrane(triangles, FABRIC, prestress=prestress)
    return Structure(points, {"fabric": fabric}, supports or [Support(np.unique(boundary_edges(triangles)))])


def inclined_sheet(triangles=TRIANGLES):
    """Sheet in which no two cells are alike."""
    return sheet(points=INCLINED, triangles=triangles)


def flipped(seed):
    """Triangles, some with their nodes in the other sense; the first keeps its own."""
    flip = np.random.default_rng(seed).random(len(TRIANGLES)) < 0.5
    flip[0] = False
    assert 5 < np.count_nonzero(flip) < len(TRIANGLES) - 5
    return np.where(flip[:, None], TRIANGLES[:, ::-1], TRIANGLES)


def arch(supports=(Support([0, 2]), Support(1, "y"))):
    """Two bars that snap through, held in their plane."""
    parts = {"arch": Mast([[0, 1], [1, 2]], 1e6)}
    return Structure([[-1.0, 0, 0], [0, 0, 0.3], [1, 0, 0]], parts, supports)


# The largest load on it: the force EA (h^2 - z^2) / l^2 z / l, twice, at z = h / sqrt(3).
LIMIT = 2 / 3**1.5 * 1e6 * 0.3**3 / 1.09**1.5


# All kinds of parts: two fabrics side by side, an edge cable, a mast under the middle.
FOOT = 9
_points, _triangles = rectangle(2.0, 1.0, 2, 2)
_woven = OrthotropicFabric(Et_warp=1e3, Et_weft=3e3, nu=0.2, Gt=4e2)
MIXED = Structure(
    np.vstack([_points, [[0, 0, -1]]]),
    {
        "fabric": Membrane(_triangles[:4], Fabric(Et=2e3, nu=0.3), prestress=50.0),
        "woven": Membrane(_triangles[4:], _woven, prestress=(40.0, 60.0), warp=(1, 0.5, 0)),
        "edge": Cable([[0, 1], [1, 2]], 5e3, prestress=[70.0, 80.0]),
        "mast": Mast([[FOOT, 4]], 9e3, prestress=-30.0),
    },
    [Support([0, 2], "xyz"), Support(FOOT, "xy")],
)


HEAD = int(np.abs(POINTS - (1, 1, 0)).sum(axis=1).argmin())


def masted_roof(names=("roof", "edge", "mast"), foot="xyz", edge_prestress=1e2, separate=(), **fabric):
    """Held sheet with warp and weft, a cable along its rim and a mast under the node `HEAD`."""
    rim = boundary_edges(TRIANGLES)
    data = {"material": Fabric(4e5, 0.3), "prestress": (2e3, 1e3), "warp": (1, 0, 0)} | fabric
    n = len(POINTS)
    parts = (Membrane(TRIANGLES, **data), Cable(rim, 1e6, edge_prestress), Mast([(HEAD, n)], 1e7))
    return Structure(
        np.vstack([POINTS, (1.0, 1.0, -2.0)]),
        dict(zip(names, parts, strict=True)),
        [Support(np.unique(rim)), Support(n, foot)],
        separate,
    )


def close(a, b):
    return a == pytest.approx(b, abs=1e-9 * np.abs(b).max())


def same_state(a, b):
    return close(a.displacement, b.displacement) and close(a.reactions, b.reactions) and close(a.loads, b.loads)


def end(problem, *loads, start=None):
    """Actions at the end of a stage with these loads."""
    return problem.actions_of(Stage("loads", loads), start)
