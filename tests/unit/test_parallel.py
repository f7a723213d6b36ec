"""Results are independent of the number of processes and of the user's numbering; run it with mpirun, too."""

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    ConvergenceError,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    rectangle,
)

pytestmark = pytest.mark.mpi

N = 6  # grid cells along each side of the sheet
FREE_STANDING = 5


class Model:
    """A sheet with a cable along one edge, a mast under it and stays, its nodes and cells in any order."""

    def __init__(self, seed=None):
        points, triangles = rectangle(2.0, 2.0, N, N)
        grid = np.arange((N + 1) ** 2).reshape(N + 1, N + 1)
        foot, middle, anchor, other = len(points) + np.arange(4)
        added = [[0, 0, -0.6], [1.5, 0, -0.2], [2, 0, -0.4], [1.6, 1.6, -0.8]]
        unused = np.random.default_rng(3).uniform(-9, 9, size=(FREE_STANDING, 3))
        points = np.vstack([points, added, unused])
        centre, edge = grid[N // 2, N // 2], grid[:, -1]

        rng = np.random.default_rng(seed)
        shuffle = rng.permutation if seed is not None else np.arange
        self.nodes = shuffle(len(points))  # old number of each new node
        self.number = np.argsort(self.nodes)  # new number of each old node
        cells = {
            "fabric": triangles,
            "edge": np.stack([edge[:-1], edge[1:]], axis=1),
            "stays": np.array([[edge[N // 2], middle], [middle, anchor], [edge[1], other], [edge[-2], other]]),
            "mast": np.array([[foot, centre]]),
        }
        self.cells = {name: shuffle(len(rows)) for name, rows in cells.items()}
        cells = {name: self.number[rows[self.cells[name]]] for name, rows in cells.items()}
        stiff = np.linspace(2e3, 4e3, N)
        fabric = Fabric(Et=1e5, nu=0.3)
        self.structure = Structure(
            points[self.nodes],
            {
                "fabric": Membrane(cells["fabric"], fabric, prestress=(900.0, 1100.0), warp=(1, 0.3, 0)),
                "edge": Cable(cells["edge"], 1e6, stiff[self.cells["edge"]]),
                "stays": Cable(cells["stays"], 5e5, 1e3),
                "mast": Mast(cells["mast"], 1e7, -500.0),
            },
            [
                Support(self.number[grid[:, 0]]),
                Support(self.number[[grid[0, -1], grid[-1, -1], anchor, other]]),
                Support(self.number[grid[0, 1:-1]], "yz"),
            ],
        )
        loaded = np.flatnonzero(self.cells["fabric"] < 20)
        snow = [
            DistributedLoad((5.0, 0, -300.0), "fabric", loaded),
            PointLoad(self.number[[middle, edge[2]]], (10.0, 20, -30)),
        ]
        weight = DistributedLoad((0, 0, -10.0), "stays")
        self.stages = [
            Stage("jack", [weight], [PrescribedDisplacement(self.number[foot], (0, 0, 0.05))], increments=2),
            Stage("snow", snow, after="jack"),
        ]

    def run(self, comm=MPI.COMM_WORLD):
        return Analysis(self.structure, comm=comm).run(self.stages)


def fields(result, model):
    """All arrays of a result, in the order before shuffling."""
    named = {name: getattr(result, name)[model.number] for name in ("displacement", "position", "loads", "reactions")}
    for part, values in result.parts.items():
        order = np.argsort(model.cells[part])
        named |= {f"{part}: {name}": array[order] for name, array in vars(values).items()}
    balance = vars(result.equilibrium)
    totals = ("loads", "reactions", "load_moment", "reaction_moment")
    return named | {f"total {name}": balance[name] for name in totals}


def assert_same(result, model, expected, expected_model):
    assert result.energy == pytest.approx(expected.energy, rel=1e-12)
    mine, theirs = fields(result, model), fields(expected, expected_model)
    assert mine.keys() == theirs.keys()
    for name, array in theirs.items():
        assert array.size
        if array.dtype.kind != "f":
            assert np.array_equal(mine[name], array), name
            continue
        largest = np.abs(array).max()
        assert largest > 0, name
        assert mine[name] == pytest.approx(array, abs=1e-9 * largest), name


@pytest.fixture(scope="module")
def alone():
    """Model in its own order, on one process."""
    model = Model()
    return model, model.run(MPI.COMM_SELF)


def test_model_is_what_the_tests_need(alone):
    model, results = alone
    assert np.count_nonzero(~model.structure.used) == FREE_STANDING
    assert len(model.structure.parts["mast"].cells) == 1
    assert np.abs(results["snow"].displacement - results["jack"].displacement).max() > 0.02
    assert results["snow"].equilibrium.residual < 1e-9 * np.abs(results["snow"].reactions).max()


@pytest.mark.parametrize("seed", [None, 1, 2])
def test_all_processes_together_give_what_one_gives(seed):
    model = Model(seed)
    together, single = model.run(MPI.COMM_WORLD), model.run(MPI.COMM_SELF)
    for name in ("jack", "snow"):
        assert_same(together[name], model, single[name], model)
        assert len(together[name].history) == len(single[name].history)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_numbering_permutes_the_results_and_nothing_else(alone, seed):
    original, expected = alone
    model = Model(seed)
    assert not np.array_equal(model.structure.points, original.structure.points)
    results = model.run()
    for name in ("jack", "snow"):
        assert_same(results[name], model, expected[name], original)


def test_every_process_has_all_results():
    model = Model(1)
    snow = fields(model.run()["snow"], model)
    for other in MPI.COMM_WORLD.allgather(snow):
        for name, array in snow.items():
            assert np.array_equal(array, other[name]), name


def test_fewer_nodes_than_processes():
    structure = Structure([[0.0, 0, 0], [0, 0, 2]], {"mast": Mast([[0, 1]], 1e6)}, [Support(0), Support(1, "xy")])
    result = Analysis(structure).run([Stage("load", [PointLoad(1, (1.0, 2.0, -500.0))])])["load"]
    assert result.mast("mast").force == pytest.approx([-500.0], rel=1e-9)
    assert result.reactions == pytest.approx(np.array([[0, 0, 500.0], [-1, -2, 0]]), rel=1e-9, abs=1e-9)


def test_failure_is_the_same_on_every_process():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.flatnonzero(np.abs(points).max(axis=1) == 1)
    structure = Structure(points, {"fabric": Membrane(triangles, Fabric(Et=1e5, nu=0.3))}, [Support(rim)])
    stages = [Stage("snow", [DistributedLoad((0, 0, -1.0), "fabric")])]

    def message(comm):
        with pytest.raises(ConvergenceError) as error:
            Analysis(structure, Newton(line_search=False), comm).run(stages)
        return str(error.value)

    together = message(MPI.COMM_WORLD)
    assert MPI.COMM_WORLD.allgather(together) == [message(MPI.COMM_SELF)] * MPI.COMM_WORLD.size
