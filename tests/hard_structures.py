"""Structures whose first equilibrium is hard to find, with their stages."""

import numpy as np

from fx_membrane import (
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    OrthotropicFabric,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    force_density,
    rectangle,
)

Case = tuple[Structure, list[Stage]]
FABRIC = Fabric(Et=500e3, nu=0.3)
WOVEN = OrthotropicFabric(Et_warp=800e3, Et_weft=500e3, nu=0.3, Gt=20e3)


def path(nodes: np.ndarray) -> np.ndarray:
    """Segments between consecutive nodes."""
    return np.column_stack([nodes[:-1], nodes[1:]])


def sheet(prestress: float, load: float, n: int = 8, fabric: Fabric | OrthotropicFabric = FABRIC) -> Case:
    """Flat, 6 m by 6 m, held all around."""
    points, triangles = rectangle(6.0, 6.0, n, n)
    parts = {"fabric": Membrane(triangles, fabric, prestress=prestress, warp=(1, 0, 0))}
    supports = [Support(np.unique(boundary_edges(triangles)))]
    return Structure(points, parts, supports), [Stage("snow", [PlanLoad((0, 0, -load), "fabric")])]


def poked(prestress: float, force: float, n: int = 8) -> Case:
    """Flat sheet under a point load."""
    structure, _ = sheet(prestress, 0.0, n)
    return structure, [Stage("point load", [PointLoad(len(structure.points) // 2, (0, 0, -force))])]


def cushion(prestress: float, pressure: float, n: int = 8) -> Case:
    """Flat sheet, blown up."""
    structure, _ = sheet(prestress, 0.0, n)
    return structure, [Stage("inflation", [Pressure(pressure, "fabric")])]


def hypar(prestress: float, force: float, rise: float, stages: list[Stage], n: int = 12) -> Case:
    """Sail of 8 m by 6 m between four corners, two of them high, with straight edge cables: far from its form."""
    points, triangles = rectangle(8.0, 6.0, n, n)
    x, y = points[:, 0] / 4, points[:, 1] / 3
    points = np.column_stack([points[:, :2], rise * (x * y)])
    corners = np.flatnonzero((np.abs(np.abs(x) - 1) < 1e-9) & (np.abs(np.abs(y) - 1) < 1e-9))
    parts = {
        "fabric": Membrane(triangles, FABRIC, prestress=prestress),
        "edge cables": Cable(boundary_edges(triangles), axial_stiffness=12e6, prestress=force),
    }
    return Structure(points, parts, [Support(corners)]), stages


def cone(prestress: float, lift: float, load: float, n: int = 16) -> Case:
    """Flat ring between two rings, the inner one pulled up, then snow."""
    angles, radii = np.meshgrid(np.linspace(0, 2 * np.pi, 2 * n, endpoint=False), np.linspace(0.5, 4, n // 2 + 1))
    points = np.column_stack([(radii * np.cos(angles)).ravel(), (radii * np.sin(angles)).ravel(), np.zeros(radii.size)])
    node = np.arange(radii.size).reshape(radii.shape)
    a, b = node[:-1], node[1:]
    c, d = np.roll(b, -1, axis=1), np.roll(a, -1, axis=1)
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ([a, b, c], [a, c, d])])
    fabric = {"fabric": Membrane(triangles, FABRIC, prestress=prestress)}
    supports = [Support(node[0]), Support(node[-1])]
    up = Stage("pulling up", displacements=[PrescribedDisplacement(node[0], (0, 0, lift), "z")])
    return Structure(points, fabric, [supports[1], Support(node[0], "xy")]), [
        up,
        Stage("snow", [PlanLoad((0, 0, -load), "fabric")], after="pulling up"),
    ]


def cable_net(prestress: float, load: float, n: int = 8) -> Case:
    """Flat net of cables, held around, with a point load on each node."""
    points, _ = rectangle(6.0, 6.0, n, n)
    grid = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    lines = np.concatenate([path(row) for row in [*grid[1:-1], *grid.T[1:-1]]])
    inner = grid[1:-1, 1:-1].ravel()
    edge = np.setdiff1d(lines, inner)
    structure = Structure(points, {"net": Cable(lines, 5e6, prestress)}, [Support(edge)])
    return structure, [Stage("loads", [PointLoad(inner, (0, 0, -load))])]


def hanging(sag: float, load: float, n: int = 20) -> Case:
    """Cable without prestress under its weight: straight, or longer than its span and folded."""
    x = np.linspace(0, 10, n + 1)
    points = np.column_stack([x, 0 * x, sag * np.sin(np.pi * x / 10 * 4)])
    structure = Structure(points, {"cable": Cable(path(np.arange(n + 1)), 1e6)}, [Support([0, n])])
    return structure, [Stage("weight", [DistributedLoad((0, 0, -load), "cable")])]


def pulled(along: float, across: float, shear: float, fabric: Fabric | OrthotropicFabric, n: int = 12) -> Case:
    """Flat sheet of 2 m by 1 m between two clamps that are moved: shear and slackness."""
    points, triangles = rectangle(2.0, 1.0, 2 * n, n)
    low, high = (np.flatnonzero(np.abs(points[:, 0] - x) < 1e-9) for x in (-1.0, 1.0))
    parts = {"fabric": Membrane(triangles, fabric, prestress=10.0, warp=(1, 1, 0))}
    moved = PrescribedDisplacement(high, (along, shear, across))
    return Structure(points, parts, [Support(low)]), [Stage("pull", displacements=[moved])]


def tent(force: float, fabric_prestress: float, load: float, n: int = 12) -> Case:
    """Square sail with two masts that stand on hinges, held by guys."""
    structure, _ = hypar(fabric_prestress, force, 1.2, [], n)
    corners = structure.supports[0].nodes
    high = corners[structure.points[corners, 2] > 0]
    low = np.setdiff1d(corners, high)
    out = structure.points[high] * [1.6, 1.6, 0] - [0, 0, 2.0]
    feet = structure.points[high] * [1.1, 1.1, 0] - [0, 0, 2.0]
    first = len(structure.points)
    side = np.cross(structure.points[high] * [1, 1, 0], [0, 0, 0.3])
    points = np.vstack([structure.points, feet, out + side, out - side])
    guys = np.concatenate(
        [np.column_stack([high, first + 2 + np.arange(2)]), np.column_stack([high, first + 4 + np.arange(2)])]
    )
    parts = {
        **structure.parts,
        "guys": Cable(guys, 12e6, prestress=force),
        "masts": Mast(np.column_stack([first + np.arange(2), high]), 200e6),
    }
    supports = [Support(low), Support(np.arange(first, len(points)))]
    snow = Stage("snow", [PlanLoad((0, 0, -load), "fabric")], after="prestress")
    wind = Stage("wind", [Pressure(load, "fabric")], after="prestress")
    return Structure(points, parts, supports), [Stage("prestress"), snow, wind]


def slack_roof(move: float, load: float, n: int = 8) -> Case:
    """Roof of 8 m by 8 m between two high and two low corners, its low ones moved in and up: slack all over."""
    plan, triangles = rectangle(8.0, 8.0, n, n)
    node = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    low, high = [node[0, -1], node[-1, 0]], [node[0, 0], node[-1, -1]]
    plan[high, 2] = 2.0
    inner = np.vstack([path(line) for line in (*node[1:-1], *node.T[1:-1])])
    rim = np.vstack([path(line) for line in (node[0], node[-1], node[:, 0], node[:, -1])])
    densities = np.repeat([1.0, 10.0], [len(inner), len(rim)])
    form = force_density(plan, np.vstack([inner, rim]), densities, [Support(low + high)])
    parts = {
        "fabric": Membrane(triangles, FABRIC, prestress=10.0),
        "cables": Cable(rim, axial_stiffness=12e6, prestress=100.0),
    }
    let_in = [PrescribedDisplacement(corner, -move * np.sign(plan[corner] - (0, 0, 1))) for corner in low]
    weight = DistributedLoad((0, 0, -load), "fabric")
    return Structure(form.points, parts, [Support(high)]), [Stage("weight", [weight], let_in)]


def service(load: float) -> list[Stage]:
    """Prestress, then snow, wind suction and a point load."""
    return [
        Stage("prestress"),
        Stage("snow", [PlanLoad((0, 0, -load), "fabric")], after="prestress"),
        Stage("wind", [Pressure(load, "fabric")], after="prestress"),
    ]
