"""Phases of a whole run on a flat square of triangles under a distributed load: CPU time, memory, and two bounds.

    .venv/bin/python tests/benchmarks/assembly.py [cells along a side]


One core (OMP_NUM_THREADS=1). CPU seconds belong to the innermost phase, as does the largest resident memory, imports
aside. Bounds of the tangent: one STREAM-like pass, c = a + b, over as many numbers as its non-zeros, and one product
with a vector.
"""

import os
import re
import resource
import sys
from collections import Counter, defaultdict
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
started = process_time()


import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

from fx_membrane import (  # noqa: E402
    Analysis,
    DistributedLoad,
    Fabric,
    Membrane,
    Stage,
    StageResults,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)
from fx_membrane.assembly.problem import Problem  # noqa: E402

WORK = "factorization and solve"
# Functions that are timed, as module and qualified name, and their phase; those that a version lacks are left out.
PHASES = {
    "fx_membrane.model.structure:Structure.__init__": "structure and its checks",
    "fx_membrane.analysis.stages:Analysis._check": "structure and its checks",
    "fx_membrane.assembly.discretization:Discretization.__init__": "numbering",
    "fx_membrane._dolfinx:create_mesh": "meshes",
    "fx_membrane._dolfinx:_compile": "compilation, or its cache",
    "fx_membrane.assembly.discretization:Discretization.create_matrix": "preallocation",
    "fx_membrane.assembly.discretization:Discretization.scatter": "scatter",
    "fx_membrane.assembly.discretization:Discretization.scatter_add": "scatter",
    "fx_membrane.assembly.assembler:Assembler.matrix": "tangent",
    "fx_membrane.assembly.assembler:Assembler.vector": "residual",
    "fx_membrane.assembly.assembler:Assembler.strain_energy": "energy",
    "fx_membrane.assembly.held_components:Constraints.constrain_tangent": "constraints of the tangent",
    "dolfinx.fem:assemble_vector": "residual",
    "dolfinx.fem:pack_coefficients": "packing of coefficients",
    "dolfinx.fem.assemble:_pack_coefficients": "packing of coefficients",
    "dolfinx.fem.petsc:_pack_coefficients": "packing of coefficients",
    "fx_membrane.assembly.discretization:Discretization.to_numpy": "gather",
    "fx_membrane.assembly.discretization:Discretization.gather_cells": "gather",
    "fx_membrane.results.evaluation:StateEvaluator.__call__": "evaluation of results",
    "fx_membrane.analysis.stages:remarked": "remarks on results",
}
NUMERIC, SYMBOLIC, SOLVE = "MatCholFctrNum", "MatCholFctrSym", "MatSolve"


def peak() -> float:
    """Largest resident memory [kB] since the last call, on Linux; since the start elsewhere, on macOS in bytes."""
    status = Path("/proc/self/status")
    if not status.exists():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    found = float(re.findall(r"VmHWM:\s+(\d+)", status.read_text())[0])
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")
    return found


class Clock:
    """CPU time and largest memory by phase, and the number of calls."""

    def __init__(self) -> None:
        self.times, self.calls = defaultdict[str, float](float), Counter[str]()
        self.peaks = defaultdict[str, float](float)
        self._phases, self._last = ["other"], process_time()

    def enter(self, phase: str) -> None:
        """Begin a phase within the present one."""
        self._count()
        self.calls[phase] += 1
        self._phases.append(phase)

    def leave(self) -> None:
        """End the present phase."""
        self._count()
        self._phases.pop()

    def _count(self) -> None:
        now = process_time()
        phase = self._phases[-1]
        self.times[phase] += now - self._last
        self.peaks[phase] = max(self.peaks[phase], peak())
        self._last = process_time()

    def timed(self, function: Callable[..., Any], phase: str) -> Callable[..., Any]:
        """Wrap a function that belongs to a phase."""

        def run(*args: Any, **kwargs: Any) -> Any:
            self.enter(phase)
            try:
                return function(*args, **kwargs)
            finally:
                self.leave()

        return run


