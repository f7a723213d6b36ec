"""Strips with the same shape, which are cut alike: symmetric halves and repeated fields."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.sizes import measures
from ..surfaces.nearest_points import nearest
from ..surfaces.shapes import Surface
from ..surfaces.transfer import rise_of_surface
from .strips import Edge, Strips, check_strips

Array = NDArray[np.float64]

SAMPLES = 16  # places along each edge that are compared
ALIKE_DISTANCE = 1e-4  # difference of places over the length of a strip up to which strips are alike
STRESS = 0.01  # difference of prestress over the larger up to which it is alike


class _Outline(NamedTuple):
    """Outline of a strip, counter-clockwise.

    Attributes:
        places: Places along each edge, the first its corner, shape (edges, samples, 3) [m].
        back: The same from the other end of each edge, whose first is the other corner.
        kinds: Seam or border, free or with a line part, held or not, of each edge.
    """

    places: Array
    back: Array
    kinds: list[tuple[bool, bool, bool]]


def with_copies(strips: Strips, tolerance: float | None = None) -> Strips:
    """Find strips with the shape of an earlier one, turned or mirrored in space; they are cut alike.

    Copies have equal edges with their kinds, equal surfaces and laws, and equal prestress to 1 % of its largest value.
    Mirrored copies have their outline the other way round: the pattern, or the cloth, is turned over to cut them.

    Args:
        strips: The strips.
        tolerance: Largest difference of places that counts as none [m]; by default 1e-4 of the length of the strip.
            Within strips it is more by default, by as much as their cells lie below the curved surface: strips of one
            shape may have different cells, as after `cut_strips(size=...)`.

    Returns:
        The same strips with their `copies` and `mirrored`.

    Raises:
        ValueError: The tolerance is not positive.

    Example:
        >>> points, triangles = rectangle(6.0, 4.0, 12, 8)
        >>> roof = Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3)})
        >>> seams = [geodesic(roof, (-3, y, 0), (3, y, 0)) for y in (-1, 0, 1)]
        >>> with_copies(cut_strips(roof, seams)).copies
        {'strip 3': 'strip 2', 'strip 4': 'strip 1'}
    """
    check_strips("with_copies", strips)
    given = None if tolerance is None else validation.positive("tolerance", tolerance)
    outlines = {name: _outline(strips, name) for name in strips.names}
    copies: dict[str, str] = {}
    mirrored: set[str] = set()
    first: list[str] = []
    for name in strips.names:
        for other in first:
            sense = _sense(strips, outlines[other], outlines[name], other, name, given)
            if sense:
                copies[name] = other
                mirrored |= {name} if sense < 0 else set()
                break
        else:
            first.append(name)
    return replace(strips, copies=copies, mirrored=frozenset(mirrored))


def _outline(strips: Strips, name: str) -> _Outline | None:
    """Outline of a strip; None of one that meets itself, as an opened tube."""
    following: dict[int, tuple[Edge, NDArray[np.int64]]] = {}
    edges = strips.edges_of(name)
    for edge in edges:
        nodes = edge.nodes if edge.strips[0] == name else edge.nodes[::-1]
        if int(nodes[0]) in following or edge.strips == (name, name):
            return None
        following[int(nodes[0])] = edge, nodes
    at = next(iter(following))
    places, back, kinds = [], [], []
    for _ in edges:
        if at not in following:
            return None
        edge, nodes = following[at]
        places.append(_sampled(strips.structure.points[nodes]))
        back.append(_sampled(strips.structure.points[nodes[::-1]]))
        kinds.append((edge.is_seam, edge.line is None, edge.held))
        at = int(nodes[-1])
    return _Outline(np.array(places), np.array(back), kinds)


def _sampled(line: Array) -> Array:
    """Places at equal steps along a line, the last left out, shape (samples, 3) [m]."""
    run = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1)))
    at = np.arange(SAMPLES) / SAMPLES * run[-1]
    return np.stack([np.interp(at, run, column) for column in line.T], axis=1)


def _sense(
    strips: Strips, one: _Outline | None, two: _Outline | None, first: str, second: str, tolerance: float | None
) -> int:
    """Return 1 if the second strip is the first one moved, -1 if its outline runs the other way, 0 if they differ."""
    a, b = strips.membrane(first), strips.membrane(second)
    if one is None or two is None or len(one.kinds) != len(two.kinds) or a.material != b.material:
        return 0
    size = float(np.linalg.norm(np.ptp(one.places.reshape(-1, 3), axis=0)))
    least = ALIKE_DISTANCE * size if tolerance is None else tolerance
    count = len(one.kinds)
    for sense in (1, -1):
        places = two.places if sense > 0 else two.back[::-1]
        kinds = two.kinds if sense > 0 else two.kinds[::-1]
        for shift in range(count):
            if kinds[shift:] + kinds[:shift] != one.kinds:
                continue
            move = _motion(one.places.reshape(-1, 3), np.roll(places, -shift, axis=0).reshape(-1, 3), least)
            rise = 0.0 if tolerance is not None or move is None else _rise(strips, second)
            if move is not None and _same_cloth(strips, first, second, move, (least, least + rise), sense):
                return sense
    return 0


def _motion(start: Array, end: Array, tolerance: float) -> tuple[Array, Array, Array] | None:
    """Turn or reflection between two sets of places, with their middles; None where they differ.

    Source:
        P. H. Schönemann, A generalized solution of the orthogonal Procrustes problem, Psychometrika 31 (1966) 1-10.
    """
    before, after = start.mean(axis=0), end.mean(axis=0)
    u, _, v = np.linalg.svd((start - before).T @ (end - after))
    turn = u @ v
    apart = np.linalg.norm((start - before) @ turn - (end - after), axis=1).max()
    return (turn, before, after) if apart <= tolerance else None


def _rise(strips: Strips, name: str) -> float:
    """Largest height of the curved surface of a strip above the middles of its cells [m]."""
    used, local = np.unique(strips.membrane(name).cells, return_inverse=True)
    triangles = local.reshape(-1, 3)
    middles = np.full((len(triangles), 3), 1 / 3)
    rise = rise_of_surface(strips.structure.points[used], triangles, np.arange(len(triangles)), middles)
    return float(np.linalg.norm(rise, axis=1).max())


def _same_cloth(
    strips: Strips,
    first: str,
    second: str,
    move: tuple[Array, Array, Array],
    tolerances: tuple[float, float],
    sense: int,
) -> bool:
    """Compare the surfaces and the prestress of two strips, with tolerances of places on borders and within."""
    tolerance, within = tolerances
    points = strips.structure.points
    a, b = strips.membrane(first), strips.membrane(second)
    areas = [measures(points, part.cells).sum() for part in (a, b)]
    size = float(np.sqrt(areas[0]))
    if abs(areas[0] - areas[1]) > 4 * tolerance * size:
        return False
    turn, before, after = move
    surface = Surface(points, b.cells)
    nodes = points[np.unique(a.cells)]
    if nearest(surface, (nodes - before) @ turn + after)[2].max() > within:
        return False
    centres = points[a.cells].mean(axis=1)
    cells = nearest(surface, (centres - before) @ turn + after)[0]
    mirror = np.diag([1.0, float(sense)])
    mine, other = a.prestress_tensors(), mirror @ b.prestress_tensors()[cells] @ mirror
    return bool(np.abs(mine - other).max() <= STRESS * max(np.abs(mine).max(), np.finfo(float).tiny))
