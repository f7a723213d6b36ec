"""Edge cables too weak for their membrane: the force named is enough, for spans, corners, narrow places, held edges."""

import re

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    OrthotropicFabric,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.reasons.no_form import forces_in, stresses_in
from fx_membrane.form_finding.reasons.weak_edges import weak_edges

WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)
COARSE = 4  # segments of an edge; the force that it needs depends on the spans, not on the mesh


def plan(corners, stress, forces, n=6, lift=1.5):
    """Polygon of unequal sides between held corners at heights, with a cable on each edge, or one on all."""
    random = np.random.default_rng(corners)
    angle = 2 * np.pi * (np.arange(corners) + random.uniform(-0.2, 0.2, corners)) / corners
    rim = np.stack([np.cos(angle), np.sin(angle), np.zeros(corners)], axis=1)
    rim *= 6 * random.uniform(0.8, 1.2, corners)[:, None]
    rim[:, 2] = lift * random.uniform(-1, 1, corners)
    share = np.arange(n)[:, None] / n
    edge = np.concatenate([a + share * (b - a) for a, b in zip(rim, np.roll(rim, -1, axis=0), strict=True)])
    around, middle = len(edge), np.array([0.0, 0.0, rim[:, 2].mean()])
    points = np.concatenate([middle + k / n * (edge - middle) for k in range(1, n + 1)] + [middle[None]])
    i, j = (index.ravel() for index in np.mgrid[: n - 1, :around])
    a, b, k = i * around + j, i * around + (j + 1) % around, np.arange(around)
    centre = np.full(around, n * around)
    triangles = np.concatenate(
        [
            np.stack([a, b + around, b], axis=1),
            np.stack([a, a + around, b + around], axis=1),
            np.stack([k, (k + 1) % around, centre], axis=1),
        ]
    )
    outer = (n - 1) * around + k
    segments = np.stack([outer, np.roll(outer, -1)], axis=1)
    equal = np.isscalar(stress)
    film = Membrane(triangles, Fabric(6e5, 0.3) if equal else WOVEN, stress, None if equal else (1, 0, 0))
    parts: dict[str, Membrane | Cable] = {"film": film}
    if np.isscalar(forces):
        parts["edge"] = Cable(segments, 2e7, forces)
    else:
        parts |= {f"edge {c}": Cable(segments[c * n : (c + 1) * n], 2e7, forces[c]) for c in range(corners)}
    return Structure(points, parts, [Support(outer[::n])])


def rule(structure):
    points = structure.points
    return weak_edges(structure, points, stresses_in(structure, points), forces_in(structure))


def needed(message):
    """Read the forces that edge cables need, by part."""
    words = message.partition("by part: ")[2].partition(". ")[0]
    return {name: float(force) for name, force in re.findall(r"'([^']+)' ([\d.e+]+)", words)}


@pytest.mark.parametrize(("corners", "stress"), [(3, (3e3, 2e3)), (4, 2e3), (5, (4e3, 1e3)), (6, (3e3, 2e3))])
def test_force_named_by_prescribed_stress_gives_a_form(corners, stress):
    with pytest.warns(UnsettledFormWarning, match=r"edge cables are too weak: .* more than") as told:
        form = prescribed_stress(plan(corners, stress, [2e3] * corners, COARSE))
    assert not form.converged
    assert "neck" not in str(told[0].message)
    forces = needed(str(told[0].message))
    enough = [1.01 * forces.get(f"edge {c}", 2e3) for c in range(corners)]
    assert prescribed_stress(plan(corners, stress, enough, COARSE)).converged


@pytest.mark.parametrize("corners", [4, 7])
def test_force_named_for_a_cable_around_all_edges_gives_a_form(corners):
    with pytest.warns(UnsettledFormWarning, match="edge cables are too weak") as told:
        prescribed_stress(plan(corners, 2e3, 2e3, COARSE))
    assert prescribed_stress(plan(corners, 2e3, 1.01 * needed(str(told[0].message))["edge"], COARSE)).converged