def instrument(clock: Clock) -> None:
    """Time the functions of `PHASES`; between tangent and step of Newton's iteration PETSc factorizes and solves."""
    for place, phase in PHASES.items():
        module, _, path = place.partition(":")
        *classes, name = path.split(".")
        owner: Any = import_module(module)
        for entry in classes:
            owner = getattr(owner, entry)
        if hasattr(owner, name):
            setattr(owner, name, clock.timed(getattr(owner, name), phase))
    newton: Any = import_module("fx_membrane.solvers.newton_loop").NewtonLoop
    tangent, step = newton.tangent, newton.step

    def then_solve(self: Any, *args: Any) -> None:
        tangent(self, *args)
        clock.enter(WORK)

    def after_solve(self: Any, *args: Any) -> None:
        clock.leave()
        step(self, *args)

    newton.tangent, newton.step = then_solve, after_solve


def run(n: int) -> tuple[Structure, StageResults]:
    """Run one stage from the flat start."""
    points, triangles = rectangle(1.0, 1.0, n, n)
    fabric = Membrane(triangles, Fabric(1e5, 0.3), prestress=1e3)
    structure = Structure(points, {"fabric": fabric}, [Support(np.unique(boundary_edges(triangles)))])
    stage = Stage("load", [DistributedLoad((0, 0, -500.0), "fabric")])
    return structure, Analysis(structure, progress=False).run([stage])


def print_phases(clock: Clock, empty: float, unknowns: int) -> None:
    """Print CPU seconds, share, calls and memory of each phase, and the share outside assembly and linear solver."""
    total = sum(clock.times.values())
    for phase, time in sorted(clock.times.items(), key=lambda item: -item[1]):
        memory = 1.024 * (clock.peaks[phase] - empty) / unknowns
        print(f"{phase:32}{time:9.3f} s{100 * time / total:7.1f} %{clock.calls[phase]:6}{memory:9.2f} kB per unknown")
    events = {name: PETSc.Log.Event(name).getPerfInfo()["time"] for name in (SYMBOLIC, NUMERIC, SOLVE)}
    spent = sum(events.values())
    print(f"{'whole':32}{total:9.3f} s")
    print("factorization and solve, shares: " + ", ".join(f"{k} {100 * t / spent:.0f} %" for k, t in events.items()))
    outside = 1 - (clock.times["tangent"] + clock.times[WORK]) / total
    print(f"outside tangent, factorization and solve: {100 * outside:.1f} % of the whole")


def least(action: Callable[[], object], repeat: int = 5) -> float:
    """Least CPU time of an action [s]."""
    times = []
    for _ in range(repeat):
        start = process_time()
        action()
        times.append(process_time() - start)
    return min(times)


def print_bounds(structure: Structure) -> None:
    """Print the time of a tangent beside one pass over its non-zeros and one product."""
    problem = Problem(structure)
    view, x, b = problem.under(), problem.create_vector(), problem.create_vector()
    tangents = {kind: problem.discretization.create_matrix(kind) for kind in ("aij", "baij", "sbaij")}
    nonzeros = int(tangents["aij"].getInfo()["nz_allocated"])
    first, second = np.ones(nonzeros), np.ones(nonzeros)
    total = np.zeros(nonzeros)
    once = least(lambda: np.add(first, second, out=total))
    triangles = sum(len(part.cells) for part in structure.parts.values())
    for name, A in tangents.items():
        tangent, product = least(partial(view.tangent, x, A)), least(partial(A.mult, x, b))
        print(
            f"tangent in {name}: {tangent:.3f} s, {1e6 * tangent / triangles:.3f} us per triangle; "
            f"{tangent / once:.1f} passes over its non-zeros, {tangent / product:.1f} products"
        )


def main(n: int) -> None:
    """Print the tables."""
    PETSc.Log.begin()
    empty = peak()
    imports = process_time() - started
    clock = Clock()
    instrument(clock)
    structure, results = run(n)
    clock.enter("end")
    clock.leave()
    del clock.times["end"]
    unknowns = structure.points.size
    iterations = len(results["load"].history) - 1
    cells = sum(len(part.cells) for part in structure.parts.values())
    print(f"{cells} triangles, {unknowns} unknowns, {iterations} iterations, imports {imports:.2f} s")
    print_phases(clock, empty, unknowns)
    largest = 1.024 * (max(clock.peaks.values()) - empty) / unknowns
    print(f"peak memory: {largest:.2f} kB per unknown, imports ({empty / 1e3:.0f} MB) aside")
    print_bounds(structure)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 512)
