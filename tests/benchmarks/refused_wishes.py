"""Wishes that have no form, on a canopy of usual size: the reason that is told, and the time that it takes.

    .venv/bin/python tests/benchmarks/refused_wishes.py [part of a name]

The canopy: 12 x 12 m, four low corners held, edge cables, a ring of radius 0.6 m at a height; 2048 triangles. For each
reason the table gives steps, processor time [s], and the words of the warning. It gives the displacement of the shape
handed over when it is analysed, over its size. These are defects, and the exit status is 1 then: more than a minute of
processor time, a shape that moves by more than 1e-12, words without the reason.
"""

import os
import re
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from time import process_time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from fx_membrane import (
    Analysis,
    Cable,
    Membrane,
    OrthotropicFabric,
    Pressure,
    RadialDirection,
    RigidBody,
    Ring,
    Stage,
    Structure,
    Support,
    UnsettledFormWarning,
    prescribed_stress,
)

LIMIT, STILL = 60.0, 1e-12
WOVEN = OrthotropicFabric(Et_warp=8e5, Et_weft=5e5, nu=0.2, Gt=2e4)
Case = tuple[Structure, dict[str, Any], str]


def canopy(
    force: float, stress: tuple[float, float] = (3e3, 2e3), height: float = 5.0, n: int = 8, held: bool = True
) -> Structure:
    """Ring over four corners, with edges drawn as arcs."""
    around, rows = 8 * n, 2 * n
    angle = np.arange(around) * 2 * np.pi / around + np.pi / 4
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    base = 6 * circle / np.abs(circle).max(axis=1, keepdims=True)
    along = np.abs(base).min(axis=1, keepdims=True) / 6
    base *= np.where(np.isclose(np.abs(base), 6), 1 - 0.12 * (1 - along**2), 1)
    shares = np.linspace(0, 1, rows + 1)
    places = [np.column_stack([(1 - s) * 0.6 * circle + s * base, np.full(around, height * (1 - s))]) for s in shares]
    i, j = (index.ravel() for index in np.mgrid[:rows, :around])
    p, q = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([p, q, q + around], axis=1), np.stack([p, q + around, p + around], axis=1)])
    rim = np.arange(rows * around, (rows + 1) * around)
    parts = {
        "film": Membrane(triangles, WOVEN, stress, warp=(1, 0, 0)),
        "edge": Cable(np.stack([rim, np.roll(rim, -1)], axis=1), 2e7, force),
    }
    corners = Support(rim[:: 2 * n])
    return Structure(np.concatenate(places), parts, [Support(range(around)), corners] if held else [corners])


def tube(height: float, n: int = 16) -> Structure:
    """Two held rings of radius 3 and 4, far from each other."""
    around = 4 * n
    angle = np.arange(around) * 2 * np.pi / around
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    shares = np.linspace(0, 1, n + 1)
    points = np.concatenate([np.column_stack([(3 + s) * circle, np.full(around, height * (1 - s))]) for s in shares])
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    p, q = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([p, q, q + around], axis=1), np.stack([p, q + around, p + around], axis=1)])
    film = Membrane(triangles, WOVEN, (3e3, 2e3), warp=(1, 0, 0))
    return Structure(points, {"film": film}, [Support([*range(around), *range(n * around, (n + 1) * around)])])


def cases() -> Iterator[tuple[str, Callable[[], Case]]]:
    """Names and makers of all cases, each with the pattern of its reason."""
    weak = "edge cables are too weak: .*needs? more than"
    radial: dict[str, Any] = {"warp": {"film": RadialDirection()}}
    ring = np.arange(64)
    yield "edges of 4 kN", lambda: (canopy(4e3), radial, weak)
    yield "edges of 15 kN, as first asked", lambda: (canopy(15e3), radial, weak)
    yield "edges of 15 kN, 4 : 1", lambda: (canopy(15e3, (4e3, 1e3)), radial, weak)
    yield "ring at 9 m, equal stress", lambda: (canopy(40e3, (2e3, 2e3), 9.0), radial, "ring is too far from its base")
    yield "ring at 9 m", lambda: (canopy(40e3, (3e3, 2e3), 9.0), radial, "ring is too far from its base")
    yield "rings at 9 m", lambda: (tube(9.0), radial, "ring is too far from its base")
    yield "uplift of 20 kN/m2", lambda: (canopy(40e3), {**radial, "loads": [Pressure(20e3, "film")]}, "loads are too")
    yield (
        "free ring without a radius",
        lambda: (
            canopy(40e3, held=False),
            {**radial, "constraints": [Ring(ring)]},
            "Ring with node 0 .* nothing within it holds",
        ),
    )
    yield (
        "rigid ring without a mast",
        lambda: (
            canopy(40e3, held=False),
            {**radial, "constraints": [RigidBody(ring)]},
            "",
        ),
    )


def measured(make: Callable[[], Case]) -> tuple[str, str]:
    """Line of the table, and the defect; empty without one."""
    structure, given, pattern = make()
    loads: Sequence[Any] = given.get("loads", ())
    start = process_time()
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        form = prescribed_stress(structure, **given)
    seconds = process_time() - start
    words = " ".join(str(one.message) for one in told if issubclass(one.category, UnsettledFormWarning))
    state = Analysis(form.structure).run([Stage("form", loads)])["form"]
    moved = float(np.abs(state.displacement).max() / np.ptp(form.points))
    line = f"{len(form.steps):5d}{seconds:8.1f}{moved:9.0e}  {'found' if form.converged else words}"
    if seconds > LIMIT:
        return line, f"longer than {LIMIT:g} s"
    if moved > STILL:
        return line, "the form moves"
    if not re.search(pattern, words) or (pattern == "") != form.converged:
        return line, "the reason is not told"
    return line, ""


def main() -> None:
    """Print the table."""
    print(f"{'':34}{'steps':>5}{'CPU s':>8}{'moved':>9}")
    defects = 0
    for name, make in cases():
        if len(sys.argv) == 1 or any(word in name for word in sys.argv[1:]):
            line, defect = measured(make)
            defects += bool(defect)
            print(f"{name:34}{line}{f'  DEFECT: {defect}' if defect else ''}", flush=True)
    sys.exit(1 if defects else 0)


if __name__ == "__main__":
    main()
