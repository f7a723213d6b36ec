"""Outlines moved to the nearest stress: exact gradient, gain, seams and edges kept, ends that keep the best pattern."""

import json
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Fabric,
    Membrane,
    Newton,
    Outcome,
    Pressure,
    Structure,
    Support,
    boundary_edges,
    cut_strips,
    cutting_pattern,
    geodesic,
    nearest_stress_pattern,
    prove_pattern,
    rectangle,
)
from fx_membrane.patterns.outline_motion import OutlineMotion
from fx_membrane.patterns.pieces import pieces_of
from fx_membrane.patterns.sewn_roof import SewnRoof
from gores import catenoid, gores

P, R = 400.0, 5.0


@pytest.fixture(scope="module")
def strips():
    return catenoid(24, 2, 8, quarter=True)


@pytest.fixture(scope="module")
def pattern(strips):
    return cutting_pattern(strips)


@pytest.fixture(scope="module")
def fitted(pattern):
    return nearest_stress_pattern(pattern, progress=False)


@pytest.fixture(scope="module")
def tube():
    """Tube whose facets carry the pressure exactly."""
    corner = R / np.cos(np.pi / 12)
    return gores(lambda t: corner + 0 * t, lambda t: 6 * t, 4, 3, 3, prestress=(1e3, P * R), alternating=False)


def pressed(tube):
    return [Pressure(P, name) for name in tube.names]


@pytest.mark.mpi
def test_gradient_is_exact():
    """Central differences go to the gradient with the square of the step; pressure makes the tangent unsymmetric."""
    strips = catenoid(12, 2, 4, quarter=True)
    pattern = cutting_pattern(strips)
    pieces = pieces_of(strips)
    load = [Pressure(300.0, name) for name in strips.names]
    roof = SewnRoof(pattern, pieces, load, Newton(rtol=1e-12), MPI.COMM_WORLD, False)
    motion = OutlineMotion(strips, pieces, roof.start.places, ())
    direction = np.random.default_rng(1).standard_normal(motion.count)
    middle = roof.at(motion.places(1e-3 * direction), roof.start)  # no equal seams, and no symmetry
    slopes = roof.linearized(middle)
    exact = motion.gathered(slopes.gradient()) @ direction

    def error(step):
        ends = [roof.at(motion.places((1e-3 + sign * step) * direction), middle).objective for sign in (1, -1)]
        return abs((ends[0] - ends[1]) / (2 * step) / exact - 1)

    errors = [error(step) for step in (4e-4, 2e-4, 1e-5)]
    assert errors[-1] < 1e-6
    assert 1.9 < np.log2(errors[0] / errors[1]) < 2.1
    other = np.random.default_rng(2).standard_normal(4 * len(roof.area))
    weight = np.repeat(roof.area / roof.area.sum(), 4)
    forth = (weight * other) @ slopes.errors(motion.spread(direction))
    assert motion.gathered(slopes.back(other)) @ direction == pytest.approx(forth, rel=1e-9)
    slopes.destroy()
    roof.release()


def test_stress_comes_nearer_most_at_borders(pattern, fitted):
    """The strain of the curvature stays; strips of least energy end at borders without their neighbours."""
    fit = fitted.fit
    assert fit.converged
    assert 0.02 < fit.gain < 0.1
    assert fit.border_gain > 0.07
    assert fit.inside_gain < 0.04
    before, after = (prove_pattern(one, progress=False) for one in (pattern, fitted))
    for proof, told in ((before, fit.before), (after, fit.after)):
        off = np.concatenate([proof.state.membrane(name).principal for name in proof.strips]) / 4e3 - 1
        area = np.concatenate([strip.area for strip in proof.strips.values()])
        assert told.rms == pytest.approx(np.sqrt(area @ (off**2).sum(axis=1) / area.sum()), rel=1e-6)
    assert after.seam_difference < 1e-12
    assert max(np.abs(fitted.cloth[name].points - pattern.cloth[name].points).max() for name in fitted.cloth) < 0.01
    assert {name: flat.points.tolist() for name, flat in fitted.flat.items()} == {
        name: flat.points.tolist() for name, flat in pattern.flat.items()
    }


def test_like_strips_stay_alike(fitted):
    area = [strip.area for strip in fitted.cloth.values()]
    assert np.ptp(area) < 1e-5 * area[0]


def test_no_step_along_the_outline_gains_more(fitted, strips):
    again = nearest_stress_pattern(fitted, progress=False).fit
    assert again.before.rms == pytest.approx(fitted.fit.after.rms, rel=1e-6)
    assert again.gain < 0.005


def test_exact_pattern_stays(tube):
    """The cloth of a tube has the stress of the design: nothing moves."""
    pattern = cutting_pattern(tube)
    found = nearest_stress_pattern(pattern, pressed(tube), solver=Newton(rtol=1e-12), progress=False)
    assert found.fit.converged
    assert found.fit.before.rms < 1e-8
    assert found.fit.gain < 1e-3
    for name, cloth in pattern.cloth.items():
        np.testing.assert_allclose(found.cloth[name].points, cloth.points, atol=1e-9)


def test_wrong_factors_are_mended(tube):
    """A tube cut by factors comes to the compensation of its law, and to the stress of the design."""
    exact = cutting_pattern(tube)
    wrong = cutting_pattern(tube, compensation=(0.995, 0.998))
    found = nearest_stress_pattern(wrong, pressed(tube), progress=False)
    assert found.fit.converged
    assert found.fit.before.rms > 0.3
    assert found.fit.gain > 0.97
    for name, ratio in found.compensation.items():
        np.testing.assert_allclose(ratio, exact.compensation[name], atol=2e-4)
    proof = prove_pattern(found, pressed(tube), progress=False)
    assert proof.seam_difference < 1e-12
    assert proof.stress_error < 0.05


