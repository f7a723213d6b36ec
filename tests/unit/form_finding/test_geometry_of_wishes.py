"""Cables of given geometry under stress wished for, warp unlike weft: forms settle in a few steps, with one force."""

import pytest

from fx_membrane import CableLength, CableSag, EdgeAngle, prescribed_stress
from unit.form_finding.test_prescribed_stress import canopy

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


@pytest.mark.parametrize("prestress", [(3e3, 2e3), (2.5e3, 2.5e3)])
@pytest.mark.parametrize("constraint", [CableSag("edge", 0.6), CableLength("edge", 8.7), EdgeAngle("edge", 35.0)])
def test_form_of_cables_of_given_geometry_settles_in_a_few_steps(constraint, prestress):
    form = prescribed_stress(canopy(prestress=prestress), constraints=[constraint])
    assert form.converged
    assert len(form.steps) <= 12


@pytest.mark.parametrize("prestress", [(3e3, 2e3), (4e3, 1e3)])
def test_form_of_deep_edges_is_found_for_unequal_stress(prestress):
    assert prescribed_stress(canopy(prestress=prestress), constraints=[CableSag("edge", 0.8)]).converged
