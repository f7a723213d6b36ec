"""Cables along seams between membranes of different stress: which are too weak, where, and the force they need."""

from dataclasses import replace

import pytest

from fx_membrane import UnsettledFormWarning, prescribed_stress
from fx_membrane.form_finding.reasons.edge_forces import weak_edges
from fx_membrane.form_finding.reasons.no_form import forces_in, stresses_in
from unit.form_finding.test_seams import halves
from wished_films import canopy

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


def test_seam_cable_weaker_than_the_difference_of_stresses_is_named_with_the_force_it_needs():
    structure = halves(canopy(prestress=(1e3, 1e3), force=60e3), prestress=(5e3, 5e3), force=5e3)
    weak = weak_edges(structure, structure.points, stresses_in(structure, structure.points), forces_in(structure))
    assert weak.words == (
        "Some cables at seams are too weak: that of part 'seam' at the seam around (0, 0, 0) has 5000 over a span of "
        "8; the difference of the stresses on both sides of 4000 there needs more than 1.6e+04, stress times half the "
        "span; by the rule of arcs, in space mostly sufficient: less may do"
    )
    enough = replace(structure, parts={**structure.parts, "seam": replace(structure.parts["seam"], prestress=17e3)})
    assert not weak_edges(enough, enough.points, stresses_in(enough, enough.points), forces_in(enough)).words
    with pytest.warns(UnsettledFormWarning, match="cables at seams are too weak: that of part 'seam' at the seam"):
        assert not prescribed_stress(structure).converged


def test_seam_cable_between_membranes_of_one_stress_needs_no_force():
    structure = halves(canopy(prestress=(2e3, 2e3)), force=1.0)
    assert not weak_edges(
        structure, structure.points, stresses_in(structure, structure.points), forces_in(structure)
    ).words
