"""Generated plans of tents for form finding: corners, edges, high points, rings and valley cables, meshed by gmsh.

A constant stress diag(w, f) in plan is the isotropic stress sqrt(w f) of a plan that is stretched by x = A y with
A = diag((w / f)^(1/4), (f / w)^(1/4)): force densities are the same in both. So a plan y with edges along arcs, of
radius force over stress, becomes one whose edges balance the stress given. Its rings become ellipses.
"""

from dataclasses import dataclass
from typing import Any

import gmsh
import numpy as np
from numpy.typing import NDArray

from fx_membrane import Cable, Mast, Membrane, OrthotropicFabric, Structure, Support

Array = NDArray[Any]
WOVEN = OrthotropicFabric(Et_warp=9e5, Et_weft=6e5, nu=0.3, Gt=3e4)
RATIOS = (1.0, 1.5, 2.0, 3.0, 4.0)
FLAWS = {1: "weak edges", 6: "high ring"}  # of the plans with these numbers modulo 8
SIZE = 1.0  # length of edges [m]; a third of it at rings


@dataclass
class Tent:
    """Plan of a tent, with its prestress as stress in plan and horizontal force.

    Attributes:
        structure: The mesh in plan, with held nodes in space.
        words: Its features, for the table.
        flaw: Reason for which no form is expected; empty without one.
    """

    structure: Structure
    words: str
    flaw: str


@dataclass
class Ring:
    """Held ring: centre in plan, radius and height [m]."""

    centre: Array
    radius: float
    height: float


def tent(number: int) -> Tent:
    """Generate a plan; the same for the same number."""
    random = np.random.default_rng(number)
    corners, count, ratio = 3 + number % 6, int(random.integers(0, 4)), RATIOS[number % 5]
    flaw = FLAWS.get(number % 8, "")
    count = max(count, 1) if flaw == "high ring" else count
    stress = 1e3 * random.uniform(0.5, 1.5)  # isotropic, in the plan of the arcs
    angle = 2 * np.pi * (np.arange(corners) + random.uniform(-0.15, 0.15, corners)) / corners
    rim = random.uniform(7, 9, corners)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    heights = random.uniform(0, 1.5, corners)
    high = random.permutation(corners)[: int(random.integers(1, 3)) if count == 0 else 0]
    heights[high] = random.uniform(3, 5, len(high))
    cabled = flaw == "weak edges" or random.random() < 0.7
    radii = _radii(rim, random.uniform(0.3, 0.75)) if cabled else np.full(corners, np.inf)
    middles = _middles(rim, radii)
    rings = _rings(random, count, 0.85 * float(np.linalg.norm(middles, axis=1).min()), flaw)
    valleys = count > 0 and bool(random.random() < 0.5)
    points, groups = _mesh(rim, radii, middles, rings, valleys)

    held = [groups["corners"]]
    parts: dict[str, Membrane | Cable | Mast] = {}
    points[groups["corners"], 2] = heights
    stretch = np.array([ratio**0.25, ratio**-0.25, 1.0])
    for k in range(corners):
        segments = groups[f"edge {k}"]
        if cabled:
            force = stress * radii[k] * (0.25 if flaw == "weak edges" else 1)
            parts[f"edge {k}"] = Cable(segments, 2e7, force * _stretch(points, segments, stretch))
            continue
        nodes = np.setdiff1d(segments, groups["corners"])
        chord = np.roll(rim, -1, axis=0)[k] - rim[k]
        share = (points[nodes, :2] - rim[k]) @ chord / (chord @ chord)
        points[nodes, 2] = heights[k] + share * (np.roll(heights, -1)[k] - heights[k])
        held.append(nodes)
    for k, ring in enumerate(rings):
        points[groups[f"ring {k}"], 2] = ring.height
        held.append(np.unique(groups[f"ring {k}"]))
        if valleys:
            segments = groups[f"valley {k}"]
            force = stress * random.uniform(2, 5)
            parts[f"valley {k}"] = Cable(segments, 2e7, force * _stretch(points, segments, stretch))
    warp, weft = stress * np.sqrt(ratio), stress / np.sqrt(ratio)
    parts = {"film": Membrane(groups["film"], WOVEN, warp if ratio == 1 else (warp, weft), (1, 0, 0)), **parts}
    words = f"{corners} corners, {'cables' if cabled else 'held edges'}, {count} rings, {len(high)} high corners, "
    words += f"{count * valleys} valleys, {ratio:g}:1"
    return Tent(Structure(points * stretch, parts, [Support(np.concatenate(held))]), words, flaw)


def _stretch(points: Array, segments: Array, stretch: Array) -> Array:
    """Length of segments in the stretched plan over that in the plan of arcs."""
    way = np.diff(points[segments, :2], axis=1)[:, 0]
    return np.asarray(np.linalg.norm(way * stretch[:2], axis=1) / np.linalg.norm(way, axis=1))


