"""Structures whose first equilibrium is hard to find, and the cost of finding it.

    PYTHONPATH=tests .venv/bin/python tests/benchmarks/hard_cases.py [part of a name]

Flat and curved, prestress from none to large, loads up to a hundred times everyday ones; slack cables, wrinkles, coarse
meshes and one of 1e5 unknowns. Each is solved twice: by the textbook's Newton method with full steps, and by that of
this package. For both the table gives: success, the unbalanced force over the largest nodal force, load increments
(more than stages if halved) and iterations. With all rejected attempts it gives factorizations, assemblies (of residual
or tangent; each residual comes with an energy) and time [s]. For the second it adds iterations with a shifted tangent
or a shortened step, and increments begun with the homotopy.

Cheaper linear solves were measured and left out. Factors without shift that are kept while the residual falls tenfold
solve all of the 72 quickest cases. They take 7 % fewer factorizations, 6 % more iterations and 7 % more time. With 1e5
unknowns they save 20 % of the time for the square of `assembly.py` under load, 9 % or nothing here. The price is the
last quadratic step: displacements have an error of 1e-9 instead of rounding, and with that step in full the saving
falls from 20 to 7 %. Conjugate gradients preconditioned by the old factors, to tolerances after Eisenstat and Walker,
save a third of the factorizations. Back-substitutions are four times as many: 13 % more time in twelve cases, from 7 %
less to 3 % more with 1e5 unknowns.

A trust region in place of line search and inertia correction takes 22 % more factorizations: `hard_cases.md`.
"""

import sys
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc

from fx_membrane import (
    Analysis,
    ConvergenceError,
    LargeStrainWarning,
    Newton,
    Outcome,
    Stage,
)
from fx_membrane.assembly.problem_under_actions import LoadedProblem
from hard_structures import (
    FABRIC,
    WOVEN,
    Case,
    cable_net,
    cone,
    cushion,
    hanging,
    hypar,
    poked,
    pulled,
    service,
    sheet,
    slack_roof,
    tent,
)

SNOW = 1e3  # [N/m2]
WAYS = Newton(line_search=False), Newton()

assemblies: Counter[str] = Counter()


def cases() -> Iterator[tuple[str, Callable[[], Case]]]:
    """Names and makers of all cases."""
    yield from flat()
    yield from curved()
    yield from cables_clamps_masts()


def flat() -> Iterator[tuple[str, Callable[[], Case]]]:
    """Sheets and cushions."""
    for prestress in (0.0, 1.0, 1e3, 2e4):
        for times in (1, 10, 100):
            yield f"sheet, prestress {prestress:g}, snow x {times}", lambda p=prestress, t=times: sheet(p, t * SNOW)
    for times in (1, 100):
        yield f"woven sheet, unstressed, snow x {times}", lambda t=times: sheet(0.0, t * SNOW, fabric=WOVEN)
    for n in (32, 182):
        yield f"sheet, prestress 1000, snow, {n} x {n}", lambda n=n: sheet(1e3, SNOW, n)
        yield f"sheet, unstressed, snow, {n} x {n}", lambda n=n: sheet(0.0, SNOW, n)
    for prestress in (0.0, 1e3):
        for force in (1e2, 1e4):
            yield f"sheet, prestress {prestress:g}, point load {force:g}", lambda p=prestress, f=force: poked(p, f)
        for times in (1, 10, 100):
            name = f"cushion, prestress {prestress:g}, pressure x {times}"
            yield name, lambda p=prestress, t=times: cushion(p, t * SNOW / 5)
    yield "cushion, unstressed, 48 x 48", lambda: cushion(0.0, SNOW, 48)


def curved() -> Iterator[tuple[str, Callable[[], Case]]]:
    """Sails and cones."""
    for rise in (0.0, 0.3, 1.5):
        for prestress, force in ((0.0, 1e3), (2e3, 2e4), (2e3, 4e4), (1e4, 5e3)):
            for times in (1, 10):
                name = f"hypar, rise {rise:g}, {prestress:g} N/m, {force:g} N, service x {times}"
                yield name, lambda r=rise, p=prestress, f=force, t=times: hypar(p, f, r, service(0.3 * t * SNOW))
    yield "hypar, rise 2, soft edges, 32 x 32", lambda: hypar(2e3, 1e4, 2.0, [Stage("prestress")], 32)
    yield "hypar, rise 1.5, 48 x 48", lambda: hypar(2e3, 2e4, 1.5, service(0.3 * SNOW), 48)
    for prestress in (0.0, 1e3):
        for lift in (0.5, 2.0):
            yield f"cone, prestress {prestress:g}, lift {lift:g}", lambda p=prestress, h=lift: cone(p, h, SNOW)


