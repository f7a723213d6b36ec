"""Times of the main steps on a square of 256 x 256 x 2 triangles, beside dolfinx alone on the same mesh and form.

    .venv/bin/python tests/benchmarks/assembly.py [cells along a side]

Each time is the minimum of five. The bound is the bare `assemble_matrix` of dolfinx into a matrix of its own.
"""

import sys
from collections.abc import Callable
from time import perf_counter

import numpy as np
from dolfinx.fem import petsc as fem_petsc

from fx_membrane import (
    Analysis,
    DistributedLoad,
    Fabric,
    Membrane,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.assembly.problem import Problem


def least(action: Callable[[], object], repeat: int = 5) -> float:
    """Shortest time of an action [s]."""
    times = []
    for _ in range(repeat):
        start = perf_counter()
        action()
        times.append(perf_counter() - start)
    return min(times)


def bare_assembly(form: object) -> Callable[[], None]:
    """dolfinx alone: its matrix, its numbering."""
    A = fem_petsc.assemble_matrix(form)
    A.assemble()

    def run() -> None:
        A.zeroEntries()
        fem_petsc.assemble_matrix(A, form)
        A.assemble()

    return run


def main(n: int) -> None:
    """Print the table."""
    points, triangles = rectangle(1.0, 1.0, n, n)
    fabric = Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3)
    structure = Structure(points, {"fabric": fabric}, [Support(np.unique(boundary_edges(triangles)))])
    rows = [("meshes, numbering, forms", least(lambda: Problem(structure), 1))]
    owner = Problem(structure)
    problem = owner.under()
    x, b = problem.discretization.create_vector(), problem.discretization.create_vector()
    A = problem.discretization.create_matrix()
    problem.tangent(x, A)
    tangent = least(lambda: problem.tangent(x, A))
    bare = least(bare_assembly(owner.parts["fabric"].tangent))
    rows += [
        ("energy", least(lambda: problem.energy(x))),
        ("residual", least(lambda: problem.residual(x, b))),
        ("tangent", tangent),
        ("bare dolfinx assemble_matrix", bare),
    ]
    analysis = Analysis(structure)
    stage = Stage("load", [DistributedLoad((0, 0, -500.0), "fabric")])
    count = 0

    def solve() -> None:
        nonlocal count
        count = len(analysis.run([stage])["load"].history) - 1

    rows.append(("one stage, Newton with MUMPS", least(solve, 1)))
    print(f"{len(triangles)} triangles, {3 * len(points)} unknowns")
    for name, time in rows:
        print(f"{name:32}{time:10.4f} s")
    print(f"tangent / bare: {tangent / bare:.2f};  Newton iterations: {count}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 256)
