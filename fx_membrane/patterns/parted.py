"""Structure whose membranes are parted into strips, with their warp, prestress and edges."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
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


def in_strips(split: Split, parts: Sequence[str], names: Sequence[str] | None, roll_width: float | None) -> Strips:
    """Part the membranes of a split structure into strips.

    Args:
        split: The structure, split along the seams.
        parts: Names of the membranes that are parted.
        names: Names of the strips, or None.
        roll_width: Largest width of a strip, or None [m].

    Raises:
        ValueError: A seam ends within a strip; a strip is no disc, folds, or is too wide; names do not fit.
    """
    structure = split.structure
    _check_ends(structure, split.seams, parts)
    of_part = {name: pieces(structure.parts[name].cells, split.seams) for name in parts}
    given = _names(structure, {name: int(strip.max()) + 1 for name, strip in of_part.items()}, names)
    made: dict[str, Part] = {}
    seams = set(split.seams)
    for name, part in structure.parts.items():
        if name not in of_part:
            made[name] = part
            continue
        whole_part = _Sheet(structure.part(name, Membrane), structure.warp(name), structure.normals(name))
        for number, strip in enumerate(given[name]):
            rows = np.flatnonzero(of_part[name] == number)
            made[strip] = _strip(structure.points, whole_part, rows, strip, seams, roll_width)
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
    return Strips(whole, edges_of_strips(whole, order, numbers, cells, seams))


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
    points: Array, sheet: _Sheet, rows: Integers, name: str, seams: set[Pair], roll_width: float | None
) -> Membrane:
    """Strip with its warp, and the stress of the membrane that it is cut from."""
    membrane, before, normal = sheet.membrane, sheet.warp[rows], sheet.normals[rows]
    found = opened(membrane.cells[rows], seams)
    check_disc(name, points, found)
    refuse_folded(name, points[found.nodes], found.triangles)
    layout = laid_out(name, points, found, before)
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
    return replace(cut, **changes)


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
