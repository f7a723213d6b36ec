"""Cutting patterns: strips flattened and compensated, with seams as long on both sides, borders decompensated."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .compensations import Compensation, compensation_of, mean_ratios
from .decompensation import checked, without_compensation
from .energy_minimum import Links, least_energy, lengths
from .flat_shapes import Flattened, flattened_strips, refuse_folds
from .flat_strips import CuttingPattern
from .pieces import Pieces
from .plane_cells import sides
from .strips import Strips

Array = NDArray[np.float64]
Integers = NDArray[np.int64]

EQUAL_LENGTHS = 1e-13  # difference of lengths over length that counts as none
UNIFORM = 1e-9  # difference of ratios within a strip that counts as none


def cutting_pattern(
    strips: Strips,
    compensation: Compensation = "prestress",
    decompensate: Sequence[str | int] | str | int = (),
    transition: float | None = None,
    seam_difference: float = 0.0,
) -> CuttingPattern:
    """Cutting pattern of strips: flat shapes of least strain energy, and the cloth, which prestress stretches to them.

    Both sides of each seam get the same length, segment by segment, in the flat shapes and in the cloth. Cells
    compensated one by one need not fit together, nor give equal seams. The cloth is then the shape of least strain
    energy, with the compensated cells free of stress.

    Where threads run at an angle to the principal stress, "prestress" compensates the shear between them, too. Cells of
    a fabric that is soft in shear are then far from fitting together. Beside rings, where strips run aslant,
    stress of single cells may be off by its mean. Finer meshes lower it; `prove_pattern` tells the place.

    Args:
        strips: The strips.
        compensation: "prestress": by the law, so that each cell has its prestress as Cauchy stress on the surface. Or a
            ratio of cloth to flat lengths, or a (warp, weft) pair, as (0.992, 0.985). Or `BiaxialTests`, from which
            each strip takes the elongations under its mean prestress. Or one of these for each strip, by its name or
            that of the membrane that it is cut from.
        decompensate: Names of edges that keep their length on the surface, as at rings and rails; or of cables and
            ropes along them. Or numbers of nodes, as corners, around which cloth is not compensated.
        transition: Width over which compensation begins beside them, smoothly [m].
        seam_difference: As of `flatten` [-].

    Returns:
        The pattern; the same on each process under MPI.

    Raises:
        ValueError: A strip is no disc, or too curved to be laid flat without a fold; there is no prestress to
            compensate; a compensation is not positive, or far from one; a stress pair is outside the tests; an edge
            is unknown; a transition has nothing beside it.
        RuntimeError: No shape of least energy was found.

    Example:
        >>> points, triangles = rectangle(8.0, 6.0, 8, 6)
        >>> points[:, 2] = points[:, 0] * points[:, 1] / 12.0  # a hypar, cut along a cable
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable(polyline(range(27, 36)), 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> pattern = cutting_pattern(cut_strips(roof, ["valley"]))
        >>> pattern.compensation["strip 1"].round(5).tolist()
        [0.99721, 0.99721]
        >>> [round(pattern.cloth[name].area / pattern.flat[name].area, 5) for name in pattern.flat]
        [0.99443, 0.99443]

    Source:
        As of `flatten`.
    """
    flat = flattened_strips(strips, seam_difference, "cutting_pattern")
    chosen = checked(flat, decompensate, transition)
    ratios = compensation_of(flat, compensation)
    if chosen:
        assert transition is not None
        share = without_compensation(flat, chosen, transition)
        ratios = map_stretch(ratios @ (np.eye(2) - share) + share)
    cloth = _cloth(flat, ratios, tuple(one for one in chosen if isinstance(one, str)))
    refuse_folds(cloth, flat.pieces, "The cloth")
    return CuttingPattern(
        strips=strips,
        flat=flat.pieces.flat_strips(strips, flat.places),
        cloth=flat.pieces.flat_strips(strips, cloth),
        compensation=mean_ratios(flat, ratios),
        energy=flat.energy,
        decompensated=chosen,
    )


def map_stretch(gradient: Array) -> Array:
    """Take symmetric stretches of gradients, shape (k, 2, 2) [-]."""
    values, axes = np.linalg.eigh(gradient.transpose(0, 2, 1) @ gradient)
    return np.asarray((axes * np.sqrt(values)[:, None, :]) @ axes.transpose(0, 2, 1))


def _cloth(flat: Flattened, ratios: Array, kept: tuple[str, ...]) -> Array:
    """Places of the compensated cloth, shape (n, 2) [m]."""
    pieces, places = flat.pieces, flat.places.copy()
    uniform = True
    for number, mean in enumerate(mean_ratios(flat, ratios).values()):
        rows, cells = pieces.points_of(number), pieces.cells_of(number)
        corner = places[rows].min(axis=0)
        places[rows] = corner + (places[rows] - corner) * mean
        uniform = uniform and np.abs(ratios[cells] - mean * np.eye(2)).max() < UNIFORM
    bound = bound_sides(flat.strips, pieces, flat.sewn, kept, flat.strips.structure.points[pieces.nodes])
    one, other = lengths(places, bound.here), lengths(places, bound.there)
    gaps = one / np.where(bound.given, bound.length, other) - 1
    if uniform and np.abs(gaps).max(initial=0.0) < EQUAL_LENGTHS:
        return places
    shapes = ratios @ sides(flat.places, pieces.triangles)
    return least_energy(flat.cloth.with_shapes(shapes), places, pieces.strip_of_point, bound).places


def bound_sides(
    strips: Strips, pieces: Pieces, sewn: tuple[Integers, Integers], kept: Sequence[str], points: Array
) -> Links:
    """Sides of seams that are equally long, and sides of edges that keep the lengths that they have between points.

    Args:
        strips: The strips.
        pieces: The strips, apart from each other.
        sewn: Rows of `pieces.border` that are sewn together.
        kept: Names of edges that keep their length.
        points: Points of the pieces, shape (n, 2) or (n, 3) [m].
    """
    here, there = sewn
    names = np.array([edge.name for edge in strips.edges])
    given = np.flatnonzero(np.isin(names[pieces.edge], kept))
    free = ~np.isin(names[pieces.edge[here]], kept)
    here, there = here[free], there[free]
    length = np.concatenate([np.full(len(here), np.nan), lengths(points, pieces.border[given])])
    return Links(pieces.border[np.concatenate([here, given])], pieces.border[np.concatenate([there, given])], length)
