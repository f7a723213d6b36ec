"""Structure with the forces and the held nodes that constraints ask for, to tell of its edges."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...model.structure import Structure
from ...model.supports import Support
from ..balance.constrained_balance import ConstrainedBalance

AMPLE = 10.0  # force of a cable of given geometry, over the largest stress times the size: no rule calls it too weak.
# An edge along the whole size needs half the stress times the size; edges that share a right angle need 0.7 of it.


class Asked(NamedTuple):
    """Structure as its constraints ask for it.

    Attributes:
        structure: The structure, with nodes of constraints as supports, and cables with the forces of constraints in
            the first shape. A cable of given geometry, whose force is found, has an ample one.
        densities: By cable, force density of its cells that are given by it, zero of others, shape (cells,) [N/m].
        found: By cable, its cells of given geometry, shape (cells,).
    """

    structure: Structure
    densities: Mapping[str, NDArray[np.float64]]
    found: Mapping[str, NDArray[np.bool_]] = MappingProxyType({})


def as_asked(structure: Structure, balance: ConstrainedBalance) -> Asked:
    """Put the constraints of a balance into its structure."""
    parts, targets = dict(structure.parts), balance.targets
    found = {name: np.zeros(len(bar.cells), dtype=bool) for name, bar in targets.bars.items()}
    tensors = [part.prestress_tensors() for part in structure.membranes.values()]
    stress = max((float(np.abs(each).max()) for each in tensors), default=0.0)
    densities = targets.by_force(structure.points)
    for name, bar in targets.bars.items():
        force = densities[name] * measures(structure.points, bar.cells)
        for of, line, *_ in targets.targets:
            if of == name:
                found[name][line.cells] = True
                force[line.cells] = np.maximum(force[line.cells], AMPLE * stress * structure.size or 1.0)
        parts[name] = replace(bar, prestress=force)
    nodes = np.flatnonzero(balance.motions.guided)
    supports = [*structure.supports, *([Support(nodes)] if len(nodes) else [])]
    return Asked(replace(structure, parts=parts, supports=supports), targets.by_density(structure.points), found)
