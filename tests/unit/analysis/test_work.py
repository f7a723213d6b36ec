"""Limit of the work of a stage, and the results when it is used up."""

import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConjugateGradient,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    Outcome,
    PointLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    WorkLimit,
    rectangle,
)
from fx_membrane.analysis import work
from fx_membrane.solvers import newton_loop
from models import SNOW, sheet

EASY = [Stage("snow", [SNOW], increments=4)]


def flag(n=8):
    points, triangles = rectangle(3, 4, n, n)
    top = np.arange((n + 1) ** 2)[-n - 1 :]
    return Structure(points[:, [0, 2, 1]], {"fabric": Membrane(triangles, Fabric(3e5, 0.3))}, [Support(top)])


def weight_and_wind(pressure):
    weight = Stage("weight", [DistributedLoad((0, 0, -10.0), "fabric")])
    return [weight, Stage("wind", [Pressure(pressure, "fabric")], after="weight", increments=4)]


@pytest.mark.mpi
@pytest.mark.parametrize("solver", [Newton(), Newton(line_search=False), ConjugateGradient()])
def test_limit_of_iterations_is_met_exactly(solver):
    taken = sum(len(i.iterations) - 1 for i in Analysis(sheet(), solver).run(EASY)["snow"].increments)
    assert "snow" in Analysis(sheet(), solver, limit=WorkLimit(iterations=taken)).run(EASY)
    with pytest.raises(ConvergenceError, match=rf"limit.*{taken - 1} iterations.*stage") as error:
        Analysis(sheet(), solver, limit=WorkLimit(iterations=taken - 1)).run(EASY)
    assert [i.load_factor for i in error.value.last.increments] == [0.25, 0.5, 0.75]
    assert error.value.failed.load_factor == 1
    assert len(error.value.failed.iterations) > 1


def test_limit_is_that_of_each_stage():
    stages = [Stage("snow", [SNOW]), Stage("more", [SNOW], after="snow")]
    taken = max(len(state.increments[0].iterations) - 1 for state in Analysis(sheet()).run(stages).values())
    assert len(Analysis(sheet(), limit=WorkLimit(iterations=taken)).run(stages)) == 2


@pytest.mark.parametrize("most", [20, 150, 230, 400])
def test_every_fallback_counts(most, monkeypatch):
    """Attempts, the homotopy, attempts after it, and halved increments: the flag flies off."""
    residuals = []
    residual = newton_loop.NewtonLoop.residual
    monkeypatch.setattr(newton_loop.NewtonLoop, "residual", lambda *args: residuals.append(1) or residual(*args))
    analysis = Analysis(flag(), limit=WorkLimit(iterations=most))
    (weight, wind) = weight_and_wind(20.0)
    analysis.run([weight])
    residuals.clear()
    with pytest.raises(ConvergenceError, match=f"limit.*{most} iterations.*stage") as error:
        analysis.run([weight, wind])
    assert list(error.value.results) == ["weight"]
    assert most < len(residuals) < 1.2 * most + 40
    assert analysis._solve.problem.shift == 0  # type: ignore[attr-defined]
    assert "weight" in analysis.run([weight])  # the analysis continues normally


@pytest.mark.mpi
def test_limit_of_seconds(monkeypatch):
    clock = iter(np.arange(0.0, 1e6))
    monkeypatch.setattr(work, "monotonic", lambda: next(clock))
    with pytest.raises(ConvergenceError, match=r"limit.*9.5 s.*stage.*after \d iterations"):
        Analysis(sheet(), limit=WorkLimit(seconds=9.5)).run(EASY)


def test_run_goes_on_from_the_checkpoint_with_the_whole_limit_before_it(tmp_path):
    path = tmp_path / "checkpoint"
    expected = Analysis(sheet()).run(EASY)["snow"]
    taken = [len(increment.iterations) - 1 for increment in expected.increments]
    limited = Analysis(sheet(), limit=WorkLimit(iterations=taken[0] + taken[1] + 1))
    with pytest.raises(ConvergenceError) as error:
        limited.run(EASY, path)
    assert len(error.value.last.increments) == 2
    found = limited.run(EASY, path)["snow"]
    np.testing.assert_allclose(found.displacement, expected.displacement, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"iterations": 0}, "WorkLimit iterations is 0.*whole number above zero"),
        ({"iterations": 1.5}, "WorkLimit iterations is 1.5.*whole number"),
        ({"seconds": 0.0}, "WorkLimit seconds is 0.0.*positive"),
        ({"seconds": np.nan}, "WorkLimit seconds is nan"),
    ],
)
def test_odd_limits_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        WorkLimit(**arguments)


def test_flag_that_flies_off_is_said_to(recwarn):
    """A strip with a free end carries no pressure above its own weight."""
    with pytest.raises(ConvergenceError) as error:
        Analysis(flag(6), Newton(max_iterations=60)).run(weight_and_wind(20.0))
    message = str(error.value)
    last = error.value.last.increments[-1].load_factor
    assert 0.48 < last < 0.52
    assert f"load factor {last:.6g} on no equilibrium" in message
    assert "there is none" in message
    assert "will not help" in message
    assert "apply the loads in more" not in message  # nor are they advised


def test_light_banner_is_found_without_beginning_anew(recwarn):
    points, triangles = rectangle(3, 4, 16, 16)
    banner = Membrane(triangles, Fabric(1e6, 0.3))
    structure = Structure(points[:, [0, 2, 1]], {"fabric": banner}, [Support(np.arange(272, 289))])
    weight = Stage("weight", [DistributedLoad((0, 0, -1.0), "fabric")])
    wind = Analysis(structure, limit=WorkLimit(iterations=450)).run(
        [weight, Stage("wind", [Pressure(0.5, "fabric")], after="weight")]
    )["wind"]
    assert wind.increments[0].outcome is Outcome.CONVERGED
    assert wind.equilibrium.residual < 1e-8


LEANING = [Stage("rest"), Stage("wind", [PointLoad(1, (6, 10.0, 0))], after="rest", increments=2)]


def mast_with_two_guys():
    """Its third guy is missing: the first increment snaps at no load, yet looks for it by halving."""
    points = [[0, 0, 0], [0, 0, 4.0], [3, 0, 0], [-1.5, 2.598, 0]]
    parts = {"mast": Mast([[0, 1]], 2e8), "guys": Cable([[1, 2], [1, 3]], 12e6, prestress=1e3)}
    return Structure(points, parts, [Support([0, 2, 3])])


@pytest.mark.filterwarnings("ignore::fx_membrane.LostPrestressWarning", "ignore:.*slack or wrinkled parts carry")
def test_limit_that_ends_the_search_for_a_snap_tells_and_saves_none(tmp_path):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        expected = Analysis(mast_with_two_guys()).run(LEANING)["wind"].remarks
        searches = 0
        for most in range(8, 64, 8):
            file = tmp_path / f"{most}"
            with pytest.raises(ConvergenceError, match=f"limit.*{most} iterations.*stage") as e:
                Analysis(mast_with_two_guys(), limit=WorkLimit(iterations=most)).run(LEANING, file)
            searches += "between the load factors 0 and 0.5" in str(e.value)
            assert not any(increment.outcome.lost_stability for increment in (*e.value.last.increments, e.value.failed))
            if most in (8, 32):  # before the search, and within it
                assert Analysis(mast_with_two_guys()).run(LEANING, file)["wind"].remarks == expected
    assert searches > 1
    assert not any("snapped" in str(entry.message) for entry in caught)