def _radii(rim: Array, share: float) -> Array:
    """Radii of arcs that turn from their chords by a share of half the smaller angle at their corners."""
    back, forth = np.roll(rim, 1, axis=0) - rim, np.roll(rim, -1, axis=0) - rim
    cosine = np.sum(back * forth, axis=1) / np.linalg.norm(back, axis=1) / np.linalg.norm(forth, axis=1)
    corner = np.arccos(cosine)
    turn = share * np.minimum(np.minimum(corner, np.roll(corner, -1)) / 2, 1.2)
    return np.asarray(np.linalg.norm(forth, axis=1) / 2 / np.sin(turn))


def _middles(rim: Array, radii: Array) -> Array:
    """Middles of the edges, on arcs that bow inwards."""
    chord = np.roll(rim, -1, axis=0) - rim
    half, r = np.linalg.norm(chord, axis=1) / 2, np.where(np.isfinite(radii), radii, 1e9)
    sag = half**2 / (r + np.sqrt(r**2 - half**2))
    return np.asarray(rim + chord / 2 - (sag / half / 2)[:, None] * np.stack([chord[:, 1], -chord[:, 0]], axis=1))


def _rings(random: np.random.Generator, count: int, room: float, flaw: str) -> list[Ring]:
    """Rings within a circle of a radius."""
    start, found = random.uniform(0, 2 * np.pi), []
    for k in range(count):
        turn, away = start + 2 * np.pi * k / count, 0.0 if count == 1 else 0.5 * room
        height = room * (random.uniform(0.2, 0.4) if flaw != "high ring" else 4.0)
        centre = away * np.array([np.cos(turn), np.sin(turn)])
        found.append(Ring(centre, room * random.uniform(0.12, 0.2), height))
    return found


def _mesh(rim: Array, radii: Array, middles: Array, rings: list[Ring], valleys: bool) -> tuple[Array, dict[str, Array]]:
    """Points of a mesh in plan, shape (n, 3), and its triangles, segments and nodes by name."""
    gmsh.initialize(["", "-v", "0"])
    try:
        geo = gmsh.model.geo
        corners = [geo.addPoint(x, y, 0, SIZE) for x, y in rim]
        lines: dict[str, list[int]] = {}
        for k, (x, y) in enumerate(middles):
            a, middle, b = corners[k], geo.addPoint(x, y, 0, SIZE), corners[(k + 1) % len(corners)]
            chord = rim[(k + 1) % len(rim)] - rim[k]
            away = min(radii[k], 1e3) * np.array([chord[1], -chord[0]]) / np.linalg.norm(chord)
            centre = geo.addPoint(x + away[0], y + away[1], 0)
            straight = not np.isfinite(radii[k])
            pairs = ((a, middle), (middle, b))
            lines[f"edge {k}"] = [geo.addLine(i, j) if straight else geo.addCircleArc(i, centre, j) for i, j in pairs]
        loops, inside = [geo.addCurveLoop([tag for pair in lines.values() for tag in pair])], []
        for k, ring in enumerate(rings):
            near = int(np.argmin(np.linalg.norm(rim - ring.centre, axis=1)))
            aim = rim[near] - ring.centre
            turns = np.arctan2(aim[1], aim[0]) + np.arange(4) * np.pi / 2
            on = [ring.centre + ring.radius * np.array([np.cos(turn), np.sin(turn)]) for turn in turns]
            tags, centre = [geo.addPoint(x, y, 0, SIZE / 3) for x, y in on], geo.addPoint(*ring.centre, 0)
            lines[f"ring {k}"] = [geo.addCircleArc(tags[i], centre, tags[(i + 1) % 4]) for i in range(4)]
            loops.append(geo.addCurveLoop(lines[f"ring {k}"]))
            if valleys:
                lines[f"valley {k}"] = [geo.addLine(tags[0], corners[near])]
                inside += lines[f"valley {k}"]
        surface = geo.addPlaneSurface(loops)
        geo.synchronize()
        gmsh.model.mesh.embed(1, inside, 2, surface)
        gmsh.model.mesh.generate(2)
        return _arrays(lines, corners)
    finally:
        gmsh.finalize()


def _arrays(lines: dict[str, list[int]], corners: list[int]) -> tuple[Array, dict[str, Array]]:
    """Points and cells of the mesh of gmsh, without the nodes that no triangle has."""
    mesh = gmsh.model.mesh
    tags, coordinates, _ = mesh.getNodes()
    film = np.asarray(mesh.getElementsByType(2)[1], dtype=np.int64).reshape(-1, 3)
    used = np.unique(film)
    number, place = np.full(int(max(tags)) + 1, -1), np.zeros((int(max(tags)) + 1, 3))
    number[used], place[tags] = np.arange(len(used)), np.reshape(coordinates, (-1, 3))
    groups = {"film": number[film], "corners": number[[int(mesh.getNodes(0, tag)[0][0]) for tag in corners]]}
    for name, curves in lines.items():
        segments = [np.asarray(mesh.getElementsByType(1, curve)[1], dtype=np.int64) for curve in curves]
        groups[name] = number[np.concatenate(segments).reshape(-1, 2)]
    return place[used], groups
