"""Summary of a state as plain data: sums of forces, extremes of each part with their cell and place, remarks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..geometry.extremes import first_largest
from .chamber_tables import chambers_summary
from .reader_words import for_readers
from .states import StageResult
from .water_words import event_summary, pond_summary


def summary(result: StageResult) -> dict[str, Any]:
    """Summary of a state, in dictionaries, lists, texts and numbers that JSON has."""
    size = np.linalg.norm(result.displacement, axis=1)
    node = first_largest(size)
    balance = result.equilibrium
    return {
        "remarks": [for_readers(remark) for remark in result.remarks],
        "increments": [
            {
                "load factor": increment.load_factor,
                "outcome": increment.outcome.name,
                "iterations": increment.total_iterations,
            }
            | ({"chambers": chambers_summary(increment.chambers)} if increment.chambers else {})
            | ({"water events": [event_summary(event) for event in increment.events]} if increment.events else {})
            for increment in result.increments
        ],
        "energy": result.energy,
        "sum of loads": balance.loads.tolist(),
        "sum of reactions": balance.reactions.tolist(),
        "largest unbalanced force": balance.residual,
        "largest displacement": {
            "value": float(size[node]),
            "node": node,
            "place": result.structure.points[node].tolist(),
        },
        "ponds": [pond_summary(entry) for entry in result.ponds],
        "parts": {name: _part(result, name) for name in result.parts},
    } | ({"chambers": chambers_summary(result.chambers)} if result.chambers else {})


def _part(result: StageResult, name: str) -> dict[str, Any]:
    found = result.parts[name]
    told: dict[str, Any] = {"kind": type(result.structure.parts[name]).__name__, "cells": len(found.strain)}
    if name in result.actions.natural:
        told["natural stretch"] = _range(np.linalg.svd(_natural(result, name), compute_uv=False))
    if name in result.actions.prestress:
        told["prestress factor"] = _range(result.actions.prestress[name])
    if result.structure.parts[name].shares_tension:
        rope = result.rope(name)
        told |= {"length": rope.length, "unstressed length": rope.unstressed_length}
    if name in result.bars:
        bar = result.bars[name]
        return told | {"slack cells": int(bar.slack.sum()), "force": _extremes(result, name, bar.force)}
    found = result.membranes[name]
    told |= {f"{state} cells": int((found.state == state).sum()) for state in ("taut", "wrinkled", "slack")}
    told["principal stress I"] = _extremes(result, name, found.principal[:, 0])
    told["principal stress II"] = _extremes(result, name, found.principal[:, 1])
    if getattr(result.structure.parts[name], "warp", None) is not None:
        told["stress along warp"] = _extremes(result, name, found.warp_weft_stress[:, 0])
        told["stress along weft"] = _extremes(result, name, found.warp_weft_stress[:, 1])
    return told


def _natural(result: StageResult, name: str) -> NDArray[np.float64]:
    """Natural shape of the cells of a part: A of `forms.natural_shape`, shape (cells, d, d) [-]."""
    less = result.actions.natural[name]
    return np.asarray(np.eye(less.shape[1]) + less)


def _range(values: NDArray[np.float64]) -> list[float]:
    return [float(values.min()), float(values.max())]


def _extremes(result: StageResult, name: str, values: NDArray[np.float64]) -> dict[str, Any]:
    return {
        "least": _at(result, name, values, first_largest(-values)),
        "largest": _at(result, name, values, first_largest(values)),
    }


def _at(result: StageResult, name: str, values: NDArray[np.float64], cell: int) -> dict[str, Any]:
    place = result.structure.points[result.structure.parts[name].cells[cell]].mean(axis=0)
    return {"value": float(values[cell]), "cell": cell, "place": place.tolist()}
