"""Ends of an equilibrium path: a load factor, or a displacement of one component of a node."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..assembly.problem import Problem
from ..checks import validation
from ..solvers.base import LIMITS
from ..solvers.bordered_newton import Plane, Point


@dataclass(frozen=True)
class EndLimits:
    """Limits of the ends of a path.

    Attributes:
        near: Fraction of the distance from the last point: a point this close before an end is the end.
        largest: Largest load factor, or its reciprocal.
    """

    near: float = 1e-9
    largest: float = 1e9


ENDS = EndLimits()


def ends(
    problem: Problem,
    load_factor: float | None,
    displacement: tuple[int, str, float] | None,
    fixed: NDArray[np.bool_],
    shape: NDArray[np.float64],
) -> list[Plane]:
    """Planes in which a path ends.

    Args:
        problem: The problem.
        load_factor: The end; None for any.
        displacement: A node, a component and its displacement [m] at the end; None for any.
        fixed: Constrained components that do not move, shape (n, 3): they can be no end.
        shape: Displacement at the start, shape (n, 3) [m].

    Raises:
        ValueError: An argument has another form, or the component is fixed.
    """
    found = []
    if load_factor is not None:
        value = validation.positive("equilibrium_path load_factor", load_factor)
        if not 1 / ENDS.largest <= value <= ENDS.largest:
            raise ValueError(
                f"equilibrium_path load_factor is {value:g}; it must be between {1 / ENDS.largest:g} and "
                f"{ENDS.largest:g}: change the loads of the stage, or give None for a path without that end."
            )
        found.append(Plane(problem.discretization.create_vector(), 1.0, value))
    if displacement is not None:
        if not isinstance(displacement, tuple) or len(displacement) != 3:
            shown = validation.short_repr(displacement)
            raise ValueError(
                f'equilibrium_path displacement is {shown}; give (node, component, value), like (7, "z", -0.4).'
            )
        node = validation.indices("equilibrium_path displacement node", displacement[0])
        component = validation.components("equilibrium_path displacement component", displacement[1])
        if len(node) * len(component) > 1:
            raise ValueError(
                "equilibrium_path displacement names several components; give one node and one of x, y and z."
            )
        structure = problem.structure
        structure.check_nodes("equilibrium_path displacement", node)
        if fixed[node, component].any():
            raise ValueError(
                f"equilibrium_path displacement names component {'xyz'[component[0]]!r} of node {node[0]}, which is "
                "held and never moves; name one that is free, or that the stage moves."
            )
        chosen = np.zeros(structure.points.shape)
        chosen[node, component] = 1.0
        value = validation.number("equilibrium_path displacement value", displacement[2])
        size = structure.size
        if abs(value) > LIMITS.far * size:
            raise ValueError(
                f"equilibrium_path displacement value is {value:g}, more than {LIMITS.far:g} times the size of the "
                f"structure, {size:g}; give a displacement that it can reach."
            )
        begin = float(shape[node, component].item())
        here = abs(value - begin) <= LIMITS.rounding * size  # start of the path: it ends on return to that displacement
        found.append(Plane(problem.discretization.to_petsc(chosen), 0.0, begin if here else value))
    return found


def passed(last: Point, point: Point, ends: list[Plane]) -> tuple[Point, Plane] | None:
    """Find the first end between two points, and its approximate place; None if there is none."""
    found = []
    for end in ends:
        before, after = end.signed_distance(last), end.signed_distance(point)
        if before and after * np.sign(before) <= ENDS.near * abs(before):
            found.append((before / (before - after), end))
    if not found:
        return None
    share, end = min(found, key=lambda entry: entry[0])
    return last.moved(point.since(last), share), end
