"""Water on membranes: volumes on polyhedra, stability of a level sheet, and the elastica under a pond.

References in closed form: the volume of an inverted pyramid; that in a paraboloid, pi (h + 1)^2 / 2 up to the height h;
the prestress at which a level sheet that is brim full loses its stability, rho g L^2 / pi^2 for a strip, half of it for
a square, rho g a^2 / j^2 for a disc with the first zero j of the Bessel function J0; that of a strip whose water sinks
with a drain at the distance x from its middle, rho g (2 x / pi)^2; the exact shape of a strip with a
pond of given volume, by two independent methods. Claims: volumes of polyhedra to rounding, the others in second order
of the mesh size.
"""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Pond,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    stability,
)
from surfaces import half_disc

SOURCE = "elastica under a pond, two methods"

WEIGHT = 9810.0


def run(structure, *stages):
    return Analysis(structure, progress=False).run(stages)


def strip(n, prestress):
    """Strip of span 10 and one cell wide, in plane strain; the nodes of its sides; its width."""
    points, triangles = rectangle(10.0, 10.0 / n, n, 1)
    ends = np.abs(points[:, 0]) > 4.999
    roof = Membrane(triangles, Fabric(1e6, 0.3), prestress)
    made = Structure(points, {"roof": roof}, [Support(np.flatnonzero(ends)), Support(range(len(points)), "y")])
    return made, np.flatnonzero(~ends), 10.0 / n


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("pond", "level", "volume", "area"),
    [
        (Pond("roof", level=-0.5), -0.5, 1 / 6, 1.0),
        (Pond("roof", level=-0.25), -0.25, 0.5625, 2.25),
        (Pond("roof", volume=0.5625), -0.25, 0.5625, 2.25),
        (Pond("roof", rain=0.5625 / 4), -0.25, 0.5625, 2.25),
        (Pond("roof", rain=1.0), 0.0, 4 / 3, 4.0),
    ],
    ids=["level", "higher level", "volume", "rain", "more rain than it holds"],
)
def test_inverted_pyramid(pond, level, volume, area):
    points, triangles = rectangle(2.0, 2.0, 6, 6)  # the water line cuts cells
    points[:, 2] = np.abs(points[:, :2]).max(axis=1) - 1
    made = Structure(points, {"roof": Membrane(triangles, Fabric(1e5, 0.0), 1e3)}, [Support(range(len(points)))])
    state = run(made, Stage("water", [pond]))["water"]
    found = state.ponds[0]
    np.testing.assert_allclose((found.level, found.volume, found.area), (level, volume, area), atol=1e-12)
    np.testing.assert_allclose(found.lost, 4 - 4 / 3 if pond.rain == 1.0 else 0.0, atol=1e-12)
    np.testing.assert_allclose(state.equilibrium.loads[2], -WEIGHT * volume, rtol=1e-12)
    np.testing.assert_allclose(state.equilibrium.loads[:2], 0, atol=1e-9)


def disc(n, radius):
    """Nodes and triangles of a flat disc."""
    half, cells, _ = half_disc(n)
    lower = np.where(half[:, 1] > 1e-12, len(half) + np.cumsum(half[:, 1] > 1e-12) - 1, np.arange(len(half)))
    points = radius * np.vstack([half, half[half[:, 1] > 1e-12] * [1, -1, 1]])
    return points, np.vstack([cells, lower[cells][:, ::-1]])


@pytest.mark.mpi
def test_paraboloid(verified):
    errors = []
    for n in (12, 24, 48):
        points, triangles = disc(n, 1.0)
        points[:, 2] = (points**2).sum(axis=1) - 1
        bowl = Structure(points, {"bowl": Membrane(triangles, Fabric(1e5, 0.0), 1e3)}, [Support(range(len(points)))])
        water = [run(bowl, Stage("rain", [Pond("bowl", level=h)]))["rain"].ponds[0] for h in (-0.5, -0.25)]
        errors.append(
            [1 - pond.volume / (np.pi * (h + 1) ** 2 / 2) for pond, h in zip(water, (-0.5, -0.25), strict=True)]
        )
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    verified("water in a paraboloid up to half of its height [m3]", np.pi / 8, water[0].volume, orders[-1, 0])
    np.testing.assert_allclose(orders[-1], 2, atol=0.1)


@pytest.mark.mpi
@pytest.mark.parametrize("shape", ["strip", "square", "disc"])
def test_level_sheet_loses_stability_at_the_critical_prestress(shape):
    """The factor on the weight at which the lowest eigenvalue is zero is one at the critical prestress."""
    critical = WEIGHT * 100 * {"strip": 1, "square": 0.5, "disc": (np.pi / 2 / 2.4048255577) ** 2}[shape] / np.pi**2
    errors = []
    for n in (8, 16):
        if shape == "strip":
            made, walls, _ = strip(n, critical)
        else:
            square = shape == "square"
            points, triangles = rectangle(10.0, 10.0, n, n, diagonals="to centre") if square else disc(n, 5.0)
            rim, walls = np.unique(boundary_edges(triangles)), ()
            made = Structure(points, {"roof": Membrane(triangles, Fabric(1e6, 0.3), critical)}, [Support(rim)])

        state = run(made, Stage("full", [Pond("roof", level=0.0, walls=walls)]))["full"]
        dry = run(made, Stage("dry"))["dry"]
        assert not np.any(state.displacement)
        errors.append(stability(state).stiffnesses[0] / stability(dry).stiffnesses[0])
    assert 0 < errors[1] < 0.02
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_stability_shows_on_which_side_of_the_critical_prestress_a_sheet_is(factor):
    made, walls, _ = strip(40, factor * WEIGHT * 100 / np.pi**2)
    state = run(made, Stage("full", [Pond("roof", level=0.0, walls=walls)]))["full"]
    assert bool(np.any(state.displacement)) == (factor < 1)  # too soft: the solver leaves the level shape
    if factor > 1:
        assert stability(state).negative == 0


