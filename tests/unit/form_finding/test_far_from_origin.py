"""Forms with a tilted plan, far from the origin: at rest, though their places are rounded there."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Membrane,
    OrthotropicFabric,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    projected_stress,
    rectangle,
)

WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)


@pytest.mark.mpi
@pytest.mark.parametrize(("seed", "away"), [(33, 60.0), (45, 500.0), (46, 1e4), (56, 1e5)])
@pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")
def test_form_about_a_tilted_axis_far_away_is_at_rest_without_an_iteration(seed, away):
    random = np.random.default_rng(seed)
    flat, triangles = rectangle(10.0, 10.0, 6, 6)
    flat[:, 2] = 0.05 * flat[:, 0] * flat[:, 1] + random.uniform(-0.2, 0.2, len(flat))
    turn = np.linalg.qr(random.normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    points = flat @ turn.T + away * random.uniform(0.5, 1, 3)
    film = Membrane(triangles, WOVEN, (3e3, 2e3), turn[:, 0])
    structure = Structure(points, {"film": film}, [Support(np.unique(boundary_edges(triangles)))])
    loads = [[], [Pressure(50.0, "film")], [DistributedLoad(-30 * turn[:, 2], "film")]][seed % 3]
    form = projected_stress(structure, loads, direction=turn[:, 2] + 0.1 * random.normal(size=3))
    result = Analysis(form.structure, progress=False).run([Stage("form", loads)])["form"]
    assert sum(increment.total_iterations for increment in result.increments) == 0
    assert result.largest_displacement == 0
