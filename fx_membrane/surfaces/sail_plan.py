"""Plan of a sail, drawn from its corners, holes, lines and points."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from . import plan_checks
from .drawing import RIM, SAME_PLACE, WITHIN, Curve, Drawing
from .paths import arc, circle, straight
from .plan_mesh import PlanSegments
from .round_hole import RoundHole

Array = NDArray[np.float64]

RING_PIECES = 12  # least number of segments of a ring
TOUCHING_DISTANCE = 1e-8  # distance over the size of the plan that counts as touching
Label = Callable[[int], str]
MOST_SAG = 0.5  # that of half a circle


def draw(
    corners: Any, size: float, sag: Any, holes: Any, lines: Any, points: Any, sizes: Any
) -> tuple[Drawing, dict[str, int], PlanSegments]:
    """Draw a plan from the arguments of `sail_mesh`: curves divided into segments, nodes by name, and its segments."""
    size = validation.positive("size", size)
    other_sizes = {
        name: validation.positive(f"sizes of {name!r}", value) for name, value in _mapping("sizes", sizes).items()
    }
    named = _corners(corners)
    places = np.array([place[:2] for place in named.values()])
    drawing = Drawing(float(np.ptp(places, axis=0).max()))
    if size > drawing.size:
        raise ValueError(f"size is {size:g}, more than that of the plan, {drawing.size:g}; give that of its cells.")
    nodes: dict[str, int] = {}
    for name, place in named.items():
        _add_named(drawing, nodes, "The corner", name, place)
    _add_edges(drawing, nodes, places, size, sag)
    for name, place in _mapping("points", points).items():
        _add_named(drawing, nodes, "The point", name, checked_point(f"points of {validation.short_repr(name)}", place))
    for number, (name, hole) in enumerate(_mapping("holes", holes).items(), 1):
        _add_hole(drawing, nodes, name, hole, number, size)
    for name, line in _mapping("lines", lines).items():
        _add_line(drawing, nodes, name, line, size)
    for name, value in other_sizes.items():
        if name in drawing.curves:
            drawing.curves[name].size = value
        elif name not in nodes:
            raise ValueError(f"sizes names {name!r}, which is not in the plan; it has {[*drawing.curves, *nodes]}.")
    least = min([size, *other_sizes.values()])
    if abs(plan_checks.area(places)) > least**2 * validation.MAX_INTEGER / 10:
        raise ValueError(
            f"size is {least:g}, for a plan of the size {drawing.size:g}: too many cells; give a larger one."
        )
    drawing.divide()
    wanted = np.full(len(drawing.points), np.inf)
    for name in nodes.keys() & other_sizes.keys():
        wanted[nodes[name]] = other_sizes[name]
    return drawing, nodes, _segments(drawing, nodes, wanted, max([size, *other_sizes.values()]), size)


def _mapping(name: str, value: Any) -> Mapping[str, Any]:
    validation.instance(name, value, Mapping | None)
    return {validation.name(f"entry of {name}", key): entry for key, entry in (value or {}).items()}


def checked_point(what: str, value: Any) -> Array:
    """Check a point; its height is NaN if it has two coordinates, shape (3,)."""
    place = validation.finite(what, value)
    if place.shape not in ((2,), (3,)):
        raise ValueError(f"{what} is {validation.short_repr(value)}; give (x, y) or (x, y, z).")
    return np.array([*place, np.nan][:3])


def _rows(what: str, value: Any) -> Array:
    """Check points as rows, as by `checked_point`, shape (n, 3)."""
    rows = validation.finite(what, value)
    if rows.ndim != 2 or rows.shape[1] not in (2, 3):
        raise ValueError(f"{what} has shape {rows.shape}; give a row (x, y) or (x, y, z) for each point.")
    return np.column_stack([rows, np.full(len(rows), np.nan)])[:, :3]


def _corners(corners: Any) -> dict[str, Array]:
    """Corners by name; without a height they are at zero."""
    if isinstance(corners, Mapping):
        found = {
            name: checked_point(f"The corner {name!r}", place) for name, place in _mapping("corners", corners).items()
        }
    else:
        found = {str(number): place for number, place in enumerate(_rows("corners", corners))}
    if len(found) < 3:
        raise ValueError(f"corners has {len(found)} of them; give at least three.")
    found = {name: np.nan_to_num(place) for name, place in found.items()}
    places = np.array([place[:2] for place in found.values()])
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)
    if spread[1] <= SAME_PLACE * spread[0]:
        raise ValueError("The corners lie on one line in plan; give the plan an area.")
    return found


def _add_named(drawing: Drawing, nodes: dict[str, int], what: str, name: str, place: Array) -> None:
    if name in nodes or name in drawing.curves:
        raise ValueError(f"The name {name!r} is given twice in the plan; names must differ.")
    nodes[name] = drawing.node(f"{what} {name!r}", place[:2], float(place[2]))
    twin = next(other for other, node in nodes.items() if node == nodes[name])
    if twin != name:
        raise ValueError(
            f"{what} {name!r} is at the place of {twin!r}, {validation.format_point(place[:2])}; leave one out."
        )


def _add_curve(drawing: Drawing, nodes: Mapping[str, int], name: str, curve: Curve) -> None:
    if name in drawing.curves or name in nodes:
        raise ValueError(f"The name {name!r} is given twice in the plan; names must differ.")
    drawing.curves[name] = curve


def _add_edges(drawing: Drawing, nodes: Mapping[str, int], places: Array, size: float, sag: Any) -> None:
    names = list(nodes)
    edges = [f"{a}-{b}" for a, b in zip(names, names[1:] + names[:1], strict=True)]
    if isinstance(sag, Mapping):
        unknown = [name for name in sag if name not in edges]
        if unknown:
            raise ValueError(f"sag names {validation.short_repr(unknown[0])}, which is no edge; those are {edges}.")
        sags = [validation.number(f"sag of {edge!r}", sag.get(edge, 0.0)) for edge in edges]
    else:
        sags = [validation.number("sag", sag)] * len(edges)
    inwards = 1.0 if plan_checks.area(places) > 0 else -1.0
    for edge, rise, (a, b) in zip(edges, sags, _cyclic(range(len(edges))), strict=True):
        if abs(rise) >= MOST_SAG:
            raise ValueError(f"sag of {edge!r} is {rise:g}, an arc beyond half a circle; give less than {MOST_SAG}.")
        path = arc(places[a], places[b], inwards * rise)
        _add_curve(drawing, nodes, edge, Curve([path], [a, b], RIM, size, True))


def _cyclic(nodes: Sequence[int]) -> Iterator[tuple[int, int]]:
    return zip(nodes, [*nodes[1:], nodes[0]], strict=True)


def _add_hole(drawing: Drawing, nodes: Mapping[str, int], name: str, hole: Any, number: int, size: float) -> None:
    what = f"The hole {name!r}"
    if isinstance(hole, RoundHole):
        validation.plain(what, hole, RoundHole)
        centre = checked_point(what, hole.centre)
        paths = [circle(centre[:2], hole.radius)]
        ends = [drawing.node(what, paths[0].start, float(centre[2]))] * 2
        raised, size = not np.isnan(centre[2]), min(size, paths[0].length / RING_PIECES)
    else:
        corners = _rows(what, hole)
        if len(corners) < 3:
            raise ValueError(f"{what} has {len(corners)} corners; give at least three, or a RoundHole.")
        ends = [drawing.node(what, place[:2], float(place[2])) for place in corners]
        ends.append(ends[0])
        if len(set(ends)) < len(corners):
            raise ValueError(f"{what} has two corners at the same place; leave one out.")
        raised = not any(np.isnan(drawing.heights[node]) for node in ends)
        paths = [straight(drawing.points[a], drawing.points[b]) for a, b in pairwise(ends)]
    _add_curve(drawing, nodes, name, Curve(paths, ends, number, size, raised))


def _add_line(drawing: Drawing, nodes: Mapping[str, int], name: str, line: Any, size: float) -> None:
    what = f"The line {name!r}"
    if isinstance(line, str) or not isinstance(line, Sequence | np.ndarray) or len(line) < 2:
        raise ValueError(f"{what} is {validation.short_repr(line)}; give a list of at least two points.")
    found = [_line_point(drawing, nodes, what, entry) for entry in line]
    ends = [node for node, _ in found]
    for a, b in pairwise(ends):
        if a == b:
            where = validation.format_point(drawing.points[a])
            raise ValueError(f"{what} has the point {where} twice in turn; leave one out.")
    paths = [straight(drawing.points[a], drawing.points[b]) for a, b in pairwise(ends)]
    _add_curve(drawing, nodes, name, Curve(paths, ends, WITHIN, size, all(known for _, known in found)))


def _line_point(drawing: Drawing, nodes: Mapping[str, int], what: str, entry: Any) -> tuple[int, bool]:
    """Node of a point of a line, and True if it has a height."""
    if isinstance(entry, str):
        if entry not in nodes:
            raise ValueError(f"{what} names {entry!r}, which is no corner or point; those are {list(nodes)}.")
        return nodes[entry], not np.isnan(drawing.heights[nodes[entry]])
    if isinstance(entry, tuple | list) and len(entry) == 2 and isinstance(entry[0], str):
        name, share = entry
        if name not in drawing.curves:
            raise ValueError(
                f"{what} names {name!r}, which is no edge, hole or line; those are {list(drawing.curves)}."
            )
        share = validation.number(f"{what}, its share of {name!r},", share)
        if not 0 <= share <= 1:
            raise ValueError(f"{what} has the share {share:g} of {name!r}; give one from 0 to 1.")
        curve = drawing.curves[name]
        return drawing.node(what, curve.at(share)), curve.raised
    place = checked_point(f"A point of {what[0].lower()}{what[1:]}", entry)
    node = drawing.node(what, place[:2], float(place[2]))
    return node, not np.isnan(drawing.heights[node])


def _segments(drawing: Drawing, nodes: Mapping[str, int], wanted: Array, largest: float, size: float) -> PlanSegments:
    """Segments of a divided drawing, checked."""
    names = list(drawing.curves)
    rows = {name: np.column_stack([line[:-1], line[1:]]) for name, line in drawing.lines.items()}
    segments = np.concatenate([rows[name] for name in names])
    owner = np.repeat(np.arange(len(names)), [len(rows[name]) for name in names])
    loops = np.array([drawing.curves[name].loop for name in names])[owner]
    points = np.array(drawing.points)

    def label(segment: int) -> str:
        kind = {RIM: "edge", WITHIN: "line"}.get(int(loops[segment]), "hole")
        return f"the {kind} {names[owner[segment]]!r}"

    _refuse_crossings(points, segments, TOUCHING_DISTANCE * drawing.size, label, loops)
    _check_inside(points, segments, owner, loops, label)
    _check_points(nodes, points, segments, loops)
    length = np.linalg.norm(points[segments[:, 0]] - points[segments[:, 1]], axis=1)
    for corner in segments.T:
        np.minimum.at(wanted, corner, length)
    wanted[np.isinf(wanted)] = size
    return PlanSegments(points, segments, loops, wanted, largest)


def _refuse_crossings(
    points: Array, segments: NDArray[np.int64], near: float, label: Label, loops: NDArray[Any]
) -> None:
    found = plan_checks.crossing(points, segments, near) or plan_checks.pinched(points, segments, loops)
    if found is None:
        return
    i, j, (x, y) = found
    names = f"{label(i)} crosses itself" if label(i) == label(j) else f"{label(i)} and {label(j)} meet"
    if loops[i] == loops[j] == RIM:
        raise ValueError(
            f"The plan folds over itself: {names} at ({x:.6g}, {y:.6g}); give less sag, or corners in order round it."
        )
    remedy = (
        "give its points in order, each once"
        if label(i) == label(j)
        else "move one of them, or give lines a common point there"
    )
    raise ValueError(f"{names[0].upper()}{names[1:]} at ({x:.6g}, {y:.6g}); {remedy}.")


def _check_inside(
    points: Array, segments: NDArray[np.int64], owner: NDArray[np.intp], loops: NDArray[Any], label: Label
) -> None:
    """Refuse holes and lines outside the rim, or within a hole."""
    middles = points[segments].mean(axis=1)
    for loop in range(loops.max() + 1):
        border = points[segments[loops == loop, 0]]
        others = np.flatnonzero((loops != loop) & ((loops != RIM) if loop else True))
        within = plan_checks.inside(middles[others], border)
        wrong = others[within if loop else ~within]
        if len(wrong):
            where = validation.format_point(middles[wrong[0]])
            place = f"within {label(np.flatnonzero(loops == loop)[0])}" if loop else "outside the edges of the plan"
            text = label(wrong[0])
            raise ValueError(f"{text[0].upper()}{text[1:]} is {place} at {where}; move it into the sail.")


def _check_points(nodes: Mapping[str, int], points: Array, segments: NDArray[np.int64], loops: NDArray[Any]) -> None:
    """Refuse single points outside the rim, or within a hole."""
    single = {name: node for name, node in nodes.items() if node not in segments}
    if not single:
        return
    places = points[list(single.values())]
    for loop in range(loops.max() + 1):
        within = plan_checks.inside(places, points[segments[loops == loop, 0]])
        wrong = np.flatnonzero(within if loop else ~within)
        if len(wrong):
            name = list(single)[wrong[0]]
            where = validation.format_point(places[wrong[0]])
            place = "within a hole" if loop else "outside the edges of the plan"
            raise ValueError(f"The point {name!r} is {place}, at {where}; move it into the sail.")
