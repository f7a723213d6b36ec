"""Structures sewn of several membranes: reasons, remarks and steps are those of one."""

import re
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Fabric,
    Membrane,
    RadialDirection,
    Structure,
    Support,
    prescribed_stress,
    updated_reference,
)
from fx_membrane.form_finding.nearest_stress.start import even_state
from fx_membrane.form_finding.nearest_stress.state import NearestProblem
from fx_membrane.form_finding.reasons.folds import fold
from fx_membrane.form_finding.reasons.necks import neck
from fx_membrane.form_finding.reasons.no_form import stresses_in
from fx_membrane.form_finding.reasons.ring_reach import far_ring
from fx_membrane.form_finding.reasons.sewn_surfaces import cell_in, joined_membranes
from fx_membrane.form_finding.shape_change import change_of_shape
from fx_membrane.form_finding.wishes import wishes_of
from unit.form_finding.test_seams import halves
from wished_films import canopy, cone

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


def gores(structure, count=4):
    """Divide the membrane by the angle about the axis, each gore a part of its own."""
    film, points = structure.parts["film"], structure.points
    centre = points[film.cells].mean(axis=1)
    number = ((np.arctan2(centre[:, 1], centre[:, 0]) % (2 * np.pi)) * count / (2 * np.pi)).astype(int)
    parts = {f"gore {k}": replace(film, cells=film.cells[number == k]) for k in range(count)}
    return replace(structure, parts=parts | {name: part for name, part in structure.parts.items() if part is not film})


def high(prestress=(2e3, 2e3)):
    return cone(n=4, h=9.0, prestress=prestress)


def test_gores_are_one_surface_and_pieces_apart_are_two():
    structure = gores(cone(n=3))
    assert joined_membranes(structure) == [[f"gore {k}" for k in range(4)]]
    points, count = structure.points, len(structure.points)
    far = replace(structure.parts["gore 1"], cells=structure.parts["gore 1"].cells + count)
    both = np.concatenate([points, points + 20.0])[np.r_[0:count, np.unique(far.cells)]]
    far = replace(far, cells=count + np.unique(far.cells, return_inverse=True)[1].reshape(-1, 3))
    held = Support([*np.asarray(structure.supports[0].nodes), count, count + 1, count + 2])
    assert len(joined_membranes(Structure(both, {**structure.parts, "far": far}, [held]))) == 2
    count = len(structure.parts["gore 0"].cells)
    assert cell_in(structure, ["gore 0", "gore 1"], count) == ("gore 1", 0)
    assert cell_in(structure, ["gore 0", "gore 1"], count - 1) == ("gore 0", count - 1)


def test_ring_of_gores_is_too_far_as_that_of_one_part():
    one, sewn = high(), gores(high())
    told = [far_ring(each, each.points, stresses_in(each, each.points)) for each in (one, sewn)]
    assert "is too far from its base" in told[0]
    assert told[1] == told[0].replace("part 'film'", "parts 'gore 0', 'gore 1', 'gore 2' and 1 more")


@pytest.mark.mpi
def test_prescribed_stress_names_the_ring_of_gores():
    told = " ".join(prescribed_stress(gores(high())).remarks)
    assert "A ring is too far from its base: that of parts 'gore 0'" in told


def test_neck_of_gores_is_found():
    structure = gores(cone(n=4))
    problem = NearestProblem(structure, (), wishes_of(structure, None, None))
    points = even_state(problem).points.copy()
    points[16:32, :2] *= 0.02
    assert re.search(r"closes to a neck in part 'gore \d', at \(", neck(structure, points))


def test_fold_at_a_seam_is_told_with_both_parts():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0.1, 0.9, 0.01]])
    parts = {name: Membrane([cell], Fabric(1e5, 0.3), 1e3) for name, cell in (("a", [0, 1, 2]), ("b", [1, 0, 3]))}
    words = fold(Structure(points, parts, [Support(range(4))]), points)
    assert "Parts 'a' and 'b' fold over each other at their seam between cell 0 and cell 0, at (0.5, 0, 0)" in words


def test_remark_on_the_exact_wish_is_that_of_one_part():
    structure = cone(n=4, prestress=(3e3, 2e3))
    one = prescribed_stress(structure, warp={"film": RadialDirection()})
    sewn = gores(structure)
    other = prescribed_stress(sewn, warp={name: RadialDirection() for name in sewn.parts})
    assert other.remarks[0].startswith("Parts 'gore 0', 'gore 1', 'gore 2' and 1 more: about an axis")
    assert other.remarks[0].partition(":")[2] == one.remarks[0].partition(":")[2]


def test_sliding_of_a_seam_of_one_stress_is_no_change_of_shape():
    sewn, points = halves(canopy()), canopy().points.copy()
    slide = np.zeros_like(points)
    seam = np.isclose(points[:, 0], 0) & (np.abs(points[:, 1]) < 4)
    points[:, 2] = 0.0  # flat
    slide[seam, 0] = 0.1
    assert change_of_shape(sewn, points, slide) < 1e-12
    unlike = halves(canopy(), prestress=(2e3, 3e3))
    assert change_of_shape(unlike, points, slide) == pytest.approx(0.1, rel=0.1)


def test_updated_reference_takes_as_many_steps_for_a_sewn_sail():
    film = replace(canopy().parts["film"], prestress=2e3)
    one = replace(canopy(), parts={**canopy().parts, "film": film})
    forms = [updated_reference(each, tolerance=1e-4) for each in (one, halves(one))]
    assert len(forms[0].steps) == len(forms[1].steps)
    assert forms[1].points == pytest.approx(forms[0].points, abs=1e-9 * 8)
