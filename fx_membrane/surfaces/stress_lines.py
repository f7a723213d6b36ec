"""Lines of stress on membranes: principal stress trajectories, and lines of wrinkles."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..assembly.actions import unloaded
from ..checks import validation
from ..form_finding.form import Form
from ..geometry.topology import from_smallest
from ..model.parts import Membrane
from ..model.structure import Structure
from ..results.initial_stress import reference_stress
from ..results.states import StageResult
from .nearest_points import on_surface
from .shapes import Surface, surface_of
from .spread_lines import PARTS, checked_spacing, even_lines
from .surface_lines import SurfaceLine, listed_points
from .tracing import Field, field_of, plane_axes, trace
from .walking import Terrain

Array = NDArray[np.float64]

ISOTROPIC = 0.01  # difference of principal stresses over the larger below which stress has no direction


class _Sheet(NamedTuple):
    """Membranes together.

    Attributes:
        terrain: Their surface.
        stress: Cauchy stress of the cells, shape (cells, 3, 3) [N/m].
        state: "taut", "wrinkled" or "slack", shape (cells,).
        members: Number of the membrane of each cell, shape (cells,).
    """

    terrain: Terrain
    stress: Array
    state: NDArray[np.str_]
    members: NDArray[np.int64]


def stress_trajectories(
    shape: Structure | Form | StageResult,
    part: str | None = None,
    *,
    starts: Sequence[int | ArrayLike] | None = None,
    spacing: float | None = None,
    second: bool = False,
) -> list[SurfaceLine]:
    """Principal stress trajectories: lines whose direction is that of a principal stress everywhere.

    They go through points, as seams do, or are spread evenly.

    The stress is interpolated between means at the nodes: the lines are of second order in the mesh size. Lines
    end where stress has no direction, its principal values within 1 % of each other, and in slack cells; those of the
    second principal stress end in wrinkled cells, too, which carry nothing along them.

    Args:
        shape: A `StageResult`, taken as deformed; a `Structure` as built; or a `Form`.
        part: Name of the membrane; None for all, joined where they share nodes.
        starts: Points that the lines go through: node numbers, or positions on the surface, shape (3,) [m]; None for
            lines spread evenly.
        spacing: Without starts, distance between neighbouring lines; by default a twentieth of the extent of the
            structure [m].
        second: True for lines of the second principal stress, across those of the first.

    Returns:
        The lines; their `cells` are those of the part, or of all membranes in the order of the parts.

    Raises:
        ValueError: The shape is none of these, or has no membrane of that name; a start is not on the surface, or the
            stress has no direction there; spacing is given with starts, is not positive, or so small that the lines
            would have more than 2e5 segments.

    Example:
        >>> points, triangles = rectangle(4.0, 2.0, 8, 4)
        >>> strip = Membrane(triangles, Fabric(4e5, 0.3), prestress=(2e3, 1e3), warp=(1, 0, 0))
        >>> lines = stress_trajectories(Structure(points, {"strip": strip}), spacing=0.5)
        >>> sorted({round(line.length, 9) for line in lines})
        [4.0]
    """
    second = validation.truth("second", second)
    sheet = _sheet("stress_trajectories", shape, part)
    allowed = _directed(sheet) & (sheet.state == "taut" if second else sheet.state != "slack")
    if starts is not None:
        if spacing is not None:
            raise ValueError("spacing is given with starts; give one of them.")
        return _through_points(sheet, allowed, listed_points(starts), second)
    distance = checked_spacing("spacing", sheet.terrain, spacing)
    return _lines(sheet, allowed, distance, shortest=distance, second=second)


def wrinkle_lines(
    shape: Structure | Form | StageResult, part: str | None = None, *, spacing: float | None = None
) -> list[SurfaceLine]:
    """Lines of wrinkles, spread evenly over the wrinkled cells: along the tension, as crests of wrinkles run.

    Their distance is that of a drawing, not a wave length: a membrane without bending stiffness has none.

    Args:
        shape: A `StageResult`, taken as deformed; a `Structure` or a `Form` has no wrinkles, and no lines.
        part: Name of the membrane; None for all.
        spacing: Distance between neighbouring lines; by default a fortieth of the extent of the structure [m].

    Returns:
        The lines, at least one in each wrinkled region; their `cells` as those of `stress_trajectories`.

    Raises:
        ValueError: As `stress_trajectories`.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> parts = {"sail": Membrane(triangles, Fabric(1e5, 0.3))}
        >>> pull = PrescribedDisplacement(range(25), points * [0.01, -0.01, 0])  # wider, and shorter than it becomes
        >>> state = Analysis(Structure(points, parts)).run([Stage("pull", displacements=[pull])])["pull"]
        >>> lines = wrinkle_lines(state, spacing=0.5)
        >>> bool(np.allclose([np.abs(line.directions) for line in lines[:1]], [1, 0, 0]))
        True
    """
    sheet = _sheet("wrinkle_lines", shape, part)
    distance = checked_spacing("spacing", sheet.terrain, spacing, 2 * PARTS)
    return _lines(sheet, sheet.state == "wrinkled", distance, shortest=0.0)


def _through_points(
    sheet: _Sheet, allowed: NDArray[np.bool_], starts: Sequence[Any], second: bool
) -> list[SurfaceLine]:
    """Trace lines through points, from end to end."""
    terrain = sheet.terrain
    surface = Surface(terrain.points, terrain.triangles)
    allowed = allowed & terrain.sound
    along = field_of(terrain, sheet.stress, allowed, second, sheet.members)
    return [_line_through(terrain, along, allowed, *on_surface("A start", surface, start)) for start in starts]


def _line_through(terrain: Terrain, along: Field, allowed: NDArray[np.bool_], cell: int, shares: Array) -> SurfaceLine:
    place = terrain.place(cell, shares)
    inside = next((other for other, _ in terrain.cells_at(cell, shares) if allowed[other]), None)
    if inside is None:
        raise ValueError(
            f"The stress at {validation.format_point(place)} has no direction, its principal values being alike, or "
            "the cell slack; move the start."
        )
    mine = next(share for other, share in terrain.cells_at(cell, shares) if other == inside)
    ahead = along.direction(np.array([inside]), mine[None], along.axes[[inside], 0])[0]
    halves = []
    for sense in (-1.0, 1.0):
        first = terrain.cell_towards(cell, shares, sense * ahead)
        if first is not None and allowed[first[0]]:
            number, share, direction = first
            tracks, _ = trace(
                terrain, np.array([number]), share[None], direction[None], np.inf, allowed, along, near=0.0
            )
            halves.append((tracks[0].points, tracks[0].cells))
        else:
            halves.append((place[None], np.zeros(0, dtype=np.int64)))
    (back, behind), (front, before) = halves
    points = np.concatenate([back[::-1][:-1], place[None], front[1:]])
    return SurfaceLine(points, np.concatenate([behind[::-1], before]))


def stress_of(shape: Structure | Form | StageResult, name: str) -> Array:
    """Cauchy stress of a membrane in global axes, of a structure as built, shape (cells, 3, 3) [N/m]."""
    if isinstance(shape, StageResult):
        return shape.membrane(name).cauchy
    structure = shape if isinstance(shape, Structure) else shape.structure
    structure.part(name, Membrane)
    tensors = shape.forces[name] if isinstance(shape, Form) else reference_stress(structure, name, unloaded(structure))
    warp, terrain = structure.warp(name), Terrain(surface_of("stress", structure, name), cut=True)
    frame = np.stack([warp, np.cross(terrain.normals, warp)], axis=1)
    return np.asarray(np.einsum("cki,ckl,clj->cij", frame, tensors, frame))


def states_of(shape: Structure | Form | StageResult, name: str) -> NDArray[np.str_]:
    """States of the cells of a membrane, "taut" for all of a structure or a form, shape (cells,)."""
    if isinstance(shape, StageResult):
        return shape.membrane(name).state
    structure = shape if isinstance(shape, Structure) else shape.structure
    return np.full(len(structure.part(name, Membrane).cells), "taut")


def _sheet(what: str, shape: Structure | Form | StageResult, part: str | None) -> _Sheet:
    if not isinstance(shape, Structure | Form | StageResult):
        raise ValueError(f"{what} shape is {validation.short_repr(shape)}; give a StageResult, a Form or a Structure.")
    surface = surface_of(what, shape, part)
    # lines begin along sides of cells: the same ones, whatever the order of nodes in a cell
    terrain = Terrain(surface._replace(triangles=from_smallest(surface.triangles)), cut=True)
    structure = shape if isinstance(shape, Structure) else shape.structure
    names = list(structure.parts_of(Membrane)) if part is None else [part]
    stress, state = [stress_of(shape, name) for name in names], [states_of(shape, name) for name in names]
    members = np.repeat(np.arange(len(names)), [len(entry) for entry in state])
    return _Sheet(terrain, np.concatenate(stress), np.concatenate(state), members)


def _directed(sheet: _Sheet) -> NDArray[np.bool_]:
    """Cells whose stress has a direction, shape (cells,)."""
    e = plane_axes(sheet.terrain)
    a, b, c = (np.einsum("ki,kij,kj->k", e[:, i], sheet.stress, e[:, j]) for i, j in ((0, 0), (1, 1), (0, 1)))
    radius = np.hypot((a - b) / 2, c)
    return np.asarray(2 * radius > ISOTROPIC * (np.abs(a + b) / 2 + radius))


def _lines(
    sheet: _Sheet, allowed: NDArray[np.bool_], spacing: float, shortest: float, second: bool = False
) -> list[SurfaceLine]:
    allowed = allowed & sheet.terrain.sound
    if not allowed.any():
        return []
    along = field_of(sheet.terrain, sheet.stress, allowed, second, sheet.members)
    tracks = even_lines(sheet.terrain, along, allowed, spacing, shortest, sheet.members)
    return [SurfaceLine(track.points, track.cells) for track in tracks]
