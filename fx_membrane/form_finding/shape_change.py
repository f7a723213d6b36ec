"""Change of shape in a step of form finding, beyond sliding of nodes, and collapse of cells."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.sizes import grown_slender, measures, normals
from ..geometry.topology import boundary_edges
from ..model.parts import Part
from ..model.structure import Structure
from .reasons.asked_structure import Asked
from .reasons.no_form import cause, established, possible
from .reasons.sewn_surfaces import cells_of
from .reasons.tangents import line_tangents, unit
from .reasons.unheld import lone_head

# Fraction of its first length, or of the root of its first area, below which a cell counts as collapsed.
GONE = 1e-3
GONE_MAST = 1e-2  # no sliding of nodes makes a mast short
STOPPED = "Form finding stopped at step"
HOLD = (
    "hold the mast head as a support in form finding, and add mast and stays by masts_and_stays: their forces "
    "balance the reactions of the form; or change the forces that meet there, or the first shape."
)


def change_of_shape(structure: Structure, points: NDArray[np.float64], displacement: NDArray[np.float64]) -> float:
    """Largest displacement beyond sliding in surfaces and along lines, over the mean length of the edges [-].

    Lines are those of cables and masts, and the edges of membranes. A seam between membranes of one stress is none: it
    may lie anywhere in the surface. No node slides where lines end, meet, or turn. Between these nodes the relative
    change of length of a cable or a mast counts too: it shows a short one that shrinks.
    """
    membranes, bars = structure.membranes.values(), structure.bars.values()
    lines = [*_rims(structure), *(bar.cells for bar in bars)]
    edges = [np.sqrt(2 * measures(points, part.cells)) for part in membranes]
    edges += [measures(points, bar.cells) for bar in bars]
    segments = np.unique(np.sort(np.concatenate(lines)), axis=0)  # a cable on the edge of a membrane is one line
    on_line = np.zeros(len(points), dtype=bool)
    on_line[segments] = True
    tangent = line_tangents(points, segments)

    def along(unit: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.sum(displacement * unit, axis=1, keepdims=True) * unit

    normal = unit(nodal_normals(structure, points))
    across = np.where(on_line[:, None], displacement - along(tangent), along(normal))
    largest = float(np.linalg.norm(across, axis=1).max() / np.concatenate(edges).mean())
    slides = np.any(tangent, axis=1)
    for part in structure.bars.values():
        free = part.cells[~slides[part.cells].any(axis=1)]
        ratio = measures(points + displacement, free) / measures(points, free)
        largest = max(largest, float(np.abs(ratio - 1).max(initial=0.0)))
    return largest


def _rims(structure: Structure) -> list[NDArray[np.int64]]:
    """Edges of membranes, without seams between those of one stress, each of shape (k, 2)."""
    alike: dict[bytes, list[str]] = {}
    for name, part in structure.membranes.items():
        stress = part.prestress_tensors()
        key = stress[0].tobytes() if (stress == stress[0]).all() else name.encode()
        alike.setdefault(key, []).append(name)
    return [boundary_edges(cells_of(structure, names)) for names in alike.values()]


def check_collapse(structure: Structure, points: NDArray[np.float64], step: int, asked: Asked | None = None) -> None:
    """Refuse a shape with a collapsed cell, or with a cable or a mast that grows without bound.

    Args:
        structure: The first shape.
        points: Positions of the nodes now, shape (n, 3) [m].
        step: Number of the step, for the message.
        asked: The structure with what its constraints ask for, for the message; without constraints if not given.

    Raises:
        RuntimeError: A cell has collapsed or grown without bound; the message names the part, the cell and the remedy.
    """
    if not np.isfinite(points).all():
        raise RuntimeError(collapse(structure, step, asked=asked))
    torn = False
    for name, part in structure.parts.items():
        first, now = measures(structure.points, part.cells), measures(points, part.cells)
        gone = now < (GONE_MAST if part.is_strut else GONE) ** part.dimension * first
        if name in structure.bars:
            for cell in np.flatnonzero(gone | (now * GONE > first))[:1]:
                force = part.prestress_tensors()[cell, 0, 0]
                words = _unbalanced(structure, step, name, part, int(cell), force, first[cell], now[cell])
                reason = "" if part.is_strut else established(structure, structure.points, asked)
                raise RuntimeError(f"{words} {reason}".strip())
        torn |= bool(gone.any()) or len(grown_slender(points, part.cells, structure.points)) > 0
    if torn:  # after the bars, a possible cause of it
        raise RuntimeError(collapse(structure, step, points, asked))


def collapse(
    structure: Structure, step: int, points: NDArray[np.float64] | None = None, asked: Asked | None = None
) -> str:
    """Sentences on a shape without equilibrium; free masts, a possible cause, come first."""
    for name, part in structure.parts.items():
        if part.is_strut:
            force = part.prestress_tensors()[:, 0, 0]
            free = ~np.all(structure.supported, axis=1)[part.cells].all(axis=1)
            for cell in np.flatnonzero(free & (force < 0))[:1]:
                length = measures(structure.points, part.cells[[cell]])[0]
                return (
                    f"{STOPPED} {step}: the shape collapses. The mast in cell {cell} of part "
                    f"{name!r}, of the length {length:.4g} and the force {force[cell]:g}, has a free end; no form was "
                    f"found that balances the forces there; {HOLD}"
                )
    reason = cause(structure, structure.points, asked, points) or possible(structure)
    where = "" if points is None else _where(structure, points)
    remedy = "Change the prestress or the supports."
    return f"{STOPPED} {step}: the shape collapses{where}. {reason} {remedy}"


def _where(structure: Structure, points: NDArray[np.float64]) -> str:
    """Tell of the cell of a membrane that has shrunk most."""
    least, words = np.inf, ""
    if not np.isfinite(points).all():
        return words
    for name, part in structure.membranes.items():
        share = measures(points, part.cells) / measures(structure.points, part.cells)
        cell = int(share.argmin())
        if share[cell] < least:
            where = validation.format_point(points[part.cells[cell]].mean(axis=0))
            least, words = share[cell], f" around cell {cell} of part {name!r}, {where}"
    return words


def _unbalanced(
    structure: Structure, step: int, name: str, part: Part, cell: int, force: float, first: float, now: float
) -> str:
    kind = "mast" if part.is_strut else "cable"
    fate = "shrinks to a point" if now < first else "grows without bound"
    remedy = "change its force, the forces that meet at its ends, or the loads; or hold its ends by supports."
    if kind == "mast":
        remedy = HOLD if force else f"give it a force as prestress, or {HOLD}"
        free = ~np.all(structure.supported, axis=1)[part.cells[cell]]
        if free.any() and (lone := lone_head(structure, int(part.cells[cell][free][0]))):
            remedy = f"{lone[:1].lower()}{lone[1:]}; then add the mast there by masts_and_stays."
    return (
        f"{STOPPED} {step}: the {kind} in cell {cell} of part {name!r}, with the force {force:g}, "
        f"{fate} (its length was {first:.4g} and is {now:.3g}): no length was found that balances the forces at its "
        f"ends; {remedy}"
    )


def nodal_normals(structure: Structure, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of the normals of the cells at each node, all to the side of one of them, shape (n, 3) [-].

    Adjoining membranes may have different senses, and a Moebius strip has none.
    """
    total, side = np.zeros_like(points), np.zeros_like(points)
    surfaces = [part.cells for part in structure.membranes.values()]
    for triangles in surfaces:
        side[triangles] = normals(points, triangles)[:, None]
    for triangles in surfaces:
        normal = normals(points, triangles)
        for corner in triangles.T:
            turned = np.sum(normal * side[corner], axis=1, keepdims=True) < 0
            np.add.at(total, corner, np.where(turned, -normal, normal))
    return total
