"""Scene as plain data, which the page reads: shapes once per stage, values once per stage and field."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...model.parts import Membrane
from ...model.structure import Structure
from ...plot.colour_scale import STATES
from ...plot.scene import FABRIC, INK, MAST
from ...results.reader_words import for_readers
from .coarsening import coarser
from .field_data import described, encoded, fields
from .view_data import Shown, views

MAX_TRIANGLES = 100_000  # triangles that a browser turns without waiting
FAR_ORIGIN = 10  # sizes of a structure from zero, beyond which coordinates are told from an origin of their own
ARROWS = 400  # forces drawn at once; more hide the structure


def document(shown: Shown, title: str, force: str, length: str) -> dict[str, Any]:
    """Scene as plain data that JSON has: dictionaries, lists, texts and numbers."""
    structure, seen = views(shown, force, length)
    membranes = {name: part.cells for name, part in structure.parts_of(Membrane).items()}
    drawn = coarser(structure.points, membranes, MAX_TRIANGLES)
    for name, part in structure.parts.items():
        drawn.setdefault(name, (np.arange(len(part.cells)), part.cells))
    kept = {name: numbers for name, (numbers, _) in drawn.items()}
    every = fields(structure, seen, length)
    nodes = np.flatnonzero(_drawn(structure, [corners for _, corners in drawn.values()]))
    middle = structure.points[nodes].mean(axis=0)
    origin = np.where(
        np.abs(middle) > FAR_ORIGIN * structure.size, middle.round(), 0.0
    )  # there float32 has no digits left
    return {
        "title": title,
        "force": force,
        "length": length,
        "colours": {"ink": INK, "mast": MAST, "fabric": FABRIC, "states": list(STATES.values())},
        "origin": origin.tolist(),
        "nodes": encoded(nodes, "i4"),
        "points": encoded(structure.points[nodes] - origin, "f4"),
        "supports": encoded(structure.supported[nodes] @ [1, 2, 4], "u1"),
        "coarse": _coarse(membranes, kept),
        "parts": [
            {
                "name": name,
                "kind": type(part).__name__.lower(),
                "cells": encoded(np.searchsorted(nodes, drawn[name][1]), "i4"),
                "numbers": encoded(kept[name], "i4"),
            }
            for name, part in structure.parts.items()
        ],
        "fields": [{"name": field.name, "unit": field.unit, "group": field.group} for field in every],
        "stages": [
            {
                "name": view.name,
                "notes": list(view.notes),
                "remarks": [for_readers(remark) for remark in view.remarks],
                "displacement": None if view.displacement is None else encoded(view.displacement[nodes], "f4"),
                "loads": _forces(view.loads, nodes),
                "reactions": _forces(view.reactions, nodes),
                "fields": [described(field, structure, view, kept) for field in every],
            }
            for view in seen
        ],
    }


def _drawn(structure: Structure, corners: list[NDArray[np.int64]]) -> NDArray[np.bool_]:
    """Nodes to draw: those of drawn cells, and supported ones, shape (n,)."""
    drawn = structure.supported.any(axis=1) & structure.used
    for rows in corners:
        drawn[rows] = True
    return drawn


def _coarse(membranes: Mapping[str, Any], kept: Mapping[str, Any]) -> str:
    every, drawn = (sum(len(found[name]) for name in membranes) for found in (membranes, kept))
    if drawn == every:
        return ""
    return f"Drawn with {drawn} of {every} triangles; least and largest values are of all."


def _forces(forces: NDArray[np.float64], nodes: NDArray[np.int64]) -> dict[str, Any]:
    """Pick the forces to draw as arrows: at most `ARROWS` of the drawn nodes, the largest among them."""
    size = np.linalg.norm(forces[nodes], axis=1)
    there = np.flatnonzero(np.isfinite(size) & (size > 1e-9 * np.max(size, initial=0.0, where=np.isfinite(size))))
    step = -(-len(there) // ARROWS) or 1
    if len(there):
        there = there[int(size[there].argmax()) % step :: step]
    return {"of": step, "nodes": encoded(there, "i4"), "vectors": encoded(forces[nodes[there]], "f4")}
