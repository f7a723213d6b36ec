"""Plans that a stress moves, folds or lets shrink: reported, and the last good form is kept."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    UnsettledFormWarning,
    projected_stress,
)
from sails import FABRIC, canopy, state_of

pytestmark = pytest.mark.filterwarnings(
    "ignore::fx_membrane.UnsettledFormWarning", "ignore::fx_membrane.LargeStrainWarning"
)


def test_stress_that_moves_its_plan_is_reported_and_comes_nearer_from_there():
    structure = canopy(force=25e3)
    with pytest.warns(UnsettledFormWarning, match="moved in plan"):
        form = projected_stress(structure)
    assert not form.converged
    with pytest.warns(UnsettledFormWarning):
        again = projected_stress(replace(structure, points=form.points))
    assert again.steps[-1].stress_error < form.steps[-1].stress_error


def test_too_few_steps_are_reported():
    with pytest.warns(UnsettledFormWarning, match="cables are off by .* step 1"):
        form = projected_stress(canopy(), max_iterations=1)
    assert len(form.steps) == 1
    assert not form.converged


def with_film_and_valley(structure, prestress, valley):
    parts = {
        "film": replace(structure.parts["film"], prestress=prestress),
        "valley": Cable(structure.parts["valley"].cells, 2e7, valley),
    }
    return replace(structure, parts={**structure.parts, **parts})


def test_fold_of_the_plan_of_the_form_is_named():
    structure = with_film_and_valley(canopy(force=10.0, material=FABRIC), (3e3, 3e2), 0.0)
    with pytest.warns(UnsettledFormWarning, match=r"'film' folds over itself in plan at cell 1, \(.*edge cables"):
        form = projected_stress(structure, cables="force density")
    assert not form.converged
    assert np.abs(state_of(form).displacement).max() < 1e-12 * 12


def test_collapse_keeps_the_last_good_form():
    structure = with_film_and_valley(canopy(force=10.0, material=FABRIC), (3e3, 2.5e3), 1e6)
    with pytest.warns(UnsettledFormWarning, match=r"'film', cell \d+ shrinks to nothing at \("):
        form = projected_stress(structure)
    assert not form.converged
    assert len(form.steps) == 2
    with pytest.warns(UnsettledFormWarning):
        expected = projected_stress(structure, max_iterations=2)
    assert np.array_equal(form.points, expected.points)
