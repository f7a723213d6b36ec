"""Structures that snap through or buckle in a load increment, and others: the report and the load."""

import warnings

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Outcome,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    UnstableStateWarning,
    equilibrium_path,
)
from fx_membrane.analysis.checkpoint import Checkpoint
from models import LIMIT, arch, same_state, sheet

SQUARE = [[-5.0, -5, 0], [5, -5, 0], [5, 5, 0], [-5, 5, 0]]
TRIANGLES = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]


def pyramid(rise=0.6):
    """Four masts that lean against each other, with a fabric over them."""
    fabric = Membrane(TRIANGLES, Fabric(5e5, 0.3), prestress=100.0)
    parts = {"fabric": fabric, "masts": Mast([[i, 4] for i in range(4)], 1e6)}
    return Structure([*SQUARE, [0, 0, rise]], parts, [Support(range(4))])


def cap():
    """Stiff shell, as far as triangles can form one without compression."""
    shell = Membrane(TRIANGLES, Fabric(5e5, 0.3), compression_stiffness=1.0)
    return Structure([*SQUARE, [0, 0, 0.6]], {"shell": shell}, [Support(range(4))])


def tent():
    """Mast that carries a fabric, held by its prestress and two guys."""
    points = [*SQUARE, [0, 0, 3.0], [0, 0, -2.0]]
    parts = {
        "fabric": Membrane(TRIANGLES, Fabric(5e5, 0.3), prestress=1e3),
        "guys": Cable([[i, 4] for i in range(4)], 1e6, prestress=1e3),
        "mast": Mast([[4, 5]], 1e6),
    }
    return Structure(points, parts, [Support([*range(4), 5])])


def snapped(result):
    """Load factors between which it snapped: none, or two."""
    factors = [0.0, *(increment.load_factor for increment in result.increments)]
    where = [number for number, increment in enumerate(result.increments) if increment.outcome.lost_stability]
    return [bound for number in where for bound in factors[number : number + 2]]


@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [1, 3])
def test_arch_snaps_at_its_largest_load(steps):
    stage = Stage("push", [PointLoad(1, (0, 0, -5 * LIMIT))], increments=steps)
    with pytest.warns(UnstableStateWarning, match="Stage 'push': between load factors 0.19.* snapped or buckled"):
        result = Analysis(arch()).run([stage])["push"]
    low, high = snapped(result)
    assert low < 1 / 5 < high
    assert high - low == pytest.approx(1 / steps / 256, rel=1e-12)
    assert result.displacement[1, 2] < -0.6


def test_arch_below_its_largest_load_does_not():
    stage = Stage("push", [PointLoad(1, (0, 0, -0.999 * LIMIT))])
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStateWarning)
        result = Analysis(arch()).run([stage])["push"]
    assert not snapped(result)
    assert result.displacement[1, 2] > -0.3


def test_arch_driven_past_its_largest_load_does_not():
    """A jack holds all shapes in between."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStateWarning)
        result = Analysis(arch()).run([Stage("jack", displacements=[PrescribedDisplacement(1, (0, 0, -0.7), "z")])])
    assert len(result["jack"].increments) == 1


TURNING = {
    "pyramid": (pyramid(), DistributedLoad((0, 0, -1500.0), "fabric")),
    "cap under pressure": (cap(), Pressure(-2e3, "shell")),
}


@pytest.fixture(scope="module", params=TURNING)
def turning(request):
    """Structure, load, and the load factor where the path turns."""
    structure, load = TURNING[request.param]
    rest = Analysis(structure).run([Stage("rest")])["rest"]
    path = equilibrium_path(rest, Stage("load", [load], after="rest", increments=200), None, (4, "z", -0.8))
    return structure, load, path.load_factors[path.limit_points[0]]


@pytest.mark.mpi_once
@pytest.mark.parametrize("steps", [1, 4])
def test_snaps_where_the_path_turns(turning, steps):
    """Also if Newton's steps pass over all unstable shapes."""
    structure, load, limit = turning
    stages = [Stage("rest"), Stage("load", [load], after="rest", increments=steps)]
    with pytest.warns(UnstableStateWarning, match="Stage 'load': between"):
        results = Analysis(structure).run(stages)
    assert results["load"].position[4, 2] < -0.6
    low, high = snapped(results["load"])
    assert low < limit < high
    assert high - low == pytest.approx(1 / steps / 256, rel=1e-12)


