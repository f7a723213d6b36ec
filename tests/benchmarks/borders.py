"""Cost of borders of the tangent: those of gas in two chambers, of water and of a rope, against solves without them.

    .venv/bin/python tests/benchmarks/borders.py [cells along a side]

One core (OMP_NUM_THREADS=1), the least of several CPU times. Each scalar costs one more solve with the factorization
that is there, and a few products of vectors.
"""

import os
import sys
from collections.abc import Callable
from time import process_time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from petsc4py import PETSc

from fx_membrane import (
    Ambient,
    Analysis,
    Chamber,
    Fabric,
    GasAmount,
    Membrane,
    Pond,
    Rope,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.solvers import factorization
from fx_membrane.solvers.bordered_system import BorderedSystem

REPEATS = 5
AIR = 101_325.0


def cushion(n: int) -> tuple[Structure, Stage]:
    """Cushion of three films, a rope in a pocket across the top; gas in both chambers, and water on the top."""
    flat, cells = rectangle(2.0, 2.0, n, n)
    rim = np.unique(boundary_edges(cells))
    inner = np.setdiff1d(np.arange(len(flat)), rim)
    points, films = [flat], {"low": cells}
    for name in ("wall", "top"):
        twin = np.arange(len(flat))
        twin[inner] = sum(map(len, points)) + np.arange(len(inner))
        points.append(flat[inner])
        films[name] = twin[cells]
    place = np.vstack(points)
    height = np.zeros(len(place))
    height[np.unique(films["low"])], height[np.unique(films["top"])] = -0.2, 0.2
    place[:, 2] = height * (1 - place[:, 0] ** 2) * (1 - place[:, 1] ** 2)
    top = np.unique(films["top"])
    across = top[np.isclose(place[top, 1], 0)]
    parts: dict[str, Any] = {name: Membrane(film, Fabric(1e5, 0.3), 50.0) for name, film in films.items()}
    parts["pocket"] = Rope(across[np.argsort(place[across, 0])], 1e5, prestress=100.0)
    chambers = {"upper": Chamber({"top": 1, "wall": -1}), "lower": Chamber({"wall": 1, "low": -1})}
    amounts = [GasAmount(AIR + 300.0, 0.4, name) for name in chambers]
    stage = Stage("wet", [Pond("top", volume=1e-3, walls=rim)], changes=[Ambient(AIR), *amounts])
    return Structure(place, parts, [Support(rim)], chambers=chambers), stage


def least(work: Callable[[], Any]) -> float:
    """Least CPU time of several calls [s]."""
    times = []
    for _ in range(REPEATS):
        start = process_time()
        work()
        times.append(process_time() - start)
    return min(times)


def main(n: int) -> None:
    """Print the costs of a step with and without its borders."""
    structure, stage = cushion(n)
    problem = Analysis(structure, progress=False).problem
    loaded = problem.under(problem.actions_of(stage))
    x = problem.create_vector()
    A, b, dx = problem.discretization.create_matrix("sbaij"), loaded.residual(x), problem.create_vector()
    loaded.tangent(x, A)
    loaded.constraints.constrain_tangent(x, A, b)
    ksp = PETSc.KSP().create(problem.comm)
    factorization.choose(ksp, A, symmetric=True)

    def factorize() -> None:
        A.assemble()
        ksp.getPC().setReusePreconditioner(False)
        A.setValue(0, 0, 0.0, addv=True)  # another state of the matrix, with the same values
        A.assemble()
        ksp.setOperators(A)
        ksp.setUp()

    factorize()
    bordered = BorderedSystem(loaded.borders(x, one_sided=True))
    scalars = len(bordered.borders.vectors)

    times = {
        "factorization": least(factorize),
        "solve": least(lambda: ksp.solve(b, dx)),
        "borders made": least(lambda: loaded.borders(x, one_sided=True).free()),
        "borders solved for": least(lambda: bordered.factor(ksp)),
        "solution corrected": least(lambda: bordered.correct(dx)),
    }
    print(f"{3 * len(structure.points)} components, {scalars} scalars")
    for name, time in times.items():
        print(f"{name:20s} {1e3 * time:9.2f} ms, {time / times['solve']:6.2f} solves")
    extra = (times["borders solved for"] + times["solution corrected"]) / scalars
    print(f"linear algebra for each scalar: {extra / times['solve']:.2f} solves")
    bordered.free()


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 64)