def cables_clamps_masts() -> Iterator[tuple[str, Callable[[], Case]]]:
    """Nets, slack cables, clamped sheets, tents."""
    for prestress in (0.0, 1e3):
        for load in (1e2, 1e4):
            yield f"cable net, prestress {prestress:g}, load {load:g}", lambda p=prestress, q=load: cable_net(p, q)
    for sag in (0.0, 0.5, 2.0):
        for load in (1.0, 1e3):
            yield f"hanging cable, waves of {sag:g}, weight {load:g}", lambda s=sag, q=load: hanging(s, q)
    for move in (0.05, 0.2):
        yield f"slack roof, let in by {move:g}, its own weight", lambda m=move: slack_roof(m, 10.0)
    for fabric, name in ((FABRIC, "sheet"), (WOVEN, "woven sheet")):
        yield f"{name}, sheared", lambda f=fabric: pulled(0.01, 0.0, 0.15, f)
        yield f"{name}, sheared and shortened", lambda f=fabric: pulled(-0.02, 0.0, 0.3, f)
        yield f"{name}, twisted out of its plane", lambda f=fabric: pulled(-0.1, 0.6, 0.0, f)
    for times in (1, 10):
        yield f"tent on masts, service x {times}", lambda t=times: tent(2e4, 1e3, 0.3 * t * SNOW)
        yield f"tent on masts, slack guys, service x {times}", lambda t=times: tent(1e2, 1e3, 0.3 * t * SNOW)


def factorizations() -> int:
    """Count of numeric factorizations since the start."""
    events = ("MatCholFctrNum", "MatLUFactorNum")
    return int(sum(PETSc.Log.Event(name).getPerfInfo()["count"] for name in events))


def count_assemblies() -> None:
    """Make the problem note each residual and each tangent in `assemblies`."""

    def counted(assemble: Callable[..., PETSc.Object]) -> Callable[..., PETSc.Object]:
        def call(*args: Any) -> PETSc.Object:
            assemblies[assemble.__name__] += 1
            return assemble(*args)

        return call

    for name in ("residual", "tangent"):
        setattr(LoadedProblem, name, counted(getattr(LoadedProblem, name)))


def measure(make: Callable[[], Case], solver: Newton) -> str:
    """Solve a case by one solver; return its part of a line of the table."""
    structure, stages = make()
    start, before, assembled = perf_counter(), factorizations(), assemblies.total()
    words = ""
    try:
        states = list(Analysis(structure, solver).run(stages).values())
    except ConvergenceError as failure:
        states = [*failure.results.values(), failure.last]
        words = f"\n    {failure}"
    time = perf_counter() - start
    increments = [increment for state in states for increment in state.increments]
    steps = [entry for increment in increments for entry in increment.iterations[1:]]
    largest = max((np.abs(state.reactions).max() + np.abs(state.loads).max() for state in states), default=0.0)
    error = max(state.equilibrium.residual for state in states) / max(largest, 1e-300)
    counts = (len(increments), len(steps), factorizations() - before, assemblies.total() - assembled)
    line = f"{'NO' if words else 'yes':>7}{error:9.0e}{''.join(f'{count:6}' for count in counts)}{time:8.2f}"
    if solver.line_search:
        tense, short = sum(step.shift > 0 for step in steps), sum(step.step < 1 for step in steps)
        line += f"{tense:6}{short:6}{sum(increment.outcome is Outcome.STABILIZED for increment in increments):6}"
    return line + " (unstable)" * any(increment.outcome is Outcome.UNSTABLE for increment in increments) + words


def main() -> None:
    """Print the table."""
    chosen = [(name, make) for name, make in cases() if len(sys.argv) == 1 or any(w in name for w in sys.argv[1:])]
    if not chosen:
        families = dict.fromkeys(name.partition(",")[0] for name, _ in cases())
        sys.exit(f"No case has {' or '.join(map(repr, sys.argv[1:]))} in its name; there are: {'; '.join(families)}.")
    PETSc.Log.begin()
    count_assemblies()
    warnings.simplefilter("ignore", LargeStrainWarning)  # a hundred times the snow is intended to strain
    titles = f"{'found':>7}{'balance':>9}{'incr':>6}{'iter':>6}{'fact':>6}{'asm':>6}{'time':>8}"
    print(f"{'':50}{'     full steps':48}{'     line search, inertia correction'}")
    print(f"{'case':50}{titles}{titles}{'tense':>6}{'short':>6}{'homot':>6}")
    for name, make in chosen:
        full, searched = (measure(make, way) for way in WAYS)
        print(f"{name:50}{full.partition(chr(10))[0]}{searched}", flush=True)


if __name__ == "__main__":
    main()
