"""Nodes that slide on lines and planes: along axes, inclined, each its own way, with supports."""

from dataclasses import replace

import numpy as np
import pytest

from constrained import FABRIC, cone, moved
from fx_membrane import (
    Membrane,
    Pressure,
    Slide,
    Structure,
    Support,
    natural_force_density,
    projected_stress,
    rectangle,
)
from models import rotation

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


def sail(n=6):
    """Square of a saddle; two edges held, the other two free."""
    points, triangles = rectangle(4.0, 4.0, n, n)
    points[:, 2] = points[:, 0] * points[:, 1] / 4
    held = np.flatnonzero(np.abs(points[:, 0]) == 2)
    return Structure(points, {"film": Membrane(triangles, FABRIC, 2e3, (1, 0, 0))}, [Support(held)])


def free_edges(structure):
    x, y = structure.points[:, :2].T
    return np.flatnonzero((np.abs(y) == 2) & (np.abs(x) < 2))


@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
@pytest.mark.parametrize(
    ("slide", "held"),
    [({"normal": (0, 0, -2.0)}, "z"), ({"direction": (0, 3.0, 0)}, "xz"), ({"direction": (0, 0, 1e-200)}, "xy")],
)
def test_slide_along_axes_is_a_support(method, slide, held):
    structure = sail()
    nodes, loads = free_edges(structure), [Pressure(100.0, "film")]
    one = method(structure, loads, constraints=[Slide(nodes, **slide)])
    other = method(replace(structure, supports=[*structure.supports, Support(nodes, held)]), loads)
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.reactions, other.reactions)
    assert np.array_equal(one.structure.supported, other.structure.supported)


@pytest.mark.mpi_once
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("slide", [{"normal": (0, 0, 1.0)}, {"direction": (0, 1.0, 0)}])
def test_inclined_slide_is_the_turned_one(seed, slide):
    structure, turn = sail(), rotation(seed)
    nodes = free_edges(structure)
    film = replace(structure.parts["film"], warp=turn @ [1, 0, 0])
    turned = replace(structure, points=structure.points @ turn.T, parts={"film": film})
    inclined = {name: turn @ value for name, value in slide.items()}
    loads = [Pressure(100.0, "film")]
    one = natural_force_density(structure, loads, 2, constraints=[Slide(nodes, **slide)])
    other = natural_force_density(turned, loads, 2, constraints=[Slide(nodes, **inclined)])
    assert other.points == pytest.approx(one.points @ turn.T, abs=1e-11)
    assert other.reactions == pytest.approx(one.reactions @ turn.T, abs=1e-9 * np.abs(one.reactions).max())
    assert other.structure.supported[nodes].all()
    assert moved(other, loads) < 1e-12


def test_slide_of_each_node_has_its_own_direction():
    structure, ring = cone()
    radial = structure.points[ring] * [1, 1, 0] + [0, 0, -0.5]
    form = projected_stress(structure, constraints=[Slide(ring, direction=radial)])
    way = form.points[ring] - structure.points[ring]
    assert np.linalg.norm(way, axis=1).min() > 0.1
    assert np.linalg.norm(np.cross(way, radial), axis=1).max() < 1e-12
    assert np.abs(np.sum(form.reactions[ring] * radial, axis=1)).max() < 1e-9 * np.abs(form.reactions).max()
    assert moved(form) < 1e-12


def test_slide_and_support_leave_what_both_allow():
    structure = sail()
    nodes = free_edges(structure)
    held = replace(structure, supports=[*structure.supports, Support(nodes, "z")])
    form = natural_force_density(held, constraints=[Slide(nodes, normal=(1, 1, 0))])
    way = form.points[nodes] - structure.points[nodes]
    assert np.abs(way[:, 2]).max() == 0
    assert np.abs(way[:, 0] + way[:, 1]).max() < 1e-14
    assert np.abs(way).max() > 1e-2
