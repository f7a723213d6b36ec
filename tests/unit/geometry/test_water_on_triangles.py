"""Water on triangles: derivatives of volume and potential, dry, cut once at one or two corners, and wet.

Reference: Taylor's theorem, and sums over many points.
"""

import numpy as np
import pytest

from fx_membrane.geometry import water_on_triangles as water

CORNERS = np.random.default_rng(3).normal(size=(200, 3, 3))
STEPS = 1e-3 / 2.0 ** np.arange(4)
LEVEL = 0.1


def test_all_cases_are_there():
    wet = (CORNERS[:, :, 2] <= LEVEL).sum(axis=1)
    assert set(wet) == {0, 1, 2, 3}


@pytest.mark.parametrize("wet", range(4))
def test_taylor_remainders(wet):
    corners = CORNERS[(CORNERS[:, :, 2] <= LEVEL).sum(axis=1) == wet]
    corners = corners[np.abs(corners[:, :, 2] - LEVEL).min(axis=1) > 0.02]  # no corner passes the level
    d = np.random.default_rng(4).normal(size=corners.shape)
    first, slope = water.potentials(corners, LEVEL), water.potential_gradients(corners, LEVEL)
    curved = np.einsum("niakb,nkb->nia", water.potential_hessians(corners, LEVEL), d)
    energies, forces, volumes = [], [], []
    for h in STEPS:
        moved = corners + h * d
        change = h * np.einsum("nia,nia->n", slope, d) + h**2 / 2 * np.einsum("nia,nia->n", curved, d)
        energies.append(np.abs(water.potentials(moved, LEVEL) - first - change).sum())
        forces.append(np.abs(water.potential_gradients(moved, LEVEL) - slope - h * curved).sum())
        linear = water.volumes(corners, LEVEL)[0] + h * np.einsum(
            "nia,nia->n", water.volume_gradients(corners, LEVEL), d
        )
        volumes.append(np.abs(water.volumes(moved, LEVEL)[0] - linear).sum())
    if wet == 0:
        assert max(energies + forces + volumes) == 0
        return
    for errors, order in ((energies, 3), (forces, 2), (volumes, 2)):
        np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), order, atol=0.1)


def test_hessian_is_symmetric():
    found = water.potential_hessians(CORNERS, LEVEL).reshape(-1, 9, 9)
    np.testing.assert_allclose(found, found.transpose(0, 2, 1), atol=1e-14)


def test_volume_is_the_mean_depth_times_the_area():
    shares = np.random.default_rng(5).dirichlet([1, 1, 1], 40000)
    depths = np.maximum(LEVEL - CORNERS[:20, :, 2] @ shares.T, 0)
    expected = water.plan_areas(CORNERS[:20]) * depths.mean(axis=1)
    np.testing.assert_allclose(water.volumes(CORNERS[:20], LEVEL)[0], expected, atol=0.02)


def test_equal_heights_are_no_exception():
    corners = np.array([[[0, 0, z], [1, 0, z], [0, 1, z]] for z in (-0.5, 0.0, 0.5)], dtype=float)
    volume, area = water.volumes(corners, 0.0)
    np.testing.assert_allclose(volume, [0.25, 0.0, 0.0])
    np.testing.assert_allclose(area, [0.5, 0.5, 0.0])  # a level sheet that is just full counts as wet
