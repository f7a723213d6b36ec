"""Lines along a field on a surface that keep a distance from each other.

Source:
    B. Jobard, W. Lefer, Creating evenly-spaced streamlines of arbitrary density, in: Visualization in Scientific
    Computing '97, Springer (1997) 43-55.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..geometry.sizes import measures
from .tracing import Ends, Field, Track, shares_of, trace
from .walking import Terrain

Array = NDArray[np.float64]
Integers = NDArray[np.int64]
Truths = NDArray[np.bool_]

START = 0.9  # distance of a new line from others over the spacing; along surfaces it is longer than in space
END = 0.6  # distance over the spacing from which on a line that nears others ends
SAMPLES = 4  # samples of a line to each spacing
SHEET_OFFSET = 10.0  # offset between sheets that do not see each other, over the size of the surface


@dataclass
class Spread:
    """Lines on a surface so far.

    Attributes:
        terrain: The surface.
        along: The field that they follow.
        allowed: Cells of the field, shape (cells,).
        spacing: Distance between lines [m].
        shortest: Least length of a line [m].
        sheets: Number of the sheet of each cell, shape (cells,); lines of different sheets may be near to each other.
        tracks: The lines.
        keys: Their samples: place, normal and sheet, shape (m, 7).
        seeds: Points beside lines, at which others can begin.
    """

    terrain: Terrain
    along: Field
    allowed: Truths
    spacing: float
    shortest: float
    sheets: Integers
    tracks: list[Track] = field(default_factory=list)
    keys: Array = field(default_factory=lambda: np.zeros((0, 7)))
    seeds: list[Ends] = field(default_factory=list)

    def key(self, cells: Integers, places: Array) -> Array:
        """Points whose distance tells apart the sides of a fold and different sheets, shape (k, 7)."""
        size = SHEET_OFFSET * (self.spacing + float(np.ptp(self.terrain.points, axis=0).max()))
        apart = size * self.sheets[cells]
        return np.column_stack([places, self.spacing * self.terrain.normals[cells], apart])

    def free(self, keys: Array, share: float) -> Truths:
        """Points at a distance from all lines of at least a share of the spacing, shape (k,)."""
        if not len(self.keys) or not len(keys):
            return np.ones(len(keys), dtype=bool)
        reach = share * self.spacing
        return np.asarray(np.isinf(cKDTree(self.keys).query(keys, distance_upper_bound=reach)[0]))

    def add(self, seeds: Ends) -> Truths:
        """Trace lines through points, and keep those that are long enough beside the others; True for these."""
        sense = self.along.direction(seeds.cells, seeds.shares, seeds.directions)
        cells, shares = np.tile(seeds.cells, 2), np.tile(seeds.shares, (2, 1))
        area = float(measures(self.terrain.points, self.terrain.triangles[self.allowed]).sum())
        most = area / self.spacing + np.sqrt(area)  # longer ones would be too near to themselves
        both, near = np.concatenate([sense, -sense]), END * self.spacing
        tracks, _ = trace(self.terrain, cells, shares, both, most, self.allowed, self.along, near)
        kept = np.zeros(len(sense), dtype=bool)
        for number in range(len(sense)):
            kept[number] = self._keep(tracks[number], tracks[number + len(sense)])
        return kept

    def _keep(self, ahead: Track, back: Track) -> bool:
        """Keep the piece of a line through its seed that is far enough from all others; False for too short ones."""
        if ahead.closed:
            points, cells, seed = ahead.points, ahead.cells, 0
        else:
            points = np.concatenate([back.points[::-1], ahead.points[1:]])
            cells, seed = np.concatenate([back.cells[::-1], ahead.cells]), len(back.cells)
        if not len(cells):
            return False
        points, cells, seed = _divided(points, cells, seed, self.spacing / SAMPLES)
        owner = np.append(cells, cells[-1])
        keys = self.key(owner, points)
        free = self.free(keys, START)
        if not free[seed]:
            return False
        far = self.free(keys, END)
        arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
        first, last = _around(far, seed)
        if not ahead.closed:
            first, last = self._before_itself(keys, arc, seed, first, last)
        closed = ahead.closed and last - first == len(points) - 1
        if last == first or (arc[last] - arc[first] < self.shortest and not closed):
            return False
        track = Track(points[first : last + 1], cells[first:last], closed)
        self.tracks.append(track)
        self.keys = np.concatenate([self.keys, keys[first : last + 1]])
        self.seeds.append(self._beside(track, seed - first))
        return True

    def _before_itself(self, keys: Array, arc: Array, seed: int, first: int, last: int) -> tuple[int, int]:
        """Find the ends of a line before it comes near to itself."""
        pairs = cKDTree(keys).query_pairs(END * self.spacing, output_type="ndarray")
        pairs = pairs[np.abs(arc[pairs[:, 0]] - arc[pairs[:, 1]]) > 3 * self.spacing]
        if not len(pairs):
            return first, last
        away = arc - arc[seed]
        rows = np.arange(len(pairs))
        outer = pairs[rows, np.abs(away[pairs]).argmax(axis=1)]
        ahead, behind = outer[outer > seed], outer[outer < seed]
        return int(max([first, *(behind + 1)])), int(min([last, *(ahead - 1)]))

    def _beside(self, track: Track, seed: int) -> Ends:
        """Points at the spacing on both sides of a line, those beside its seed first."""
        middle = (track.points[1:] + track.points[:-1]) / 2
        order = np.argsort(np.abs(np.arange(len(middle)) - seed), kind="stable")
        cells = track.cells[order]
        shares = shares_of(self.terrain, cells, middle[order])
        side = np.diff(track.points, axis=0)[order]
        along = side / np.linalg.norm(side, axis=1, keepdims=True)
        across = np.cross(self.terrain.normals[cells], along)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        both = np.concatenate([across, -across])
        cells, shares = np.tile(cells, 2), np.tile(shares, (2, 1))
        _, ends = trace(self.terrain, cells, shares, both, self.spacing, self.allowed)
        return ends._replace(directions=np.tile(along, (2, 1)))

    def next_seeds(self) -> Ends | None:
        """Choose one free point on each side of each line; None if there is none."""
        found = [self._taken(number, ends) for number, ends in enumerate(self.seeds)]
        if not any(len(ends.cells) for ends in found):
            return None
        cells, shares, directions, lengths = (
            np.concatenate([ends[entry] for ends in found]) for entry in range(len(Ends._fields))
        )
        return Ends(cells, shares, directions, lengths)

    def _taken(self, number: int, ends: Ends) -> Ends:
        """Choose the first free point on each side of a line; others are not looked at again."""
        usable = (ends.lengths >= self.spacing * (1 - 1e-9)) & self.allowed[ends.cells]
        places = self.terrain.places(ends.cells[usable], ends.shares[usable])
        usable[usable] = self.free(self.key(ends.cells[usable], places), START)
        sides = usable.reshape(2, -1)
        chosen = np.flatnonzero(usable & (np.cumsum(sides, axis=1) == 1).ravel())
        usable[chosen] = False
        self.seeds[number] = ends._replace(lengths=np.where(usable, ends.lengths, 0.0))
        return Ends(ends.cells[chosen], ends.shares[chosen], ends.directions[chosen], ends.lengths[chosen])


def _divided(points: Array, cells: Integers, seed: int, longest: float) -> tuple[Array, Integers, int]:
    """Divide segments of a line that are longer than a length; also the number of the seed among its points."""
    side = np.diff(points, axis=0)
    size = np.linalg.norm(side, axis=1)
    there = size > 1e-12 * max(float(size.max()), 1e-300)
    pieces = np.where(there, np.ceil(size / longest - 1e-9).astype(np.int64).clip(1), 0)
    before = np.concatenate([[0], np.cumsum(pieces)])
    segment = np.repeat(np.arange(len(size)), pieces)
    share = (np.arange(before[-1]) - before[segment]) / pieces[segment]
    divided = points[segment] + share[:, None] * side[segment]
    return np.concatenate([divided, points[-1:]]), cells[segment], int(before[seed])


def _around(far: Truths, seed: int) -> tuple[int, int]:
    """First and last sample of the run of true ones around a seed."""
    near = np.flatnonzero(~far)
    before, after = near[near < seed], near[near > seed]
    return (int(before[-1]) + 1 if len(before) else 0), (int(after[0]) - 1 if len(after) else len(far) - 1)
