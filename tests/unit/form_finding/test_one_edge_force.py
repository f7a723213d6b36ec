"""Least force of edge cables: one number from all methods, whatever force they have, and exact in a plane."""

import re
from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest

import constrained
from fx_membrane import (
    Membrane,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    updated_reference,
)
from told import told
from wished_films import WOVEN

SPAN, WARP, WEFT = 12.0, 3e3, 2e3
# Arcs of one force T at a right angle turn by asin(n L / 2 T) each, together by the right angle.
EXACT = float(np.hypot(WARP, WEFT)) * SPAN / 2
METHODS = {
    "projection": projected_stress,
    "projection, forces": partial(projected_stress, cables="force"),
    "natural densities": partial(natural_force_density, iterations=5),
    "updated reference": updated_reference,
    "prescribed stress": prescribed_stress,
}


def canopy(force, scale=1.0, n=6):
    """Canopy of 12 m in a plane, with corners held and one cable around, and a start between arcs."""
    soap_film = constrained.canopy(n, force, depth=0.2, height=0.0)
    film = Membrane(soap_film.parts["film"].cells, WOVEN, (WARP / scale, WEFT / scale), (1, 0, 0))
    return replace(soap_film, points=scale * soap_film.points, parts={**soap_film.parts, "film": film})


@cache
def found(name, force):
    """Find a form by a method, which tests only read, and its words."""
    return told(METHODS[name], canopy(force))


@pytest.mark.study("force")
@pytest.mark.parametrize("force", [11e3, 16e3])
@pytest.mark.parametrize("name", METHODS)
def test_all_methods_name_the_exact_force_whatever_the_force_is(name, force):
    form, words = found(name, force)
    assert not form.converged
    assert float(re.search(r"by part: 'edge' ([\d.]+e\+\d+)", words)[1]) == pytest.approx(EXACT, rel=1e-3)


def test_force_does_not_depend_on_the_unit():
    form, words = told(natural_force_density, canopy(18e3, scale=1e3))
    assert not form.converged
    assert float(re.search(r"by part: 'edge' ([\d.]+e\+\d+)", words)[1]) == pytest.approx(EXACT, rel=1e-3)


def test_form_with_the_force_named_is_found():
    assert told(prescribed_stress, canopy(1.01 * EXACT))[0].converged


def test_stress_far_from_the_wish_in_a_cell_is_told_with_its_place():
    form, _ = found("prescribed stress", 11e3)
    assert form.differences["film"].max() > 0.5
    assert not form.converged
    remark = next(each for each in form.remarks if "differs from the wish" in each)
    cell = form.differences["film"].argmax()
    assert f"part 'film', cell {cell} at (" in remark
    assert f"{100 * form.differences['film'].max():.3g} %" in remark
