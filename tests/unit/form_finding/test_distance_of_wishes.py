"""Words on a form whose stress is not near the wish: mean, largest, where; rings too far; one force of weak edges."""

import re

import numpy as np
import pytest

from fx_membrane import RadialDirection, UnsettledFormWarning, prescribed_stress
from wished_films import canopy, cone

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


@pytest.mark.mpi
def test_form_far_from_the_wish_says_so_in_words():
    form = prescribed_stress(cone(), warp={"film": RadialDirection()})
    assert form.converged
    found = re.search(
        r"differs from the wish by ([\d.]+) % in the mean.*'film', cell (\d+) at .* by ([\d.]+) % in one direction;",
        form.remarks[-1],
    )
    assert 10 < float(found[1]) < 50
    assert int(found[2]) == form.differences["film"].argmax()
    assert float(found[3]) == pytest.approx(100 * form.steps[-1].stress_error, rel=6e-3)


def test_mean_above_the_largest_difference_names_the_terms_in_it():
    form = prescribed_stress(canopy(prestress=(3e3, 1e3), warp=(1, 1, 0)))
    found = re.search(
        r"by ([\d.]+) % in the mean, warp, weft and cables together.* by ([\d.]+) % in one", form.remarks[-1]
    )
    assert float(found[1]) > float(found[2])
    assert float(found[2]) == pytest.approx(100 * form.steps[-1].stress_error, rel=6e-3)


def test_form_near_the_wish_says_nothing():
    assert prescribed_stress(canopy()).remarks == ()


def test_ring_too_far_is_named_with_its_reach():
    form = prescribed_stress(cone(prestress=(3e3, 3e3)), warp={"film": RadialDirection()})
    # A catenoid between radii 2 and 7 reaches the maximum over its neck of c (arcosh(2 / c) + arcosh(7 / c)).
    neck = np.linspace(0.01, 2, 4000)
    reach = (neck * (np.arccosh(2 / neck) + np.arccosh(7 / neck))).max()
    told = re.search(r"ring is too far from its base.* is 5 away from it.* reaches about (\d+\.?\d+)", form.remarks[-1])
    assert float(told[1]) == pytest.approx(reach, rel=2e-2)


def test_weak_edge_is_told_with_one_force():
    with pytest.warns(UnsettledFormWarning, match="edge cables are too weak") as told:
        prescribed_stress(canopy(prestress=2e3, force=6e3))
    words = str(told[0].message)
    assert words.count("more than") == 1
    assert "and as an arc" not in words
