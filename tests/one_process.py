"""Errors of one process and input that differs between processes: each case prints its outcome on every process.

mpirun -n 2 python tests/one_process.py FOLDER
"""

import resource
import sys
import warnings
from pathlib import Path

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

import interrupted
from fx_membrane import (
    Analysis,
    CheckpointWarning,
    ConjugateGradient,
    DistributedLoad,
    Fabric,
    LargeStrainWarning,
    Membrane,
    Newton,
    PointLoad,
    Problem,
    Stage,
    equilibrium_path,
    natural_frequencies,
    plot,
    stability,
    structure_from_dolfinx,
    updated_reference,
)
from interrupted import POINTS, stages, structure

# isort: split
from dolfinx.mesh import create_unit_square

COMM = MPI.COMM_WORLD
FIRST = COMM.rank == 0
FOLDER = Path(sys.argv[1])

analysis = Analysis(structure())
results = analysis.run(stages())
lift = results["lift"]
pull = Stage("pull", [PointLoad(6, (0, 0, 10.0))], after="lift")


def run(chosen=None, path=None):
    return lambda: analysis.run(chosen or stages(), path)


def mine(first, other):
    return first if FIRST else other


def strained():
    with warnings.catch_warnings():
        if FIRST:
            warnings.simplefilter("error", LargeStrainWarning)
        hard = structure(stiffness=1e3)
        Analysis(hard).run([Stage("load", [PointLoad(6, (0, 0, 3e3))])])


def full_disk():
    path = FOLDER / "full"
    analysis.run(stages()[:1], path)
    COMM.Barrier()
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size, before[1]))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", CheckpointWarning)
            analysis.run(stages(), path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def seen_by_the_first():
    """Use a different folder on each process."""
    path = FOLDER / str(COMM.rank) / "state"
    Analysis(structure()).run(stages()[:2], path)
    again = Analysis(structure())
    calls = interrupted.counted(again)
    assert list(again.run(stages(), path)) == [stage.name for stage in stages()]
    assert len(calls) == 2
    assert path.exists() == FIRST


def fabric(cells, prestress=1e3):
    return Membrane(cells, Fabric(Et=500e3, nu=0.3), prestress=prestress)


def broken(_):
    raise RuntimeError("the words of one")


def from_mesh(make=fabric, name="fabric", supports=None):
    return lambda: structure_from_dolfinx(square, {name: square}, {name: make}, supports)


def derivative(*change):
    return lambda: view.derivative(x, *change)


def spread(total):
    """Vector with the rows of the problem, but a node more on the first process, one less on the last."""
    own = x.getLocalSize() + {0: 3, COMM.size - 1: -3}.get(COMM.rank, 0)
    return PETSc.Vec().createMPI((own, total), comm=COMM)


problem = Problem(structure())
view, x = problem.under(), problem.create_vector()
square = create_unit_square(COMM, 2, 2)
state = FOLDER / "state"
other_points = POINTS.copy()
other_points[6, 2] += 1e-9

CASES = {
    "checkpoint that cannot be written": run(path="/proc/fx/state"),
    "checkpoint on a full disk, warnings as errors": full_disk,
    "checkpoint of another structure": lambda: Analysis(structure(prestress=1.0)).run(stages(), state),
    "checkpoint that one process sees": seen_by_the_first,
    "picture that cannot be written": lambda: plot.convergence(lift, "/proc/fx/picture.png"),
    "picture of nothing": lambda: plot.wireframe(POINTS, {"a": [[0, 1]]}, FOLDER / "no" / "picture.xyz"),
    "warning as error": strained,
    "other loads": run(mine(stages(), stages(snow=-201.0))),
    "other increments": run(mine(stages(), stages(increments=4))),
    "fewer stages": run(mine(stages(), stages()[:2])),
    "other order": run(mine(stages(), [stages()[i] for i in (0, 2, 1)])),
    "other points": lambda: Analysis(mine(structure(), structure(points=other_points))),
    "other number of points": lambda: Analysis(mine(structure(), structure(points=[*POINTS, [9, 9, 9]]))),
    "other solver": lambda: Analysis(structure(), mine(Newton(), Newton(rtol=1e-9))),
    "other method": lambda: Analysis(structure(), mine(Newton(), ConjugateGradient())),
    "no solver on one": lambda: Analysis(structure(), mine(Newton(), "Newton")),
    "no stages on one": run(mine(stages(), ["snow"])),
    "stage that does not fit on one": run(mine(stages(), [Stage("snow", [DistributedLoad((0, 0, 1), "roof")])])),
    "no count on one": lambda: stability(lift, mine(1, 0)),
    "other count": lambda: stability(lift, mine(1, 2)),
    "other state": lambda: stability(mine(lift, results["snow"])),
    "no state on one": lambda: natural_frequencies(mine(lift, None)),
    "path without end on one": lambda: equilibrium_path(lift, pull, rtol=mine(1e-10, -1)),
    "other path": lambda: equilibrium_path(lift, pull, load_factor=mine(1.0, 2.0)),
    "other start of a path": lambda: equilibrium_path(mine(lift, structure()), mine(pull, Stage("pull", pull.loads))),
    "other form": lambda: updated_reference(structure(prestress=mine(1e3, 2e3))),
    "other tolerance of a form": lambda: updated_reference(structure(), tolerance=mine(1e-3, 1e-2)),
    "stage of actions that does not fit on one": lambda: problem.actions_of(
        mine(pull, Stage("pull", [DistributedLoad((0, 0, 1), "roof")]))
    ),
    "other stage of actions": lambda: problem.actions_of(mine(pull, Stage("pull"))),
    "other start of actions": lambda: problem.actions_of(pull, mine(None, lift.actions)),
    "no parameter on one": derivative("fabric", mine("Et", "Gt")),
    "no part on one": derivative(mine("fabric", "roof"), "prestress"),
    "no direction on one": derivative("fabric", "Et", mine(1.0, "text")),
    "other parameter": derivative("fabric", mine("Et", "nu")),
    "other direction": derivative("fabric", "Et", mine(1.0, 2.0)),
    "no start of a load factor on one": lambda: view.load_derivative(x, mine(None, 3)),
    "other start of a load factor": lambda: view.load_derivative(x, mine(None, lift.actions)),
    "no values on one": lambda: problem.to_petsc(mine(np.zeros_like(POINTS), None)),
    "other values": lambda: problem.to_petsc(mine(np.zeros_like(POINTS), POINTS)),
    "no elasticity on one": lambda: Problem(structure(), elastic=mine(True, "no")),
    "other elasticity": lambda: Problem(structure(), elastic=mine(True, False)),
    "other rows": lambda: view.residual(spread(x.getSize())),
    "part of a mesh that fails on one": from_mesh(mine(fabric, broken)),
    "other part of a mesh": from_mesh(mine(fabric, lambda cells: fabric(cells, 2e3))),
    "other name of a part of a mesh": from_mesh(name=mine("fabric", "roof")),
    "other support of a mesh": from_mesh(supports={"fabric": mine("xyz", "z")}),
}

analysis.run(stages()[:1], state)
for case, act in CASES.items():
    try:
        act()
        ended = "done"
    except Exception as error:
        ended = f"{type(error).__name__}: {error}"
    for line in filter(None, [COMM.gather(ended)]):
        print("CASE", repr((case, line)), flush=True)
