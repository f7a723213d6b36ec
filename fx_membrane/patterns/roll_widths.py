"""Widths of strips, for the roll that they are cut from."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from .split_mesh import pair
from .strip_shapes import laid_out, opened
from .strips import Strips


def strip_widths(strips: Strips) -> dict[str, float]:
    """Find the widths of strips across their axes by name, in a conformal map of the same area [m].

    Raises:
        ValueError: A strip folds when laid flat.
    """
    structure, found = strips.structure, {}
    for name in strips.names:
        within = {
            pair(a, b)
            for edge in strips.edges_of(name)
            if edge.strips == (name, name)
            for a, b in pairwise(edge.nodes.tolist())
        }
        disc = opened(np.asarray(strips.membrane(name).cells), within)
        found[name] = laid_out(name, structure.points, disc, structure.warp(name)).width
    return found
