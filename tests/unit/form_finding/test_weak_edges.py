"""Edge cables too weak for their membrane: the force named is enough, for spans, corners, narrow places, held edges."""

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    CableDensity,
    Fabric,
    Membrane,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.reasons.edge_forces import weak_edges
from fx_membrane.form_finding.reasons.no_form import forces_in, stresses_in
from wished_films import WOVEN

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


@pytest.mark.study
@pytest.mark.parametrize(("corners", "stress"), [(3, (3e3, 2e3)), (6, (3e3, 2e3))])
def test_force_named_by_prescribed_stress_gives_a_form(corners, stress):
    with pytest.warns(UnsettledFormWarning, match=r"edge cables are too weak: .* more than") as told:
        form = prescribed_stress(plan(corners, stress, [2e3] * corners, COARSE))
    assert not form.converged
    assert "neck" not in str(told[0].message)
    forces = needed(str(told[0].message))
    enough = [1.01 * forces.get(f"edge {c}", 2e3) for c in range(corners)]
    assert prescribed_stress(plan(corners, stress, enough, COARSE)).converged


def test_force_named_for_a_cable_around_all_edges_gives_a_form():
    with pytest.warns(UnsettledFormWarning, match="edge cables are too weak") as told:
        prescribed_stress(plan(4, 2e3, 2e3, COARSE))
    assert prescribed_stress(plan(4, 2e3, 1.01 * needed(str(told[0].message))["edge"], COARSE)).converged


@pytest.mark.parametrize("corners", [3, 8])
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


def test_rule_is_exact_in_a_plane_and_a_guide_in_space():
    flat = sheet(12, 6, [5.0, 5.0, 5.0, 5.0])
    assert "are too weak" in rule(flat).words
    assert "less may do" not in rule(flat).words
    saddle = replace(flat, points=flat.points + flat.points[:, :1] * flat.points[:, 1:2] * [0, 0, 0.05])
    assert rule(saddle).words.endswith("by the rule of arcs, in space mostly sufficient: less may do")


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


def rule_of_density(densities):
    """Edges of a sheet of 6 x 6 under a stress of 2, with a force density on the cells of each side."""
    structure = sheet(6.0, 6.0, [100.0] * 4)
    points, given = structure.points, {f"side {k}": np.broadcast_to(q, 8) for k, q in enumerate(densities)}
    return weak_edges(structure, points, stresses_in(structure, points), forces_in(structure), given)


def test_force_density_turns_an_edge_by_stress_times_segments_over_twice_its_size():
    # Two equal edges share a right angle, so each turns by k n / (2 q) = pi / 4: q = 8 * 2 * 2 / pi.
    need = 32 / np.pi
    assert rule_of_density([1.01 * need] * 4).words == ""
    found = rule_of_density([0.99 * need] * 4)
    assert found.needs == pytest.approx([need] * 4, rel=1e-6)
    assert "have a force density of 10.08 and a force density of 10.08 over spans of 6 and 6" in found.words
    assert "by part: 'side 0' a force density of 10.19" in found.words
    unequal = np.repeat([1.01 * need / 1.5, 1.01 * need / 0.5], 4)  # the same mean of 1 / q: the same length of the arc
    assert rule_of_density([unequal, 1.01 * need, 1.01 * need, 1.01 * need]).words == ""


def sail_between_arcs(lift=3.0, stress=2e3, n=8):
    """Sail of 12 m between four arcs, lifted by stress in projection."""
    flat, triangles = rectangle(2.0, 2.0, n, n)
    sag = np.sqrt(12**2 - (6 * flat[:, :2]) ** 2) - np.sqrt(12**2 - 6**2)
    points = 6 * flat
    points[:, :2] -= flat[:, :2] * sag[:, ::-1]
    corners = np.flatnonzero(np.abs(flat[:, 0] * flat[:, 1]) == 1)
    points[corners[[0, 3]], 2] = lift
    film = Membrane(triangles, Fabric(6e5, 0.3), stress)
    plan = Structure(
        points, {"film": film, "edge": Cable(boundary_edges(triangles), 2e7, 12 * stress)}, [Support(corners)]
    )
    return replace(plan, points=projected_stress(plan).points)


METHODS = {
    "updated reference": partial(updated_reference, max_iterations=300),
    "prescribed stress": prescribed_stress,
    "natural force density": partial(natural_force_density, iterations=100, tolerance=5e-3),
}


@pytest.mark.parametrize("name", METHODS)
def test_force_density_named_gives_a_form(name):
    find, structure = METHODS[name], sail_between_arcs(n=6)
    try:
        with pytest.warns(UnsettledFormWarning) as told:
            form = find(structure, constraints=[CableDensity("edge", 6e3)])
        assert not form.converged
        message = " ".join(str(warning.message) for warning in told)
    except RuntimeError as refusal:
        message = str(refusal)
    need = float(re.search(r"too weak: .* by part: 'edge' a force density of ([\d.]+)", message)[1])
    assert 6e3 < need < 9e3
    assert find(structure, constraints=[CableDensity("edge", 1.01 * need)]).converged


def test_force_density_named_in_projection_keeps_the_plan():
    structure = sail_between_arcs(0.0)
    with pytest.warns(UnsettledFormWarning, match="too weak: .* by part: 'edge' a force density of 1.019e"):
        projected_stress(structure, constraints=[CableDensity("edge", 8e3)])
    weak = replace(structure.parts["edge"], prestress=8e3)
    with pytest.warns(UnsettledFormWarning, match="too weak: .* by part: 'edge' a force density of 1.019e"):
        projected_stress(replace(structure, parts=structure.parts | {"edge": weak}), cables="force density")
