"""Stages that change natural shapes and prestress: temperature, lengths, jacking, loss."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    LengthChange,
    Mast,
    Membrane,
    NaturalStretch,
    PointLoad,
    Pressure,
    PrestressFactor,
    Problem,
    Stage,
    Structure,
    Support,
    TemperatureChange,
    equilibrium_path,
)
from fx_membrane.assembly.actions import between
from models import CENTRE, EDGE, TRIANGLES, close, inclined_sheet, masted_roof, same_state, sheet

FEET = [2, 3, 4]
MAST = np.array([[0, 0, 0], [0, 0, 4.0], [3, 0, 0], [-1.5, 2.6, 0], [-1.5, -2.6, 0]])
EA = 1e6


def guyed_mast(mast=1.0, stays=1.0, prestress=0.0):
    parts = {
        "mast": Mast([[0, 1]], 1e8, natural_stretch=mast),
        "stays": Cable([[1, 2], [1, 3], [1, 4]], EA, natural_stretch=stays, prestress=prestress),
    }
    return Structure(MAST, parts, [Support([0, *FEET])])


@pytest.mark.mpi
def test_changes_are_kept_by_the_stages_after():
    fabric = Membrane(TRIANGLES, Fabric(1e6, 0.3), prestress=4e3)
    structure = Structure(sheet().points, {"fabric": fabric}, [Support(EDGE)])
    stages = [
        Stage("warm", changes=[TemperatureChange(30.0, "fabric", 3e-5)]),
        Stage("warmer", after="warm", changes=[TemperatureChange(50.0, "fabric", 3e-5)], increments=2),
        Stage("cold again", after="warmer", changes=[TemperatureChange(-80.0, "fabric", 3e-5)]),
        Stage("loss", changes=[PrestressFactor(0.5, "fabric")]),
        Stage("further loss", after="loss", changes=[PrestressFactor(0.5, "fabric")]),
        Stage("plain"),
    ]
    results = Analysis(structure).run(stages)
    stress = {name: results[name].membrane("fabric").principal for name in results}
    slope = 1e6 * 3e-5 / 0.7
    expected = {"warm": 4e3 - 30 * slope, "warmer": 4e3 - 80 * slope, "loss": 2e3, "further loss": 1e3, "plain": 4e3}
    for name, value in expected.items():
        assert stress[name] == pytest.approx(value, rel=1e-10), name
    assert stress["cold again"] == pytest.approx(4e3, rel=1e-11)
    assert np.abs(results["cold again"].displacement).max() < 1e-12
    assert len(results["warmer"].increments) == 2


@pytest.mark.mpi
def test_mast_is_jacked_with_its_foot_held():
    """A longer mast tightens its stays, as by hand; in one increment or two, and as a natural stretch."""
    jack = [LengthChange(0.05, "mast")]
    results = {n: Analysis(guyed_mast()).run([Stage("jack", changes=jack, increments=n)])["jack"] for n in (1, 2)}
    assert same_state(results[1], results[2])
    head = MAST[1] + results[1].displacement[1]
    before, after = (np.linalg.norm(MAST[FEET] - place, axis=1) for place in (MAST[1], head))
    force = EA * ((after / before) ** 2 - 1) / 2 * after / before
    assert results[1].cable("stays").force == pytest.approx(force, rel=1e-9)
    assert results[1].mast("mast").force[0] < -1e4
    assert not results[1].displacement[0].any()
    longer = Analysis(guyed_mast(mast=4.05 / 4.0)).run([Stage("jack")])["jack"]
    assert same_state(longer, results[1])


@pytest.mark.mpi_once
def test_stays_that_are_shortened_or_cooled():
    """One stay by 3 cm; all of them by a temperature that belongs to a stretch."""
    structure = guyed_mast(prestress=2e4)
    one = Analysis(structure).run([Stage("s", changes=[LengthChange(-0.03, "stays", cells=[0])])])["s"]
    length = np.linalg.norm(MAST[2] - MAST[1])
    stretch = [1 - 0.03 / length, 1, 1]
    assert same_state(one, Analysis(guyed_mast(stays=stretch, prestress=2e4)).run([Stage("s")])["s"])
    assert one.cable("stays").force[0] > 2e4
    factor = (1 - 2 * 1.2e-5 * -40.0) ** -0.5
    cold = Analysis(structure).run([Stage("s", changes=[TemperatureChange(-40.0, "stays", 1.2e-5)])])["s"]
    assert same_state(cold, Analysis(guyed_mast(stays=factor, prestress=2e4)).run([Stage("s")])["s"])


@pytest.mark.mpi_once
def test_cells_share_a_length_in_proportion():
    """A straight line of three cells, shortened as one: its force is that of the whole line, and no node moves."""
    points = [[0, 0, 0], [1, 0, 0], [4, 0, 0], [6, 0, 0]]
    cable = Cable([[0, 1], [1, 2], [2, 3]], EA, prestress=1e3)
    structure = Structure(points, {"line": cable}, [Support([0, 3])])
    state = Analysis(structure).run([Stage("s", changes=[LengthChange(-0.06, "line")])])["s"]
    ratio = 6.0 / 5.94
    assert state.cable("line").force == pytest.approx((1e3 + EA * (ratio**2 - 1) / 2) * ratio, rel=1e-9)
    assert np.abs(state.displacement).max() < 1e-9
    assert state.cable("line").strain == pytest.approx((ratio**2 - 1) / 2, rel=1e-9)
    twice = [LengthChange(-0.03, "line"), LengthChange(-0.03, "line")]
    assert same_state(Analysis(structure).run([Stage("s", changes=twice)])["s"], state)


@pytest.mark.mpi_once
def test_compensation_of_some_cells():
    """Shorter cloth in half of a roof pulls its middle to that side; whole, it raises the stress as its law says."""
    roof = masted_roof()
    half = np.flatnonzero(roof.points[roof.parts["roof"].cells].mean(axis=1)[:, 0] < 0)
    change = NaturalStretch((0.998, 1.0), "roof", cells=half)
    state = Analysis(roof).run([Stage("s", changes=[change])])["s"]
    stress = state.membrane("roof").warp_weft_stress[:, 0]
    plain = Analysis(roof).run([Stage("s")])["s"]
    assert stress.mean() > plain.membrane("roof").warp_weft_stress[:, 0].mean() + 100
    assert state.displacement[CENTRE, 0] < -1e-5


@pytest.mark.mpi
def test_derivative_by_the_load_factor_with_changes():
    """Order 2 of central differences, natural shapes and prestress factors included."""
    problem = Problem(inclined_sheet())
    x = problem.to_petsc(0.05 * np.random.default_rng(2).normal(size=problem.structure.points.shape))
    first = Stage("a", [Pressure(300.0, "fabric")], changes=[NaturalStretch(0.99, "fabric", range(5))])
    changes = [TemperatureChange(-300.0, "fabric", 2e-5), PrestressFactor(0.4, "fabric", range(9))]
    start = problem.actions_of(first)
    final = problem.actions_of(Stage("b", [PointLoad(CENTRE, (1.0, 2, -30))], changes=changes), start)

    def residual(factor):
        return problem.to_numpy(problem.under(between(start, final, factor)).residual(x)).copy()

    exact = problem.to_numpy(problem.under(final).load_derivative(x, start))
    steps = np.array([0.4, 0.2, 0.1])
    found = [np.abs((residual(1 + h) - residual(1 - h)) / (2 * h) - exact).max() for h in steps]
    assert np.abs(exact).max() > 10
    np.testing.assert_allclose(np.log2(np.divide(found[:-1], found[1:])), 2, rtol=0, atol=0.1)


@pytest.mark.mpi
def test_path_of_changes_ends_where_the_stage_does():
    structure = guyed_mast(prestress=1e3)
    changes = [LengthChange(0.05, "mast"), TemperatureChange(-20.0, "stays", 1.2e-5), PrestressFactor(0.5, "stays")]
    stage = Stage("jack", [PointLoad(1, (500.0, 0, 0))], changes=changes, increments=4)
    path = equilibrium_path(structure, stage)
    assert path.complete
    state = Analysis(structure).run([stage])["jack"]
    assert close(path.points[-1].displacement, state.displacement)
    assert same_state(path.state(-1), state)


@pytest.mark.mpi
def test_prestress_that_is_lost_and_given_again():
    results = Analysis(masted_roof()).run(
        [
            Stage("half", changes=[PrestressFactor(0.5, "roof"), PrestressFactor(0.5, "edge", cells=[0, 1])]),
            Stage("again", after="half", changes=[PrestressFactor(2.0, "roof"), PrestressFactor(2.0, "edge", [1, 0])]),
            Stage("plain"),
        ]
    )
    assert same_state(results["again"], results["plain"])
    assert results["half"].cable("edge").force[:3] == pytest.approx([50.0, 50.0, 100.0])


COUNTED = """
from fx_membrane import *

points, triangles = rectangle(1.0, 1.0, 3, 3)
rim = boundary_edges(triangles)
parts = {"roof": Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3), "rim": Cable(rim, 1e6, 1e3)}
analysis = Analysis(Structure(points, parts, [Support(rim[:, 0])]))
warm = [TemperatureChange(10.0, "roof", 1e-5), TemperatureChange(10.0, "rim", 1e-5)]
analysis.run([Stage("warm", changes=warm)])
count()
analysis.run([
    Stage("warm", changes=warm),
    Stage("warmer", changes=warm, after="warm", increments=2),
    Stage("cut", changes=[NaturalStretch(0.99, "roof", cells=[1]), LengthChange(-0.01, "rim", [2])], after="warm"),
    Stage("loss", changes=[PrestressFactor(0.8, "roof")], after="cut"),
    Stage("plain"),
])
cold = {"roof": Membrane(triangles, Fabric(2e5, 0.2), prestress=2e3, natural_stretch=0.99), "rim": Cable(rim, 1e6, 1e3)}
Analysis(Structure(points, cold, [Support(rim[:, 0])])).run([Stage("plain")])
count()
"""


def test_nothing_is_compiled_between_stages(compiled_code):
    made, after = compiled_code(COUNTED)
    assert made == after > 0
