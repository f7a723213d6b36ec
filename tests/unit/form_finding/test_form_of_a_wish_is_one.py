"""Prescribed stress as a wish: one form from all starts, from the form itself, and on two meshes."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    prescribed_stress,
)
from wished_films import canopy, lifted, saddle

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


@pytest.mark.parametrize("start", ["plan", "bent", "slid", "random"])
@pytest.mark.parametrize("structure", [saddle(prestress=(4e3, 1e3)), canopy(prestress=(4e3, 1e3))])
def test_two_starts_give_the_same_form(structure, start):
    one, other = prescribed_stress(structure), prescribed_stress(lifted(structure, start))
    assert other.points == pytest.approx(one.points, abs=1e-6)
    assert other.steps[-1].area == pytest.approx(one.steps[-1].area, rel=1e-8)
    assert other.forces["film"] == pytest.approx(one.forces["film"], abs=1e-6 * 4e3)


@pytest.mark.parametrize("structure", [saddle(), canopy(), canopy(prestress=(4e3, 1e3))])
def test_form_of_a_form_moves_nothing(structure):
    one = prescribed_stress(structure)
    again = prescribed_stress(replace(structure, points=one.points))
    assert np.abs(again.points - one.points).max() < 1e-7 * 8
    assert again.steps[-1].area == pytest.approx(one.steps[-1].area, rel=1e-10)


@pytest.mark.study("prestress")
@pytest.mark.parametrize("prestress", [(3e3, 3e3), (3e3, 2e3), (4e3, 1e3)])
@pytest.mark.parametrize("of", [saddle, canopy])
def test_two_meshes_give_the_same_form_at_second_order(of, prestress):
    """Mirrored meshes, with the other diagonals, about the diagonal plane of the wish: equal but for the mesh."""
    gaps, areas = [], []
    for n in (4, 8, 16):
        structure = of(n, prestress)
        film = replace(structure.parts["film"], warp=(1.0, 0, 0))
        structure = replace(structure, parts={**structure.parts, "film": film})
        node = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
        mirrored = replace(film, cells=node[:, ::-1].ravel()[film.cells][:, ::-1])
        one = prescribed_stress(structure)
        other = prescribed_stress(replace(structure, parts={**structure.parts, "film": mirrored}))
        middle = node[n // 4 :: n // 4, n // 4 :: n // 4][:3, :3]
        gaps.append(abs(other.steps[-1].area - one.steps[-1].area) + np.abs(other.points - one.points)[middle].max())
        areas.append(one.steps[-1].area)
    assert np.log2((areas[0] - areas[1]) / (areas[1] - areas[2])) > 1.8
    assert gaps[-1] < 1e-3 * 8
    assert np.log2(gaps[0] / gaps[2]) / 2 > 1.8 or gaps[0] < 1e-6
