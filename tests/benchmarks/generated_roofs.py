"""Twenty generated roofs with seams for cutting patterns: tents, cones, saddles, vaults, tubes and balloons."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tent_plans import tent  # type: ignore[import-not-found]

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    Structure,
    Support,
    SurfaceLine,
    boundary_edges,
    geodesic,
    planar_cut,
    projected_stress,
    rectangle,
    seams_between,
    stress_trajectories,
    warp_lines,
)

Array = NDArray[Any]
FABRIC, STRESS = Fabric(5e5, 0.3), 2e3


@dataclass
class Roof:
    """Shape with its seams, a size of cells for another mesh of its strips [m], and pressure within [Pa]."""

    words: str
    structure: Structure
    seams: list[SurfaceLine | str]
    size: float
    pressure: float = 0.0


def surface(points: Array, cells: Array, **parts: Any) -> Structure:
    """Structure of one membrane with its rim held."""
    return Structure(
        points, {"roof": Membrane(cells, FABRIC, STRESS), **parts}, [Support(np.unique(boundary_edges(cells)))]
    )


def found(structure: Structure) -> Structure:
    """Shape in equilibrium with the prestress as stress in plan."""
    return projected_stress(structure).structure


def grid(nx: int, ny: int, place: Callable[[Array, Array], Array], closed: bool = False) -> tuple[Array, Array, Array]:
    """Points, cells and node numbers of a grid over the unit square, bent in space, and closed along x or not."""
    flat, cells = rectangle(1.0, 1.0, nx, ny, diagonals="right")
    u, v = flat[:, 0] + 0.5, flat[:, 1] + 0.5
    number = np.arange((nx + 1) * (ny + 1)).reshape(ny + 1, nx + 1)
    points = place(u, v)
    if not closed:
        return points, cells, number
    same = np.arange(len(points))
    same[number[:, -1]] = number[:, 0]
    used, rows = np.unique(same, return_inverse=True)
    return points[used], rows[cells], rows[number][:, :-1]


def cone(around: int, along: int, turn: float = 0.0) -> tuple[Structure, Array]:
    """Catenoid-like cone between a base of radius 7 and a ring of radius 2."""

    def place(u: Array, v: Array) -> Array:
        r = 2 + 5 * (1 - v) ** 1.5
        return np.stack([r * np.cos(2 * np.pi * u + turn), r * np.sin(2 * np.pi * u + turn), 5 * v], axis=1)

    points, cells, node = grid(around, along, place, closed=True)
    ring = np.column_stack([node[-1], np.roll(node[-1], -1)])
    return found(surface(points, cells, ring=Cable(ring, 1e7, 1e4))), node


def gores(around: int, count: int) -> Roof:
    """Cone with a ring, of gores."""
    roof, node = cone(around, around // 3)
    return Roof(f"cone, {count} gores", roof, [*seams_between(roof, node[0], "ring", count)], 0.8)


def saddle(kind: str) -> Roof:
    """Hyperbolic paraboloid over a rhomb or a rectangle."""
    skew = 0.0 if kind == "rectangle" else 0.5

    def place(u: Array, v: Array) -> Array:
        x, y = 10 * u - 5 + skew * (8 * v - 4), 8 * v - 4
        return np.stack([x, y, (u - 0.5) * (v - 0.5) * 8], axis=1)

    points, cells, node = grid(21, 16, place)
    roof = found(surface(points, cells))
    return Roof(f"saddle over a {kind}", roof, [*seams_between(roof, node[:, 0], node[:, -1], roll_width=2.2)], 0.7)


def vault() -> Roof:
    """Barrel vault, cut across its axis by planes that miss the nodes."""

    def place(u: Array, v: Array) -> Array:
        return np.stack([12 * u, 4 * np.cos(np.pi * v), 4 * np.sin(np.pi * v)], axis=1)

    roof = surface(*grid(25, 20, place)[:2])
    seams = [line for x in (2.3, 4.7, 7.1, 9.4) for line in planar_cut(roof, (x, 0, 0), (1, 0, 0))]
    return Roof("barrel vault, planar cuts", roof, seams, 0.7, -STRESS / 4)


def crossed_vault() -> Roof:
    """Barrel vault with seams that cross."""
    base = vault()
    along = planar_cut(base.structure, (0, 0.31, 0), (0.02, 1, 0))
    return Roof("barrel vault, crossing seams", base.structure, [*base.seams, *along], 0.7, base.pressure)


def arch_tube() -> Roof:
    """Half a torus, opened by seams along it and cut across."""

    def place(u: Array, v: Array) -> Array:
        r = 8 + 1.5 * np.cos(2 * np.pi * u)
        return np.stack([r * np.cos(np.pi * v), 1.5 * np.sin(2 * np.pi * u), r * np.sin(np.pi * v)], axis=1)

    points, cells, _ = grid(18, 40, place, closed=True)
    x, _, z = points[cells].mean(axis=1).T
    along = np.column_stack([-z, 0 * x, x])
    fabric = Membrane(cells, FABRIC, (STRESS / 2, STRESS), warp=along)
    roof = Structure(points, {"roof": fabric}, [Support(np.unique(boundary_edges(cells)))])
    across = [planar_cut(roof, (0, 0, 0), (np.sin(a), 0, -np.cos(a)))[0] for a in np.radians([33.0, 61.0, 92.0, 140.0])]
    lengthwise = [line for y in (-0.8, 0.02, 0.8) for line in planar_cut(roof, (0, y, 0), (0, 1, 0))]
    return Roof("arch tube", roof, [*lengthwise, *across], 0.7, STRESS / 1.5)


def dome(count: int) -> Roof:
    """Hemisphere of gores that meet at a node."""

    def place(u: Array, v: Array) -> Array:
        a, b = 2 * np.pi * u, np.pi / 2 * 0.999 * v
        return 6 * np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)], axis=1)

    points, cells, node = grid(26, 9, place, closed=True)
    keep = ~np.isin(cells, node[-1]).any(axis=1)
    apex = len(points)
    cap = np.column_stack([node[-2], np.roll(node[-2], -1), np.full(len(node[-2]), apex)])
    cells = np.concatenate([cells[keep], cap])
    roof = surface(np.vstack([points, [0, 0, 6.0]]), cells)
    return Roof(f"dome of {count} gores", roof, [*seams_between(roof, node[0], [apex], count)], 1.0, 2 * STRESS / 6)


def balloon() -> Roof:
    """Balloon, a closed sphere, in lunes between planes through the poles."""

    def place(u: Array, v: Array) -> Array:
        a, b = 2 * np.pi * u, np.pi * (v - 0.5)
        return 5 * np.stack([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)], axis=1)

    points, cells, node = grid(22, 14, place, closed=True)
    same = np.arange(len(points))
    same[node[0]], same[node[-1]] = node[0, 0], node[-1, 0]
    cells = same[cells]
    cells = cells[(np.sort(cells, axis=1)[:, 1:] != np.sort(cells, axis=1)[:, :-1]).all(axis=1)]
    used, rows = np.unique(cells, return_inverse=True)
    equator = rows.reshape(-1)[np.flatnonzero(cells == node[7, 0])[0]]
    held = [Support([0]), Support([len(used) - 1], "xy"), Support([equator], "y")]
    roof = Structure(points[used], {"roof": Membrane(rows.reshape(-1, 3), FABRIC, STRESS)}, held)
    seams = [planar_cut(roof, (0, 0, 0), (np.cos(a), np.sin(a), 0))[0] for a in np.arange(6) * np.pi / 6 + 0.1]
    return Roof("balloon of 12 gores", roof, seams, 1.2, 2 * STRESS / 5)


def plan_roof(number: int) -> Roof:
    """Tent of a generated plan: gores from a ring to the rim, or sections through all rings."""
    case = tent(number)
    roof = found(case.structure)
    cells = np.asarray(roof.parts["film"].cells)
    loops = _loops(cells)
    words, normal = f"plan {number}: {case.words}", np.array([0.31, 1.0, 0.0])
    if len(loops) == 2:
        outer, inner = loops
        seams: list[Any] = seams_between(roof, outer, inner, 9, "film")
    else:
        middles = [roof.points[loop].mean(axis=0) for loop in loops[1:]] or [roof.points.mean(axis=0)]
        heights = np.sort([middle @ normal for middle in middles])
        ends = np.sort(roof.points @ normal)[[0, -1]]
        more = [h for h in np.arange(ends[0] + 1.7, ends[1] - 1, 2.3) if np.abs(heights - h).min() > 1.0]
        seams = [line for h in [*heights, *more] for line in planar_cut(roof, normal * h / (normal @ normal), normal)]
    return Roof(words, roof, seams, 0.9)


def _loops(cells: Array) -> list[Array]:
    """Nodes of the loops of the rim, the longest first."""
    left = {int(a): int(b) for a, b in boundary_edges(cells)}
    found = []
    while left:
        loop = [next(iter(left))]
        while loop[-1] in left:
            loop.append(left.pop(loop[-1]))
        found.append(np.array(loop[:-1]))
    return sorted(found, key=len, reverse=True)


def stressed() -> Roof:
    """Saddle with seams along principal stress, warp and a geodesic."""

    def place(u: Array, v: Array) -> Array:
        return np.stack([8 * u - 4, 6 * v - 3, 1.5 * (u - 0.5) ** 2 - (v - 0.5) ** 2], axis=1)

    points, cells, _ = grid(19, 14, place)
    part = Membrane(cells, FABRIC, (3e3, 1e3), warp=(1, 0.1, 0))
    roof = found(Structure(points, {"roof": part}, [Support(np.unique(boundary_edges(cells)))]))
    points = roof.points
    starts = [points[np.linalg.norm(points[:, :2] - [0.2, y], axis=1).argmin()] for y in (-1.4, 0.1)]
    lines = stress_trajectories(roof, starts=starts[:1]) + warp_lines(roof, starts[1:])
    west = points[np.linalg.norm(points[:, :2] - [-4, 1.4], axis=1).argmin()]
    east = points[np.linalg.norm(points[:, :2] - [4, 2.0], axis=1).argmin()]
    return Roof("saddle, lines of stress and warp", roof, [*lines, geodesic(roof, west, east)], 0.7)


ROOFS: list[Callable[[], Roof]] = [
    *(lambda n=n, count=count: gores(n, count) for n, count in ((24, 8), (25, 12), (40, 16))),
    *(lambda kind=kind: saddle(kind) for kind in ("rectangle", "rhomb")),
    vault, crossed_vault, arch_tube, balloon, stressed,
    *(lambda count=count: dome(count) for count in (7, 12)),
    *(lambda n=n: plan_roof(n) for n in (0, 2, 3, 4, 7, 8, 10, 12)),
]  # fmt: skip
