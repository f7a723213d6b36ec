"""Flattening of strips by least strain energy, all in one system, with the law of the fabric."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..checks.validation import format_point
from ..geometry.sizes import normals, projected
from ..model import laws
from ..surfaces.plan_checks import crossing
from .cloth import Cloth
from .energy_minimum import Links, Shape, least_energy, lengths
from .first_maps import first_map
from .flat_strips import FlatStrip
from .pieces import Pieces, pieces_of
from .plane_cells import sides
from .strips import Strips, check_strips
from .surface_folds import refuse_folded

Array = NDArray[np.float64]

STRAIGHT_CHANGE = 1e-9  # change of places over size after which threads count as straight
MAX_PASSES = 12  # passes in which the threads of a woven fabric are made straight
MAX_LENGTH_RATIO = 1.5  # ratio of flat lengths to those on the surface, or its inverse, beyond which a strip is refused


@dataclass(frozen=True, eq=False)
class Flattened:
    """Strips in the plane, with the data for compensation.

    Attributes:
        strips: The strips.
        pieces: Their points and cells, apart from each other.
        cloth: The cloth in the plane.
        places: Flat points, the warp along the first axis, shape (n, 2) [m].
        energy: Strain energy [J].
        shapes: Sides of the cells on the surface in axes of warp and weft, as columns, shape (k, 2, 2) [m].
        sewn: Side by side, rows of `pieces.border` that are sewn together, as equally long.
    """

    strips: Strips
    pieces: Pieces
    cloth: Cloth
    places: Array
    energy: float
    shapes: Array
    sewn: tuple[NDArray[np.int64], NDArray[np.int64]]


def flatten(strips: Strips, seam_difference: float = 0.0) -> dict[str, FlatStrip]:
    """Flatten strips by least strain energy: the surface is free of stress, the flat shape is strained.

    Both sides of each seam get the same length, segment by segment. The fabric neither wrinkles nor bears prestress.
    Developable strips unroll exactly. Under MPI each process finds the same shapes.

    Args:
        strips: The strips.
        seam_difference: Difference of the two sides of a seam segment over its length that may stay; the least energy
            without equal lengths is taken if it keeps to it [-].

    Returns:
        Flat strips by name.

    Raises:
        ValueError: A strip is no disc, or too curved to be laid flat without a fold; a border of it is on no edge.
        RuntimeError: No shape of least energy was found.

    Example:
        >>> points, triangles = rectangle(8.0, 6.0, 8, 6)
        >>> points[:, 2] = points[:, 0] * points[:, 1] / 12.0  # a hypar, cut along a cable
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable(polyline(range(27, 36)), 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> flat = flatten(cut_strips(roof, ["valley"]))
        >>> {name: (round(strip.length, 2), round(strip.width, 2)) for name, strip in flat.items()}
        {'strip 1': (8.22, 3.16), 'strip 2': (8.22, 3.16)}

    Source:
        Least energy with equal seams: E. Moncrieff, B. H. V. Topping, Computer methods for the generation of membrane
        cutting patterns, Computers & Structures 37 (1990) 441-450; J. Linhard, R. Wüchner, K.-U. Bletzinger, Int. J.
        Struct. Stab. 8 (2008).
    """
    flat = flattened_strips(strips, seam_difference)
    return flat.pieces.flat_strips(strips, flat.places)


def flattened_strips(strips: Strips, seam_difference: float = 0.0, caller: str = "flatten") -> Flattened:
    """Flatten strips, as by `flatten`; messages name the function that the user calls."""
    check_strips(caller, strips)
    seam_difference = validation.not_negative(f"{caller} seam_difference", seam_difference)
    pieces = pieces_of(strips)
    points = strips.structure.points[pieces.nodes]
    for number, name in enumerate(pieces.names):
        refuse_folded(name, points, pieces.triangles[pieces.cells_of(number)])
    shapes = _on_surface(strips, pieces, points)
    places = _laid_out(first_map(points, shapes, pieces), shapes, pieces)
    _check_stretch(places, shapes, pieces, points)
    laws_of_strips = [strips.membrane(name).material for name in pieces.names]
    cloth = Cloth(places, pieces.triangles, pieces.strip_of_cell, laws_of_strips)
    here, there = pieces.seam_pairs()
    if seam_difference:
        found, straight = _straightened(cloth, shapes, places, pieces, links(pieces, here[:0], there[:0]))
        if largest_difference(found.places, pieces) <= seam_difference:
            return _checked(Flattened(strips, pieces, cloth, *found, straight, (here[:0], there[:0])), points)
    found, straight = _straightened(cloth, shapes, places, pieces, links(pieces, here, there))
    return _checked(Flattened(strips, pieces, cloth, *found, straight, (here, there)), points)


def links(pieces: Pieces, here: NDArray[np.int64], there: NDArray[np.int64]) -> Links:
    """Sides of seams that are equally long."""
    return Links(pieces.border[here], pieces.border[there], np.full(len(here), np.nan))


def largest_difference(places: Array, pieces: Pieces) -> float:
    """Largest difference of two sides of a segment of a seam over its length [-]."""
    one, other = (lengths(places, pieces.border[rows]) for rows in pieces.seam_pairs())
    return float(np.abs(one / other - 1).max(initial=0.0))


def refuse_folds(places: Array, pieces: Pieces, what: str) -> None:
    """Refuse strips whose outline crosses itself."""
    for number, name in enumerate(pieces.names):
        rows = pieces.points_of(number)
        mine = (pieces.border[:, 0] >= rows.start) & (pieces.border[:, 0] < rows.stop)
        found = crossing(places[rows], pieces.border[mine] - rows.start, 1e-12 * float(np.ptp(places[rows])))
        if found:
            node = pieces.nodes[pieces.border[np.flatnonzero(mine)[found[0]], 0]]
            raise ValueError(
                f"{what} of strip {name!r} lies on itself at node {node}; divide the strip by another seam."
            )


def _checked(flat: Flattened, points: Array) -> Flattened:
    _check_stretch(flat.places, flat.shapes, flat.pieces, points)
    refuse_folds(flat.places, flat.pieces, "The flat shape")
    return flat


def _check_stretch(places: Array, shapes: Array, pieces: Pieces, points: Array) -> None:
    """Refuse cells that are far from their size on the surface."""
    stretch = np.linalg.svd(sides(places, pieces.triangles) @ np.linalg.inv(shapes), compute_uv=False)
    ratio = np.maximum(stretch[:, 0], 1 / stretch[:, 1])
    cell = int(ratio.argmax())
    if ratio[cell] > MAX_LENGTH_RATIO:
        name = pieces.names[pieces.strip_of_cell[cell]]
        where = format_point(points[pieces.triangles[cell]].mean(axis=0))
        raise ValueError(
            f"Strip {name!r} is too curved to be laid flat: a cell at {where} changes its lengths by a factor of "
            f"{ratio[cell]:.3g}, or would fold; take narrower strips."
        )


def _on_surface(strips: Strips, pieces: Pieces, points: Array) -> Array:
    """Sides of the cells on the surface in axes of warp and weft, as columns, shape (k, 2, 2) [m]."""
    normal = normals(points, pieces.triangles)
    warp = projected(np.concatenate([strips.structure.warp(name) for name in pieces.names]), normal)
    frame = np.stack([warp, np.cross(normal, warp)], axis=1)
    return np.asarray(frame @ sides(points, pieces.triangles))


def _laid_out(places: Array, shapes: Array, pieces: Pieces) -> Array:
    """Turn strips so that their warp is along the first axis, and lay one above the other."""
    places, height = places.copy(), 0.0
    warp = (sides(places, pieces.triangles) @ np.linalg.inv(shapes))[:, :, 0]
    for number in range(len(pieces.names)):
        rows, cells = pieces.points_of(number), pieces.cells_of(number)
        turned = places[rows] @ _turn(np.linalg.det(shapes[cells]) @ warp[cells])
        turned -= turned.min(axis=0)
        places[rows] = turned + np.array([0.0, height])
        height += 1.1 * float(np.ptp(turned[:, 1])) + 0.1 * float(np.ptp(turned[:, 0]))
    return places


def _turn(direction: Array) -> Array:
    """Matrix that turns rows so that a direction comes to the first axis, shape (2, 2)."""
    c, s = direction / np.linalg.norm(direction)
    return np.array([[c, -s], [s, c]])


def _straightened(cloth: Cloth, shapes: Array, places: Array, pieces: Pieces, bound: Links) -> tuple[Shape, Array]:
    """Least energy with the threads of woven fabrics straight in the plane; also the sides in axes of these threads."""
    directed = np.array([laws.is_directed(law) for law in cloth.laws])[pieces.strip_of_cell]
    for _ in range(MAX_PASSES):
        before = places
        found = least_energy(cloth.with_shapes(shapes), places, pieces.strip_of_point, bound)
        places = _laid_out(found.places, shapes, pieces)
        angle = np.where(directed, thread_angles(places, shapes, pieces), 0.0)
        shapes = turned_shapes(shapes, angle)
        if not directed.any() or np.abs(places - before).max() < STRAIGHT_CHANGE * float(np.ptp(places)):
            break
    return Shape(places, found.energy), shapes


def thread_angles(places: Array, shapes: Array, pieces: Pieces) -> Array:
    """Angles from the warp on the surface to the threads, which are straight in the plane, shape (k,)."""
    thread = (shapes @ np.linalg.inv(sides(places, pieces.triangles)))[:, :, 0]
    return np.asarray(np.arctan2(thread[:, 1], thread[:, 0]))


def turned_shapes(shapes: Array, angle: Array) -> Array:
    """Sides in axes that are turned by angles, counter-clockwise, shape (k, 2, 2) [m]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(np.stack([np.stack([c, s], axis=1), np.stack([-s, c], axis=1)], axis=1) @ shapes)
