"""Cut lines: outlines of sewing lines, moved outward by a width for each side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FINE = 1e-9  # of the size of a strip: grid on which its outline is joined
PARALLEL_SINE = 1e-9  # sine of the angle between lines that do not meet


class Ring(NamedTuple):
    """Segments of a closed outline in order.

    Attributes:
        starts: First points, shape (n, 2).
        along: Directions, shape (n, 2).
        out: Outward normals, shape (n, 2).
        widths: Allowances, shape (n,).
        ends: Last points, shape (n, 2).
        joints: Segments whose last point is the end of a side, shape (n,).
    """

    starts: Array
    along: Array
    out: Array
    widths: Array
    ends: Array
    joints: NDArray[np.bool_]


def load_shapely() -> Any:
    """Import shapely.

    Raises:
        ImportError: It is not installed, or is older than version 2.
    """
    try:
        import shapely  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError(
            "Cutting patterns need the package shapely; install it by pip install 'fx-membrane[patterns]'."
        ) from None
    if not hasattr(shapely, "Polygon"):  # the shapely of Debian unstable does not know its version
        raise ImportError(
            f"Cutting patterns need shapely 2 or later, and {shapely.__version__} is installed; renew it by pip "
            "install 'shapely>=2'."
        )
    return shapely


def sewing_line(sides: Sequence[Array]) -> Array:
    """Join sides in order to a closed outline, without the first point at its end, shape (n, 2)."""
    return np.vstack([side[:-1] for side in sides])


def cut_line(name: str, sides: Sequence[Array], widths: Sequence[float], mitred: bool, limit: float) -> Array:
    """Outline of a strip with its allowances, counter-clockwise, without the first point at its end, shape (n, 2).

    The cloth is the union of the strip, a rectangle beside each segment, and corners between the rectangles.

    Args:
        name: Name of the strip, for messages.
        sides: Points of the sides in order, counter-clockwise, each with both its ends, shapes (n, 2).
        widths: Width beyond each side.
        mitred: Mitre the corners between sides; cut them straight otherwise.
        limit: Largest distance of a mitred corner, over the larger width.

    Raises:
        ValueError: The strip lies on itself, or its allowances meet each other.
    """
    shapely = load_shapely()
    strip = shapely.Polygon(sewing_line(sides))
    if not strip.is_valid:
        raise ValueError(
            f"Strip {name!r} lies on itself when it is flat ({shapely.is_valid_reason(strip)}); divide it by one more "
            "seam."
        )
    ring = _ring(sides, widths)
    beside = shapely.polygons(
        np.stack([ring.starts, _moved(ring.starts, ring), _moved(ring.ends, ring), ring.ends], axis=1)
    )
    pieces = [strip, *beside[ring.widths > 0], *_corners(shapely, ring, mitred, limit)]
    size = float(np.ptp(shapely.get_coordinates(strip), axis=0).max())
    cloth = shapely.union_all(pieces, grid_size=FINE * size)
    _refuse_meeting(shapely, name, cloth, size)
    outline = shapely.orient_polygons(cloth) if hasattr(shapely, "orient_polygons") else _oriented(cloth)
    return _without_straight(np.asarray(outline.exterior.coords)[:-1], 4 * FINE * size)


def _without_straight(outline: Array, near: float) -> Array:
    """Corners of an outline, without points nearer than a distance to the line between their neighbours."""
    before, after = np.roll(outline, 1, axis=0), np.roll(outline, -1, axis=0)
    chord, arm = after - before, outline - before
    away = np.abs(chord[:, 0] * arm[:, 1] - chord[:, 1] * arm[:, 0])
    return np.asarray(outline[away > near * np.linalg.norm(chord, axis=1)])


def _oriented(cloth: Any) -> Any:
    from shapely.geometry.polygon import orient  # noqa: PLC0415

    return orient(cloth)


def _refuse_meeting(shapely: Any, name: str, cloth: Any, size: float) -> None:
    if cloth.geom_type == "Polygon":
        holes = [hole for hole in cloth.interiors if shapely.Polygon(hole).area > FINE * size**2]
        if not holes:
            return
        x, y = holes[0].coords[0]
        place = f" around ({x:.4g}, {y:.4g})"
    else:
        place = ""
    raise ValueError(
        f"Strip {name!r}: allowances of two of its sides meet{place} and leave a hole; give smaller allowances there."
    )


def _ring(sides: Sequence[Array], widths: Sequence[float]) -> Ring:
    starts = np.vstack([side[:-1] for side in sides])
    ends = np.vstack([side[1:] for side in sides])
    counts = [len(side) - 1 for side in sides]
    joints = np.zeros(len(starts), dtype=bool)
    joints[np.cumsum(counts) - 1] = True
    step = ends - starts
    length = np.linalg.norm(step, axis=1)
    kept = length > 0
    along = step[kept] / length[kept, None]
    out = np.stack([along[:, 1], -along[:, 0]], axis=1)
    return Ring(starts[kept], along, out, np.repeat(widths, counts)[kept], ends[kept], joints[kept])


def _moved(points: Array, ring: Ring) -> Array:
    return np.asarray(points + ring.widths[:, None] * ring.out)


def _corners(shapely: Any, ring: Ring, mitred: bool, limit: float) -> list[Any]:
    """Cloth between the rectangles of two segments, where the outline turns left."""
    after = Ring._make(np.roll(entry, -1, axis=0) for entry in ring)
    sine = ring.along[:, 0] * after.along[:, 1] - ring.along[:, 1] * after.along[:, 0]
    cosine = np.einsum("ni,ni->n", ring.along, after.along)
    left = (sine > 0) | ((sine == 0) & (cosine < 0))
    chosen = np.flatnonzero(left & (np.maximum(ring.widths, after.widths) > 0))
    first, second = _moved(ring.ends, ring), _moved(ring.ends, after)
    found = []
    for row in chosen.tolist():  # of a few hundred
        corner = [ring.ends[row], first[row], second[row]]
        if mitred or not ring.joints[row]:
            corner += _mitre(ring, after, row, float(sine[row]), float(cosine[row]), limit)
        found.append(shapely.convex_hull(shapely.MultiPoint(np.array(corner))))
    return [corner for corner in found if corner.geom_type == "Polygon"]


def _mitre(ring: Ring, after: Ring, row: int, sine: float, cosine: float, limit: float) -> list[Array]:
    """Points of a mitre beyond the ends of both cut lines: where they meet, or both ends of the cut at the limit."""
    one, other = float(ring.widths[row]), float(after.widths[row])
    start, end = one * ring.out[row], other * after.out[row]
    meeting = None
    if sine > PARALLEL_SINE:
        forward, backward = (other - one * cosine) / sine, (one - other * cosine) / sine
        if forward < 0 or backward < 0:  # the wider allowance ends beside the narrower one
            return []
        meeting = start + forward * ring.along[row]
    reach = limit * max(one, other)
    if meeting is not None and np.linalg.norm(meeting) <= reach:
        return [ring.ends[row] + meeting]
    ahead = ring.along[row] if meeting is None else meeting / np.linalg.norm(meeting)
    first = start + (reach - start @ ahead) / (ring.along[row] @ ahead) * ring.along[row]
    second = end + (reach - end @ ahead) / (after.along[row] @ ahead) * after.along[row]
    return [ring.ends[row] + first, ring.ends[row] + second]