@pytest.mark.filterwarnings("ignore:Stage .* moved by")  # it then falls over
def test_column_buckles_under_the_load_of_its_spring():
    """Two bars in line, held at their joint by cables of the stiffness k in all across: at a load of about k l / 2."""
    points = [[0, 0, 0], [0, 0, 1.0], [0, 0, 2.0], [-1, 0, 1], [1, 0, 1]]
    parts = {"column": Mast([[0, 1], [1, 2]], 1e6), "springs": Cable([[1, 3], [1, 4]], 1e4, prestress=100.0)}
    structure = Structure(points, parts, [Support([0, 3, 4]), Support(2, "xy"), Support(1, "y")])
    stages = [Stage("rest"), Stage("load", [PointLoad(2, (0, 0, -1.05e4))], after="rest")]
    with pytest.warns(UnstableStateWarning, match="buckled"):
        result = Analysis(structure).run(stages)["load"]
    # The lateral stiffness is lost at 0.9999e4 (`stability`); 1 % further it certainly counts as negative.
    critical = 0.9999 / 1.05
    assert snapped(result) == pytest.approx([critical, critical], abs=0.01)


STILL = {
    "sail": (sheet(), [DistributedLoad((0, 0, -1e4), "fabric")]),
    "cushion": (sheet(), [Pressure(1e4, "fabric")]),
    "tent under snow": (tent(), [DistributedLoad((0, 0, -300.0), "fabric")]),
    "tent in the wind": (tent(), [DistributedLoad((200.0, 0, 0), "fabric"), Pressure(300.0, "fabric")]),
}


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", STILL)
def test_what_does_not_snap_is_not_reported(name):
    structure, actions = STILL[name]
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStateWarning)
        results = Analysis(structure).run([Stage("rest"), Stage("load", actions, after="rest")])
    assert len(results["load"].increments) == 1
    assert np.abs(results["load"].displacement).max() > 1e-3


def test_a_state_that_smaller_increments_do_not_reach_is_kept(monkeypatch):
    """The structure has snapped between the last increment and that."""
    analysis = Analysis(arch())
    solve, tried = analysis._solve, []

    def only_the_first(*arguments):
        tried.append(solve(*arguments))
        return tried[-1] if len(tried) == 1 else type(tried[0])(Outcome.MAX_ITERATIONS, "it is unwilling.", ())

    monkeypatch.setattr(analysis, "_solve", only_the_first)
    with pytest.warns(UnstableStateWarning, match="between load factors 0 and 1 "):
        result = analysis.run([Stage("push", [PointLoad(1, (0, 0, -2 * LIMIT))])])["push"]
    assert len(tried) == 1 + 8
    assert snapped(result) == [0, 1]
    assert result.equilibrium.residual < 1e-9 * LIMIT


@pytest.mark.filterwarnings("ignore::fx_membrane.UnstableStateWarning")
@pytest.mark.parametrize("saves", [1, 3, 5])
def test_run_that_is_killed_goes_on_to_the_same_snap(saves, tmp_path, monkeypatch):
    """Before the snap-through, during its bracketing, and after it."""
    stages = [Stage("push", [PointLoad(1, (0, 0, -1.4 * LIMIT))], increments=3)]
    whole = Analysis(arch()).run(stages)["push"]
    save, done = Checkpoint.save, []

    def killed(*arguments):
        if len(done) == saves:
            raise KeyboardInterrupt
        done.append(save(*arguments))

    monkeypatch.setattr(Checkpoint, "save", killed)
    with pytest.raises(KeyboardInterrupt):
        Analysis(arch()).run(stages, tmp_path / "push.npz")
    monkeypatch.undo()
    resumed = Analysis(arch()).run(stages, tmp_path / "push.npz")["push"]
    assert snapped(resumed) == snapped(whole) != []
    assert same_state(resumed, whole)