@pytest.mark.parametrize("corners", [3, 5, 8])
def test_force_named_by_updated_reference_gives_a_soap_film(corners):
    with pytest.warns(UnsettledFormWarning, match="edge cables are too weak") as told:
        updated_reference(plan(corners, 2e3, [2e3] * corners), max_iterations=300)
    forces = needed(str(told[0].message))
    enough = [1.01 * forces.get(f"edge {c}", 2e3) for c in range(corners)]
    assert updated_reference(plan(corners, 2e3, enough), max_iterations=300).converged


def sheet(width, depth, forces, n=8, held=()):
    """Rectangle between held corners with a cable on each side: low, right, high, left."""
    points, triangles = rectangle(width, depth, n, n)
    rim = boundary_edges(triangles)
    sides = [(1, -depth / 2), (0, width / 2), (1, depth / 2), (0, -width / 2)]
    on = [np.isclose(points[rim][:, :, axis], value).all(axis=1) for axis, value in sides]
    parts: dict[str, Membrane | Cable] = {"film": Membrane(triangles, Fabric(6e5, 0.3), 2.0)}
    parts |= {f"side {k}": Cable(rim[on[k]], 2e4, force) for k, force in enumerate(forces) if k not in held}
    corners = np.flatnonzero((np.abs(points[:, :2]) == [width / 2, depth / 2]).all(axis=1))
    fixed = np.unique(np.concatenate([corners, *(rim[on[k]].ravel() for k in held)]))
    return Structure(points, parts, [Support(fixed)])


def test_strong_edge_at_a_corner_is_not_called_too_weak():
    # The low edge turns by asin(6 / 100), so the right one may turn by the rest of the right angle.
    found = rule(sheet(6.0, 6.0, [100.0, 6.005, 100.0, 100.0]))
    assert [found.edges[k].part for k in found.weak] == ["side 1"]
    need = 6 / np.sin(np.pi / 2 - np.arcsin(6 / 100))
    assert found.needs[found.weak] == pytest.approx([need], rel=1e-6)
    assert "that of part 'side 1' around (3, 0, 0) needs more than 6.011" in found.words
    assert rule(sheet(6.0, 6.0, [100.0, 6.02, 100.0, 100.0])).words == ""


def test_opposite_edges_of_a_narrow_plan_are_named():
    # Arcs of sag 1 over a span of 8: R = (4^2 + 1) / 2, so they touch in the middle of a depth of 2.
    need = 2.0 * (4**2 + 1) / 2
    assert rule(sheet(8.0, 2.0, [1.01 * need, 9.0, 1.01 * need, 9.0], n=16)).words == ""
    found = rule(sheet(8.0, 2.0, [0.99 * need, 9.0, 0.99 * need, 9.0], n=16))
    assert [found.edges[k].part for k in found.weak] == ["side 0", "side 2"]
    assert found.needs[found.weak] == pytest.approx([need, need], rel=0.01)
    assert re.search(r"those of part 'side [02]' and 'side [02]' around .* would cross as arcs", found.words)


def test_edge_beside_held_ones_is_named():
    found = rule(sheet(8.0, 2.0, [5.0, 1.0, 9.0, 1.0], n=16, held=(1, 2, 3)))
    # The arc of the low edge would touch the high, held one at a sag of 2: R = (4^2 + 2^2) / 4.
    assert found.needs == pytest.approx([10.0], rel=0.01)
    assert re.search(r"'side 0' around \(0, -1, 0\) has .* would meet the held edge", found.words)


def test_projection_uses_the_same_rules():
    with pytest.warns(UnsettledFormWarning, match=r"'side 0' and 'side 2' around .* would cross as arcs"):
        assert not projected_stress(sheet(8.0, 2.0, [9.0, 9.0, 9.0, 9.0], n=16)).converged