def test_decompensated_edges_are_kept(strips):
    kept = cutting_pattern(strips, compensation=0.99, decompensate=["bottom 1", "seam 2"], transition=0.5)
    found = nearest_stress_pattern(kept, progress=False)
    assert found.fit.gain > 0.1
    for name, edge in (("gore 1", "bottom 1"), ("gore 2", "seam 2"), ("gore 3", "seam 2")):
        first, last = (
            one.cloth[name].side_lengths(next(side for side in one.cloth[name].sides if side.edge == edge))
            for one in (kept, found)
        )
        np.testing.assert_allclose(last, first, rtol=1e-11)


def test_differences_of_seams_are_kept():
    pytest.importorskip("potpourri3d")
    points, triangles = rectangle(8.0, 6.0, 8, 6)
    points[:, 2] = points[:, 0] * points[:, 1] / 12.0
    film = Membrane(triangles, Fabric(5e5, 0.3), 2e3)
    roof = Structure(points, {"roof": film}, [Support(np.unique(boundary_edges(triangles)))])
    uneven = cutting_pattern(cut_strips(roof, [geodesic(roof, (-4, -1, 1 / 3), (4, -1, -1 / 3))]), seam_difference=1.0)
    moved = nearest_stress_pattern(uneven, progress=False)
    one, other = (prove_pattern(each, progress=False) for each in (uneven, moved))
    assert moved.fit.gain > 0
    assert one.seam_difference > 1e-7
    assert other.seam_difference == pytest.approx(one.seam_difference, rel=1e-3)


def test_single_strip_without_seam(tube):
    """A strip between a support and free edges has no bound lengths."""
    alone = catenoid(8, 2, 4, quarter=True)
    name = alone.names[0]
    edges = tuple(replace(edge, strips=(name,), held=True) for edge in alone.edges if name in edge.strips)
    part = alone.membrane(name)
    structure = replace(
        alone.structure,
        parts={name: part},
        supports=[replace(alone.structure.supports[0], nodes=np.unique(np.concatenate([e.nodes for e in edges])))],
    )
    found = nearest_stress_pattern(cutting_pattern(replace(alone, structure=structure, edges=edges)), progress=False)
    assert found.fit.converged
    assert found.fit.gain > 0.02


class Faltering:
    """Newton's method that finds no equilibrium from some solve on."""

    def __init__(self, good):
        self.good = good

    def prepare(self, problem):
        solve, calls = Newton().prepare(problem), iter(range(10**6))

        def faltering(loaded, x, monitor, thorough):
            solution = solve(loaded, x, monitor, thorough)
            return solution if next(calls) < self.good else replace(solution, outcome=Outcome.DIVERGED)

        return faltering


def test_best_pattern_survives_lost_equilibrium(pattern):
    found = nearest_stress_pattern(pattern, solver=Faltering(2), progress=False)
    assert not found.fit.converged
    assert "no equilibrium" in found.fit.remark
    assert "not settled" in str(found.fit)
    assert 0 < found.fit.gain < 0.1
    proof = prove_pattern(found, progress=False)
    assert proof.seam_difference < 1e-9


def test_few_iterations_tell_so(pattern):
    found = nearest_stress_pattern(pattern, max_iterations=2, tolerance=1e-9, progress=False)
    assert not found.fit.converged
    assert "max_iterations" in found.fit.remark
    assert found.fit.gain > 0


def test_text_and_data(fitted):
    told = fitted.fit.to_dict()
    assert json.loads(json.dumps(told)) == told
    assert told["before"]["inside rms tensor error"] == fitted.fit.before.inside_rms
    lines = str(fitted.fit).splitlines()
    assert lines[0].endswith("patterns tried, settled; error of the tensor, with shear [%]")
    assert f"{100 * fitted.fit.after.rms:.4g}" in lines[2]
    proof = prove_pattern(fitted, progress=False)
    assert proof.to_dict()["nearest stress"] == told
    assert str(fitted.fit) in str(proof)


def test_progress_is_told(pattern, capfd, monkeypatch):
    monkeypatch.setattr("fx_membrane.solvers.progress.SILENCE", 0.0)
    nearest_stress_pattern(pattern)
    assert "nearest stress: pattern 1, rms tensor error" in capfd.readouterr().err


def test_refusals(strips, pattern):
    with pytest.raises(ValueError, match="nearest_stress_pattern pattern"):
        nearest_stress_pattern(strips)
    with pytest.raises(ValueError, match="tolerance"):
        nearest_stress_pattern(pattern, tolerance=0)
    with pytest.raises(ValueError, match="max_iterations"):
        nearest_stress_pattern(pattern, max_iterations=0)
    parts = {name: replace(part, prestress=0.0) for name, part in strips.structure.parts.items()}
    loose = replace(strips, structure=replace(strips.structure, parts=parts))
    with pytest.raises(ValueError, match="has no prestress"):
        nearest_stress_pattern(cutting_pattern(loose, compensation=0.995), progress=False)


@pytest.mark.mpi
def test_processes_find_the_same_pattern():
    pattern = cutting_pattern(catenoid(16, 2, 4, quarter=True))
    together, alone = (
        nearest_stress_pattern(pattern, comm=comm, tolerance=1e-2, progress=False)
        for comm in (MPI.COMM_WORLD, MPI.COMM_SELF)
    )
    assert alone.fit.gain > 0.02
    assert together.fit.gain == pytest.approx(alone.fit.gain, rel=1e-5)
    for name, cloth in alone.cloth.items():
        np.testing.assert_allclose(together.cloth[name].points, cloth.points, atol=1e-5)
