"""Methods for a stress wished for, warp unlike weft, side by side: how near they come, and whether they settle.


    .venv/bin/python tests/benchmarks/wishes.py


Mean and largest are relative differences of stress and wish in the form, the mean over the area; the wish is taken
where the cell now is. Drift is the relative change of area in the last tenth of the steps; aspect the largest over
the usual one. Nearest: `prescribed_stress`, least squares over stress and shape. Balanced: the wish corrected in each
shape so that it balances within the surface, then natural force densities; its first shapes. Natural: natural force
densities with the warp carried in space. Updated: the updated reference strategy, stress and warp with the cells.
"""

import os
import warnings
from collections.abc import Callable
from time import process_time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np

from fx_membrane import (
    Cable,
    Form,
    Membrane,
    OrthotropicFabric,
    RadialDirection,
    Structure,
    Support,
    boundary_edges,
    natural_force_density,
    prescribed_stress,
    rectangle,
    updated_reference,
)
from fx_membrane.form_finding.form import relative_difference
from fx_membrane.form_finding.nearest_stress.start import near_state
from fx_membrane.form_finding.nearest_stress.state import NearestProblem
from fx_membrane.form_finding.wishes import wishes_of
from fx_membrane.geometry.sizes import aspects, measures, normals, projected
from fx_membrane.solvers.progress import Pulse

WOVEN = OrthotropicFabric(Et_warp=6e5, Et_weft=6e5, nu=0.4, Gt=3e4)
Case = tuple[Structure, Any]


def round_robin(n: int = 10) -> Case:
    """Round robin, Ex. 1: square base, ring of diameter 4 at height 5, radial 4 and circumferential 2 kN/m."""
    around = 4 * n
    angle = (np.arange(around) + 0.5) * 2 * np.pi / around
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    base = 7 * circle / np.abs(circle).max(axis=1, keepdims=True)
    shares = np.linspace(0, 1, n + 1)
    rows = [np.column_stack([(1 - s) * 2 * circle + s * base, np.full(around, 5 * (1 - s))]) for s in shares]
    points = np.concatenate(rows)
    i, j = (index.ravel() for index in np.mgrid[:n, :around])
    p, q = i * around + j, i * around + (j + 1) % around
    triangles = np.concatenate([np.stack([p, q, q + around], axis=1), np.stack([p, q + around, p + around], axis=1)])
    held = Support([*range(around), *range(n * around, (n + 1) * around)])
    film = Membrane(triangles, WOVEN, (4e3, 2e3), warp=RadialDirection()(points[triangles].mean(axis=1).T))
    return Structure(points, {"film": film}, [held]), RadialDirection()


def canopy(n: int = 12) -> Case:
    """Four corners, two of them high, edge cables, 3 : 2."""
    points, triangles = rectangle(8.0, 8.0, n, n)
    corners = np.flatnonzero(np.abs(points[:, 0] * points[:, 1]) == 16)
    points[corners, 2] = 1.5 * np.sign(points[corners, 0] * points[corners, 1])
    parts = {
        "film": Membrane(triangles, WOVEN, (3e3, 2e3), warp=(1, 0, 0)),
        "edge": Cable(boundary_edges(triangles), 2e7, 25e3),
    }
    return Structure(points, parts, [Support(corners)]), None


def balanced(structure: Structure, warp: Any) -> Form:
    """First shapes of `prescribed_stress` alone."""
    problem = NearestProblem(structure, (), wishes_of(structure, None, warp))
    return problem.form(near_state(problem, Pulse("", False)), (), True, ())


METHODS: dict[str, Callable[[Structure, Any], Form]] = {
    "nearest": lambda s, warp: prescribed_stress(s, warp=warp),
    "balanced": balanced,
    "natural, 5 steps": lambda s, warp: natural_force_density(s, iterations=5),
    "natural, 50 steps": lambda s, warp: natural_force_density(s, iterations=50),
    "updated, 30 steps": lambda s, warp: updated_reference(s, max_iterations=30, tolerance=1e-9),
    "updated, 300 steps": lambda s, warp: updated_reference(s, max_iterations=300, tolerance=1e-9),
}


def line(structure: Structure, direction: Any, method: Callable[[Structure, Any], Form]) -> str:
    """Numbers of a method."""
    began = process_time()
    try:
        form = method(structure, {"film": direction} if direction else None)
    except RuntimeError as error:
        return str(error).partition(":")[0]
    seconds = process_time() - began
    film, points = structure.parts["film"], form.points
    normal, areas = normals(points, film.cells), measures(points, film.cells)
    centres = points[film.cells].mean(axis=1).T
    given = direction(centres) if direction else np.broadcast_to(film.warp, normal.shape)
    warp, found = projected(given, normal), form.structure.warp("film")
    turn = np.stack([np.sum(warp * found, axis=1), np.sum(np.cross(found, warp) * normal, axis=1)])
    frame = np.stack([turn, np.stack([-turn[1], turn[0]])]).transpose(2, 1, 0)
    stress = frame.swapaxes(1, 2) @ form.forces["film"] @ frame
    wish = np.broadcast_to(np.diag(film.prestress), stress.shape)
    root = np.diag(1 / np.sqrt(film.prestress))
    squares = np.sum((root @ stress @ root - np.eye(2)) ** 2, axis=(1, 2))
    largest = relative_difference(stress, wish).max()
    history = [step.area for step in form.steps] or [np.nan]
    drift = abs(history[-1] / history[-max(2, len(history) // 10) if len(history) > 1 else -1] - 1)
    shape = aspects(points, film.cells)
    return (
        f"{areas.sum():9.3f} {100 * np.sqrt(areas @ squares / areas.sum()):8.1f} {100 * largest:9.1f} {drift:9.1e} "
        f"{shape.max() / np.median(shape):8.1f} {len(form.steps):6d} {seconds:7.1f}"
    )


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    print(f"{'':32s}  area m2   mean % largest %     drift   aspect  steps   CPU s")
    for name, (structure, direction) in {"round robin": round_robin(), "canopy": canopy()}.items():
        for method, function in METHODS.items():
            print(f"{name:12s}{method:19s}", line(structure, direction, function), flush=True)


if __name__ == "__main__":
    main()
