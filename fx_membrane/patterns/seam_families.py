"""Families of seams: geodesics between equal shares of two borders."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..form_finding.form import Form
from ..geometry.line_order import path_along
from ..geometry.topology import boundary_edges, with_one_sense
from ..model.structure import Structure
from ..surfaces.geodesics import flipped
from ..surfaces.nearest_points import nearest
from ..surfaces.shapes import Surface, surface_of
from ..surfaces.surface_lines import SurfaceLine
from .cutting import cut_strips
from .roll_widths import strip_widths
from .split_mesh import SplitMesh

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Border = str | int | ArrayLike

NODE = 1e-9  # distance from a node over the length of an edge, below which a seam ends at the node
MAX_POSITIONS = 360  # positions of a closed border that are tried against the other one
MAX_STRIPS = 500  # strips by roll width


class _Line(NamedTuple):
    """Border: its nodes in order, and their places; an apex has one node, a ring ends with its first node."""

    nodes: Integers
    places: Array

    @property
    def closed(self) -> bool:
        """True of a ring."""
        return len(self.nodes) > 2 and self.nodes[0] == self.nodes[-1]

    @property
    def runs(self) -> Array:
        """Length from the start to each node [m]."""
        return np.append(0.0, np.cumsum(np.linalg.norm(np.diff(self.places, axis=0), axis=1)))

    def at(self, shares: Array) -> Array:
        """Places at shares of the length, shape (k, 3) [m]."""
        runs = self.runs
        return np.stack([np.interp(shares * runs[-1], runs, column) for column in self.places.T], axis=1)


def seams_between(
    shape: Structure | Form,
    first: Border,
    last: Border,
    strips: int | None = None,
    part: str | None = None,
    *,
    roll_width: float | None = None,
) -> list[SurfaceLine]:
    """Geodesics between two borders, from equal shares of the length of one to those of the other.

    Between a base and a ring they part gores, between two opposite edges strips side by side. Closed borders have a
    seam for each strip; between open ones there is one seam less. Shares of a ring are shifted so that the ends of
    seams are nearest to each other.

    Args:
        shape: The structure or form.
        first: Border at which the seams begin: the name of a cable or rope along it, or its nodes. The first node
            given is where the first seam of a closed border begins. A single node is an apex of all seams.
        last: Border at which they end, as the first.
        strips: Number of strips.
        part: Name of the membrane; None for all.
        roll_width: Width of the roll without allowances for welds, instead of the number of strips [m]. The number is
            the least one for strips no wider across their axes, laid out flat by a conformal map.

    Raises:
        ValueError: A border is no line of edges on the rim of the membrane; one is closed and the other open; both
            are single nodes; both or neither of strips and roll_width are given; no number of strips up to 500 suits
            the roll.
        ImportError: potpourri3d is not installed.

    Example:
        >>> points, triangles = rectangle(6.0, 4.0, 12, 8)
        >>> roof = Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3)})
        >>> west, east = (np.flatnonzero(points[:, 0] == x) for x in (-3, 3))
        >>> [line.points[0].round(6).tolist() for line in seams_between(roof, west, east, strips=2)]
        [[-3.0, 0.0, 0.0]]
        >>> len(seams_between(roof, west, east, roll_width=1.5))
        2
    """
    validation.instance("seams_between shape", shape, Structure | Form)
    structure = shape.structure if isinstance(shape, Form) else shape
    if (strips is None) == (roll_width is None):
        raise ValueError("seams_between has both strips and roll_width, or neither; give one of them.")
    surface = surface_of("seams_between", structure, part)
    lines = [_border(structure, surface, what, border) for what, border in (("first", first), ("last", last))]
    a, b = lines
    if len(a.nodes) > 1 and len(b.nodes) > 1 and a.closed != b.closed:
        closed, open_ = ("first", "last") if a.closed else ("last", "first")
        raise ValueError(f"The {closed} border is closed and the {open_} one open; give two of a kind, or an apex.")
    shared = np.intersect1d(a.nodes, b.nodes)
    if len(shared) == min(len(np.unique(line.nodes)) for line in lines):
        where = validation.format_point(structure.points[shared[0]])
        raise ValueError(f"first and last are the same border at {where}; give two borders apart.")
    if len(a.nodes) == len(b.nodes) == 1:
        raise ValueError(
            "first and last are single nodes, with one geodesic between them; give a border as one of them."
        )
    if strips is not None:
        return _geodesics(surface, *_ends(a, b, validation.positive_integer("strips", strips)))
    return _for_roll(structure, surface, a, b, part, validation.positive("roll_width", roll_width))


def _border(structure: Structure, surface: Surface, what: str, border: Any) -> _Line:
    """Border in order, from its name or its nodes."""
    rim = boundary_edges(surface.triangles)
    if isinstance(border, str):
        if border not in structure.bars:
            raise ValueError(f"{what} is {border!r}, which is no cable; those are {list(structure.bars)}.")
        cells = structure.parts[border].cells
        given = cells.ravel()[:1]
        sides = np.sort(surface.triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
        on = np.isin(np.sort(cells, axis=1) @ [len(structure.points), 1], sides @ [len(structure.points), 1])
        if not on.all():
            where = validation.format_point(structure.points[cells[~on][0]].mean(axis=0))
            raise ValueError(f"{what} is {border!r}, which leaves the membrane at {where}; give a cable along its rim.")
    else:
        given = validation.indices(what, border)
        validation.in_range(what, given, len(structure.points), "node")
        if len(given) == 1:
            if given[0] not in surface.triangles:
                raise ValueError(f"{what} is node {given[0]}, which is not on the membrane; give one of its nodes.")
            return _Line(given, structure.points[given])
        cells = rim[np.isin(rim, given).all(axis=1)]
        stray = np.setdiff1d(given, cells)
        if len(stray):
            where = validation.format_point(structure.points[stray[0]])
            raise ValueError(
                f"{what} has node {stray[0]} at {where}, which no edge of the rim joins to another one of it; give the "
                "nodes of a line of edges on the rim of the membrane."
            )
    try:
        nodes = path_along(cells)
    except ValueError as error:
        raise ValueError(f"{what} is no line: {error}.") from None
    if nodes[0] == nodes[-1]:
        ring = np.roll(nodes[:-1], -int(np.flatnonzero(nodes == given[0])[0]))
        nodes = np.append(ring, ring[0])
    return _Line(nodes, structure.points[nodes])


def _ends(a: _Line, b: _Line, strips: int) -> tuple[list[Any], list[Any]]:
    """Find the ends of the seams on both borders, each a node, or nodes and a place between them."""
    closed = a.closed or b.closed
    shares = np.arange(strips) / strips if closed else np.arange(1, strips) / strips
    if not closed and min(len(a.nodes), len(b.nodes)) == 1:  # from an apex to an open border
        shares = np.arange(1, strips) / strips
    starts = _places(a, shares)
    if len(a.nodes) == 1 or len(b.nodes) == 1:
        return starts, _places(b, shares)
    return starts, _places(b, _facing(a.at(shares), b, shares))


def _facing(starts: Array, b: _Line, shares: Array) -> Array:
    """Shares of a border that are nearest to the starts of seams on the other one."""
    offsets = np.array([0.0])
    if b.closed:
        offsets = np.concatenate([b.runs[:-1] / b.runs[-1], np.arange(MAX_POSITIONS) / MAX_POSITIONS])
    best, least = shares, np.inf
    for sense in (1.0, -1.0):
        for offset in offsets:
            tried = (offset + sense * shares) % 1.0 if b.closed else (shares if sense > 0 else 1 - shares)
            square = float(np.sum((b.at(tried) - starts) ** 2))
            if square < least * (1 - 1e-9):
                best, least = tried, square
    return best


def _places(line: _Line, shares: Array) -> list[Any]:
    """Nodes, or pairs of nodes and places between them, at shares of the length of a border."""
    if len(line.nodes) == 1:
        return [int(line.nodes[0])] * len(shares)
    runs, at = line.runs, shares * line.runs[-1]
    found: list[Any] = []
    for run, place in zip(at, line.at(shares), strict=True):
        row = min(int(np.searchsorted(runs, run, side="right")) - 1, len(runs) - 2)
        ends = line.nodes[row : row + 2].tolist()
        t = (run - runs[row]) / (runs[row + 1] - runs[row])
        found.append(ends[0] if t < NODE else ends[1] if t > 1 - NODE else (*ends, place))
    return found


def _geodesics(surface: Surface, starts: list[Any], ends: list[Any]) -> list[SurfaceLine]:
    """Geodesics between points on edges, found together."""
    if not starts:
        return []
    mesh = SplitMesh(surface.points, surface.triangles, NODE)
    pairs = [
        [point if isinstance(point, int) else mesh.on_edge(*point) for point in points] for points in (starts, ends)
    ]
    used, cells = np.unique(np.array(mesh.cells), return_inverse=True)
    turned, reason = with_one_sense(cells.reshape(-1, 3))
    if reason:
        raise ValueError(f"The surface {reason}")
    found = flipped(mesh.points[used], turned, np.searchsorted(used, np.array(pairs).T))
    middles = [(line[1:] + line[:-1]) / 2 for line in found]
    cells = nearest(surface, np.concatenate(middles))[0]
    bounds = np.cumsum([len(middle) for middle in middles])[:-1]
    return [SurfaceLine(line, within) for line, within in zip(found, np.split(cells, bounds), strict=True)]


def _for_roll(
    structure: Structure, surface: Surface, a: _Line, b: _Line, part: str | None, roll_width: float
) -> list[SurfaceLine]:
    """Seams of the least number of strips that a roll is wide enough for."""

    def tried(count: int) -> tuple[list[SurfaceLine], float, str]:
        seams = _geodesics(surface, *_ends(a, b, count))
        try:
            return seams, max(strip_widths(cut_strips(structure, seams, part)).values()), ""
        except ValueError as error:  # strips too wide to be laid flat
            return seams, np.inf, str(error)

    longest = max(float(line.runs[-1]) for line in (a, b))
    count = max(1, int(np.ceil(longest / roll_width - 1e-9)))
    seams, width, reason = tried(count) if count <= MAX_STRIPS else ([], np.inf, "")
    while width > roll_width:
        grown = 2 * count if np.isinf(width) else int(np.ceil(0.98 * count * width / roll_width))
        count = max(count + 1, grown)
        if count > MAX_STRIPS:
            told = f" {reason}" if reason else ""
            raise ValueError(
                f"roll_width is {roll_width:.4g}, too little for {MAX_STRIPS} strips; give a wider roll, or seams by "
                f"hand.{told}"
            )
        seams, width, reason = tried(count)
    while count > 1:
        fewer, width, _ = tried(count - 1)
        if width > roll_width:
            break
        seams, count = fewer, count - 1
    return seams