def drained(n, factor):
    """Level strip, full up to a drain at three quarters of its half span; factor on the critical prestress of a rim."""
    made, walls, width = strip(n, factor * WEIGHT * 100 / np.pi**2)
    drain = int(np.argmin(np.abs(made.points - (3.75, -width / 2, 0)).sum(axis=1)))
    return made, run(made, Stage("full", [Pond("roof", volume=1.0, walls=walls, drains=[drain])]))["full"]


@pytest.mark.mpi
def test_level_strip_with_a_drain_that_moves():
    """It loses its stability where the span to the drain does: water sinks with it.

    With N w'' + rho g (w - w(x0)) = 0, w = C + A cos kx needs cos k x0 = 0: N = rho g (2 x0 / pi)^2.
    """
    errors = []
    for n in (8, 16):
        made, state = drained(n, 0.75**2)
        errors.append(stability(state).stiffnesses[0] / stability(run(made, Stage("dry"))["dry"]).stiffnesses[0])
    assert 0 < errors[1] < 0.01
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.2)


@pytest.mark.parametrize(("factor", "level"), [(0.9, True), (0.6, True), (0.5, False)])
def test_level_strip_with_a_drain_on_both_sides_of_its_critical_prestress(factor, level):
    _, state = drained(16, factor)
    assert bool(np.abs(state.displacement).max() < 1e-9) == level
    assert stability(state).stable


@pytest.mark.mpi
@pytest.mark.parametrize(
    ("volume", "w", "level", "n", "half"),
    [
        (0.25, 0.5202624275, -0.3990271917, 10464.7741, 1.6181756565),
        (1.0, 0.8807866356, -0.5553843655, 23421.2498, 2.4068616187),
        (4.0, 1.3746526908, -0.5179326751, 55262.7944, 3.6361982828),
    ],
)
def test_pond_of_a_volume_on_a_strip(volume, w, level, n, half, verified):
    errors = []
    for cells in (20, 40, 80):
        made, walls, width = strip(cells, 4e3)
        state = run(made, Stage("water", [Pond("roof", volume=volume * width, walls=walls)]))["water"]
        found = state.ponds[0]
        assert found.volume == pytest.approx(volume * width, rel=1e-12)
        force = state.membrane("roof").principal[:, 0].mean()
        here = (-state.displacement[:, 2].min(), found.level, force, found.area / width / 2)
        errors.append(np.abs(np.divide(here, (w, level, n, half)) - 1))
    order = np.log2(errors[0][0] / errors[2][0]) / 2
    verified(f"sag of the strip under {volume:g} m3/m [m]", w, here[0], order)
    verified(f"level of {volume:g} m3/m [m]", level, here[1])
    assert np.log2(errors[0][:2] / errors[2][:2]) / 2 == pytest.approx(2, abs=0.35)


@pytest.mark.mpi
def test_strip_that_is_brim_full(verified):
    """More rain than it holds: the level is that of its ends, and the rest is lost."""
    exact = np.array([1.9074976068, 112_710.4597, 12.4088293388])
    found = []
    for cells in (20, 40, 80):
        made, walls, width = strip(cells, 4e3)
        state = run(made, Stage("water", [Pond("roof", volume=12.41 * width, walls=walls)]))["water"]
        pond = state.ponds[0]
        assert pond.level == 0
        assert pond.volume + pond.lost == pytest.approx(12.41 * width, rel=1e-12)
        force = state.membrane("roof").principal[:, 0].mean()
        found.append((-state.displacement[:, 2].min(), force, pond.volume / width))
    errors = np.abs(found / exact - 1)
    orders = np.log2(errors[:-1] / errors[1:])
    verified("volume of the strip, brim full [m3/m]", exact[2], found[-1][2], orders[-1, 2])
    np.testing.assert_allclose(orders[-1], 2, atol=0.1)


@pytest.mark.mpi
def test_work_of_the_water_is_its_energy():
    """Change of the energy between two states is the work of the forces on the way, by Simpson's rule."""
    made, walls, width = strip(20, 4e3)
    pond = Pond("roof", volume=width, walls=walls)
    states = []
    Analysis(made, progress=False).run([Stage("water", [pond], increments=8)], observe=states.append)
    loaded = states[-1].problem.under(states[-1].actions)
    ends = [states[i].displacement for i in (-3, -1)]
    x = [states[-1].problem.to_petsc(ends[0] + s * (ends[1] - ends[0])) for s in np.linspace(0, 1, 9)]
    way = states[-1].problem.to_petsc(ends[1] - ends[0])
    power = np.array([loaded.residual(at).dot(way) for at in x])
    work = (power[0] + 4 * power[1:-1:2].sum() + 2 * power[2:-1:2].sum() + power[-1]) / 24
    assert loaded.energy(x[-1]) - loaded.energy(x[0]) == pytest.approx(work, rel=1e-4)


def test_amounts_of_stages_add_up():
    made, walls, width = strip(20, 4e3)
    shower, storm = (Pond("roof", volume=v * width, walls=walls) for v in (0.25, 0.75))
    results = run(
        made,
        Stage("shower", [shower]),
        Stage("storm", [storm], after="shower"),
        Stage("at once", [Pond("roof", volume=width, walls=walls)]),
    )
    np.testing.assert_allclose(results["storm"].position, results["at once"].position, atol=1e-8)
    assert len(results["storm"].ponds) == 1
