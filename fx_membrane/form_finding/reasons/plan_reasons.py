"""Reasons for which a stress in plan leaves its plan, depends on the mesh, or has no form."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.sizes import measures
from ...model.structure import Structure
from ..balance.edge_balance import unbalanced_edge
from ..plan import Plan
from .axis_balance import unbalanced
from .edge_forces import weak_edges
from .no_form import causes, forces_in
from .unheld import free_edge, lone_point

Array = NDArray[np.float64]

SLOPED = 1e-6  # excess of the length of a cable over that in plan, above which its horizontal force is another
UNEVEN = 0.01  # range of a force over its mean, above which a constant one is not called balanced


def reasons_in_plan(
    structure: Structure,
    plans: Mapping[str, Plan],
    axes: Array,
    densities: Mapping[str, Array],
    given: Mapping[str, Array],
    kinds: Mapping[str, NDArray[Any]],
    problem: str,
    is_constrained: bool,
) -> str:
    """Add the reasons of a problem and its remedy, in words; empty where the form has neither.

    Args:
        structure: The structure.
        plans: Its membranes in plan.
        axes: Two axes of the plan and its normal as columns, shape (3, 3) [-].
        densities: Force densities of bars in the first step, by part, shape (cells,) [N/m].
        given: Those that are prescribed, zero where a force is, by part, shape (cells,) [N/m].
        kinds: Meaning of the prestress of each cell, one of `MEASURES`, by part, shape (cells,).
        problem: The problem in sentences; empty without one.
        is_constrained: True if nodes or cables have constraints, which may hold an edge.
    """
    lone = lone_point(structure, structure.points)
    if not problem:
        return f"it depends on the mesh. {causes(lone)}" if lone else ""
    weak = _weak(structure, plans, axes, densities, given, kinds)
    unheld = "" if is_constrained else free_edge(structure, structure.points)
    found = causes(weak, unheld, lone)
    return f"{problem} {found or _advice(structure, plans, axes, given)}".strip()


def _weak(
    structure: Structure,
    plans: Mapping[str, Plan],
    axes: Array,
    densities: Mapping[str, Array],
    given: Mapping[str, Array],
    kinds: Mapping[str, NDArray[Any]],
) -> str:
    """Tell of the edge cable that lacks most force in plan, in words; empty if none is too weak."""
    plane = axes[:, :2]
    flat = structure.points @ plane @ plane.T
    stresses = {name: plane @ plan.stress @ plane.T for name, plan in plans.items()}
    forces, told, sloped = dict[str, Array](), dict[str, Array](), False
    for name in forces_in(structure):
        cells, q = structure.parts[name].cells, densities[name]
        length, by_force = measures(structure.points, cells), kinds[name] == "force"
        forces[name] = q * measures(flat, cells)
        told[name] = np.where(by_force, q * length, forces[name])
        horizontal = kinds[name] == "horizontal force"
        sloped |= bool((horizontal & (q * length > forces[name] * (1 + SLOPED))).any())
    words = weak_edges(structure, flat, stresses, forces, given, told).words
    return f"{words}, as horizontal forces" if words and sloped else words


def _advice(structure: Structure, plans: Mapping[str, Plan], axes: Array, given: Mapping[str, Array]) -> str:
    """Sentences on the condition that a stress in plan misses, or on how to come nearer."""
    plane = axes[:, :2]
    for name, plan in plans.items():
        if missed := unbalanced(plan, structure.points @ plane, plane):
            return f'In part {name!r}, {missed} To keep the plan, hold its nodes in it, as by Support(nodes, "xy").'
    again = "start again from dataclasses.replace(structure, points=form.points)."
    varies, where = unbalanced_edge(structure, plans, axes)
    if varies > UNEVEN and not any(q.any() for q in given.values()):
        return (
            f"The stress pulls along the {where}, so no constant force balances it there: it must vary by "
            f'{100 * varies:.3g} %. Take cables="balanced force", with the mean force as prestress, and {again}'
        )
    if any(force.any() for force in forces_in(structure).values()):
        return f"Draw edges with cables as arcs, of radius force over stress; or {again}"
    return f"Give a stress that balances in plan, such as a constant one; or {again}"
