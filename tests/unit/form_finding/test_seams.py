"""Membranes with a common seam: the form of one membrane, fabrics with different wishes, cables along the seam."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Stage, Structure, prescribed_stress
from wished_films import canopy, cone, saddle

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.LargeStrainWarning")


def halves(structure, axis=0, prestress=None, force=None):
    """Divide the membrane along an axis; the second half has a prestress of its own, the seam a cable of a force."""
    film, points = structure.parts["film"], structure.points
    first = points[film.cells].mean(axis=1)[:, axis] < 0
    one, two = (replace(film, cells=film.cells[half]) for half in (first, ~first))
    parts = {"one": one, "two": two if prestress is None else replace(two, prestress=prestress)}
    if force is not None:
        seam = np.flatnonzero(np.isclose(points[:, axis], 0))
        seam = seam[np.argsort(points[seam, 1 - axis])]
        parts["seam"] = Cable(np.stack([seam[:-1], seam[1:]], axis=1), 2e7, force)
    return replace(structure, parts=parts | {name: part for name, part in structure.parts.items() if part is not film})


def with_seam_cable(structure, force):
    return replace(structure, parts=structure.parts | {"seam": halves(structure, force=force).parts["seam"]})


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("of", [canopy, saddle])
def test_two_halves_of_a_sail_give_the_form_of_one_part(of, axis):
    one, two = prescribed_stress(of()), prescribed_stress(halves(of(), axis))
    assert two.converged
    assert two.points == pytest.approx(one.points, abs=1e-9 * 8)
    assert two.forces["one"][0] == pytest.approx(one.forces["film"][0], rel=1e-9)


@pytest.mark.parametrize("force", [0.0, 5e3])
@pytest.mark.parametrize("of", [canopy, saddle])
def test_cable_along_the_seam_is_one_in_a_single_part(of, force):
    one, two = (prescribed_stress(part) for part in (with_seam_cable(of(), force), halves(of(), force=force)))
    assert one.converged
    assert two.converged
    assert two.points == pytest.approx(one.points, abs=1e-9 * 8)


def slid(structure):
    """Start with the inner nodes elsewhere in the surface."""
    points, free = structure.points.copy(), ~structure.supported.all(axis=1)
    hump = np.cos(np.pi * points[:, 0] / 8) * np.cos(np.pi * points[:, 1] / 8)
    points[free, :2] += np.outer(hump, [0.4, -0.3])[free]
    return Structure(points, structure.parts, structure.supports)


@pytest.mark.mpi_once
@pytest.mark.parametrize("force", [None, 5e3])
@pytest.mark.parametrize("of", [canopy, saddle])
def test_fabrics_with_different_wishes_settle(of, force):
    structure = halves(of(), prestress=(2e3, 3e3), force=force)
    one, other = prescribed_stress(structure), prescribed_stress(slid(structure))
    assert one.converged
    assert other.points == pytest.approx(one.points, abs=1e-6)
    assert np.abs(Analysis(one.structure).run([Stage("form")])["form"].displacement).max() < 1e-12 * 8


def test_seam_cable_keeps_its_ends_between_unlike_membranes():
    structure = halves(canopy(), prestress=(2.5e3, 2.5e3), force=5e3)
    form = prescribed_stress(structure)
    ends = structure.parts["seam"].cells[[0, -1], [0, 1]]
    assert form.converged
    assert np.abs(form.points[ends, 0]).max() < 0.5


def test_gores_of_a_cone_give_the_form_of_one_part():
    one, structure = prescribed_stress(cone(prestress=(2e3, 2e3))), cone(prestress=(2e3, 2e3))
    two = prescribed_stress(halves(structure))
    assert two.points == pytest.approx(one.points, abs=1e-8 * 7)
