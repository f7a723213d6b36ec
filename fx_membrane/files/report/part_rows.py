"""Rows of a report on parts: kind, size, material and prestress, as texts."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...model.materials import is_shipped
from ...model.structure import Structure
from ...results.plain_numbers import plain


def part_row(structure: Structure, name: str, force: str, length: str) -> dict[str, Any]:
    """Row of a part."""
    part = structure.parts[name]
    size, stretch = measures(structure.points, part.cells).sum(), part.natural_tensors()
    unit = part.stress_unit(force, length)
    natural = f"; natural stretch {_ends(stretch, 6)}" if (stretch - np.eye(part.dimension)).any() else ""
    return {
        "name": name,
        "kind": type(part).__name__,
        "cells": len(part.cells),
        "size": f"{plain(size)} {part.size_unit(length)}",
        "material": _material(part.material, force, f"{force}/{length}"),
        "prestress": f"{_ends(part.prestress_tensors(), 6)} {unit}{natural}",
    }


def _ends(tensors: NDArray[np.float64], digits: int) -> str:
    """Show the least and largest normal components of tensors of cells, shape (cells, d, d)."""
    values = tensors[:, range(tensors.shape[1]), range(tensors.shape[1])]
    return " / ".join(
        plain(least, digits) if least == most else f"{plain(least, digits)} to {plain(most, digits)}"
        for least, most in zip(values.min(axis=0), values.max(axis=0), strict=True)
    )


def _material(material: Any, force: str, stress: str) -> str:
    """Kind of a material and its numbers with units; a law of a user's own as it shows itself."""
    if not is_shipped(material):
        return repr(material)
    units = {"nu": "", "axial_stiffness": f" {force}"}
    numbers = {field.name: getattr(material, field.name) for field in fields(material)}
    told = [
        f"{name.replace('_', ' ')} = {plain(value, 6)}{units.get(name, f' {stress}')}"
        for name, value in numbers.items()
        if isinstance(value, float)
    ]
    return f"{type(material).__name__}: {', '.join(told)}"
