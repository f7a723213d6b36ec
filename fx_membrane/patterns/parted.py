"""Structure whose membranes are parted into strips, with their warp, prestress and edges."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..geometry.sizes import measures, projected
from ..geometry.topology import boundary_edges
from ..model.chambers import Chamber
from ..model.parts import Membrane, Part
from ..model.structure import Structure
from ..model.term_parameters import names as parameters_of
from .cut_surface import Split, of_rows
from .split_mesh import Pair
from .strip_edges import edges_of_strips
from .strip_order import pieces
from .strip_shapes import check_disc, laid_out, opened
from .strips import Strips
from .surface_folds import refuse_folded

Array = NDArray[np.float64]
Integers = NDArray[np.int64]


NARROW = 0.02  # mean width over the largest of all strips, below which a strip is hardly meant


class NarrowStripWarning(UserWarning):
    """Strip far narrower than the others, as between two seams that nearly coincide."""


def in_strips(
    split: Split,
    parts: Sequence[str],
    names: Sequence[str] | None,
    roll_width: float | None,
    warp: Mapping[str, Array],
) -> Strips:
    """Part the membranes of a split structure into strips.

    Args:
        split: The structure, split along the seams.
        parts: Names of the membranes that are parted.
        names: Names of the strips, or None.
        roll_width: Largest width of a strip, or None [m].
        warp: Directions of the warp of some strips by name, each shape (3,).

    Raises:
        ValueError: A seam ends within a strip; a strip is no disc, folds, or is too wide; names do not fit; a strip
            with a warp does not exist, or its cells are normal to it.

    Warns:
        NarrowStripWarning: The mean width of a strip is less than 2 % of the largest one.
    """
    structure = split.structure
    _check_ends(structure, split.seams, parts)
    of_part = {name: pieces(structure.parts[name].cells, split.seams) for name in parts}
    given = _names(structure, {name: int(strip.max()) + 1 for name, strip in of_part.items()}, names)
    _check_warp(warp, [strip for strips in given.values() for strip in strips])
    made: dict[str, Part] = {}
    widths: dict[str, float] = {}
    seams = set(split.seams)
    for name, part in structure.parts.items():
        if name not in of_part:
            made[name] = part
            continue
        whole_part = _Sheet(structure.part(name, Membrane), structure.warp(name), structure.normals(name))
        for number, strip in enumerate(given[name]):
            rows = np.flatnonzero(of_part[name] == number)
            made[strip], widths[strip] = _strip(
                structure.points, whole_part, rows, strip, seams, roll_width, warp.get(strip)
            )
    _warn_of_narrow(structure.points, made, widths)
    whole = replace(
        structure,
        parts=made,
        separate=[both for pair_ in structure.separate for both in _pairs(given, *pair_)],
        terms=[other for term in structure.terms for other in _terms(given, term)],
        chambers={name: _chamber(given, chamber) for name, chamber in structure.chambers.items()},
    )
    order = [strip for strips in given.values() for strip in strips]
    numbers = np.repeat(np.arange(len(order)), [len(whole.parts[strip].cells) for strip in order])
    cells = np.concatenate([whole.parts[strip].cells for strip in order])
    membranes = {strip: name for name, strips in given.items() for strip in strips}
    return Strips(whole, edges_of_strips(whole, order, numbers, cells, seams), membranes=membranes)


def _check_ends(structure: Structure, seams: Mapping[Pair, int], parts: Sequence[str]) -> None:
    """Refuse seams that end within the surface."""
    meeting = Counter(node for edge in seams for node in edge)
    border = {node for name in parts for node in boundary_edges(structure.parts[name].cells).ravel().tolist()}
    for edge, number in seams.items():
        for node in edge:
            if meeting[node] == 1 and node not in border:
                raise ValueError(
                    f"seams, entry {number}, ends within the surface, at "
                    f"{validation.format_point(structure.points[node])}; lead it on to a border or to another seam."
                )


def _names(structure: Structure, counts: Mapping[str, int], names: Sequence[str] | None) -> dict[str, list[str]]:
    """Names of the strips of each membrane."""
    total = sum(counts.values())
    if names is None:
        found = {
            part: [part] if count == 1 else [f"{'strip' if len(counts) == 1 else part} {k + 1}" for k in range(count)]
            for part, count in counts.items()
        }
    else:
        given = list(validation.texts("names", names))
        if len(given) != total:
            raise ValueError(f"names has {len(given)} entries, for {total} strips; give one for each.")
        starts = np.cumsum([0, *counts.values()])
        found = {part: given[at : at + count] for (part, count), at in zip(counts.items(), starts, strict=False)}
    every = [name for strips in found.values() for name in strips]
    taken = [name for name in every if name in structure.parts and name not in counts]
    twice = [name for name, count in Counter(every).items() if count > 1]
    for name in [*taken, *twice]:
        raise ValueError(f"Two parts would have the name {name!r}; give others, names=[...].")
    return found


class _Sheet(NamedTuple):
    """Membrane, and the warp and normals of its cells, both of shape (cells, 3) [-]."""

    membrane: Membrane
    warp: Array
    normals: Array


def _strip(
    points: Array,
    sheet: _Sheet,
    rows: Integers,
    name: str,
    seams: set[Pair],
    roll_width: float | None,
    wanted: Array | None,
) -> tuple[Membrane, float]:
    """Strip with its warp, and the stress of the membrane that it is cut from; and its mean width [m]."""
    membrane, before, normal = sheet.membrane, sheet.warp[rows], sheet.normals[rows]
    found = opened(membrane.cells[rows], seams)
    check_disc(name, points, found)
    refuse_folded(name, points[found.nodes], found.triangles)
    layout = laid_out(name, points, found, before, None if wanted is None else _on_cells(name, wanted, normal))
    if roll_width is not None and layout.width > roll_width:
        where = validation.format_point(points[found.nodes].mean(axis=0))
        raise ValueError(
            f"Strip {name!r} around {where} is {layout.width:.4g} wide across its axis, more than the roll, "
            f"{roll_width:.4g}; set seams closer."
        )
    cut = replace(of_rows(membrane, membrane.cells[rows], rows), warp=layout.warp)
    cosine = np.sum(before * layout.warp, axis=1)
    sine = np.sum(np.cross(before, layout.warp) * normal, axis=1)
    turn = np.stack([np.stack([cosine, sine], axis=1), np.stack([-sine, cosine], axis=1)], axis=1)
    changes: dict[str, Any] = {}
    for entry, tensors in (("prestress", cut.prestress_tensors()), ("natural_stretch", cut.natural_tensors())):
        if not np.array_equal(tensors, tensors[:, :1, :1] * np.eye(2)):
            turned = turn @ tensors @ turn.transpose(0, 2, 1)
            changes[entry] = (turned + turned.transpose(0, 2, 1)) / 2 if entry == "prestress" else turned
    return replace(cut, **changes), float(measures(points, cut.cells).sum()) / layout.length


def _check_warp(warp: Mapping[str, Array], strips: Sequence[str]) -> None:
    """Refuse directions for strips that do not exist."""
    odd = [name for name in warp if name not in strips]
    if odd:
        raise ValueError(f"cut_strips warp: {odd[0]!r} is no strip; the strips are {list(strips)}.")


def _on_cells(name: str, direction: Array, normal: Array) -> Array:
    """Project the wanted warp of a strip on its cells, shape (k, 3) [-].

    Raises:
        ValueError: It is normal to one of them.
    """
    found = projected(np.broadcast_to(direction, normal.shape), normal)
    if not found.any(axis=1).all():
        raise ValueError(
            f"cut_strips warp: {direction.tolist()} is normal to a cell of strip {name!r}; give a direction that lies "
            "roughly in the strip."
        )
    return found


def _warn_of_narrow(points: Array, made: Mapping[str, Part], widths: Mapping[str, float]) -> None:
    widest = max(widths, key=lambda name: widths[name])
    for name, width in widths.items():
        if width < NARROW * widths[widest]:
            where = validation.format_point(points[made[name].cells].mean(axis=(0, 1)))
            warnings.warn(
                f"Strip {name!r} around {where} is {width:.3g} wide on average, and {widest!r} {widths[widest]:.3g}; "
                "move the seams beside it apart, or leave one out.",
                NarrowStripWarning,
                stacklevel=4,
            )


def _pairs(given: Mapping[str, list[str]], first: str, second: str) -> list[tuple[str, str]]:
    """Pairs of strips of a pair of parts."""
    return list(product(given.get(first, [first]), given.get(second, [second])))


def _chamber(given: Mapping[str, list[str]], chamber: Chamber) -> Chamber:
    """Chamber between the strips of its membranes."""
    parts: Any = chamber.parts
    if isinstance(parts, Mapping):
        named: Any = {strip: sense for name, sense in parts.items() for strip in given.get(name, [name])}
    else:
        named = [strip for name in parts for strip in given.get(name, [name])]
    return replace(chamber, parts=named)


def _terms(given: Mapping[str, list[str]], term: Any) -> list[Any]:
    """Term on the strips of its membrane."""
    if term.part not in given:
        return [term]
    per_cell = [name for name in parameters_of(term) if np.shape(getattr(term, name)) not in ((), (3,))]
    if getattr(term, "cells", None) is not None or per_cell:
        raise ValueError(
            f"Part {term.part!r} has a term with data for its cells, {type(term).__name__}, which strips cannot take; "
            "leave it out by dataclasses.replace(structure, terms=()), and give terms for the strips."
        )
    return [replace(term, part=strip) for strip in given[term.part]]
