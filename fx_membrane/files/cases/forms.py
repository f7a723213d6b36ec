"""Form finding of a case, step by step: prepared, so that faults are found at once, then done."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import (
    Form,
    RadialDirection,
    force_density,
    masts_and_stays,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    remeshed,
    updated_reference,
)
from ...checks import validation
from ...model.supports import Support
from .choices import Nodes, Outline
from .faults import Faults, Unknown, Wrong, at_key
from .form_schema import NewMesh, StressModel
from .table import BROKEN, given, is_whole

METHODS: dict[str, Callable[..., Form]] = {
    "force density": force_density,
    "projected stress": projected_stress,
    "natural force density": natural_force_density,
    "prescribed stress": prescribed_stress,
    "updated reference": updated_reference,
}
CHECKS: dict[str, Callable[..., Any]] = {
    "tolerance": validation.positive,
    "max_iterations": validation.positive_integer,
    "iterations": validation.positive_integer,
    "direction": validation.direction,
}
Step = Callable[[Outline], Outline]


@dataclass(frozen=True)
class RadialStress:
    """Stress as a sum of powers of the distance from an axis, a function of place.

    Attributes:
        direction: The axis.
        terms: Values, number or pair along warp and weft [N/m]; distance at which they hold [m]; power [-].
    """

    direction: RadialDirection
    terms: tuple[tuple[Any, float, float], ...]

    def __call__(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give the stress at places of shape (3, n) [m], shape (n,) or (n, 2) [N/m]."""
        distance = np.linalg.norm(self.direction.arms(x.T), axis=1)
        return np.asarray(sum(np.multiply.outer((distance / at) ** power, values) for values, at, power in self.terms))


def check_options(faults: Faults, trail: tuple[str | int, ...], table: Any) -> None:
    """Check the options of a method, each apart."""
    for name, value in given(table).items():
        if name in CHECKS and value is not BROKEN:
            with faults.at(*trail, name):
                CHECKS[name](name, value)


def method_step(
    table: Any, loads: Sequence[Any], constraints: Sequence[Any], stress: Mapping[str, Any], warp: Mapping[str, Any]
) -> Step:
    """Prepare a method on the whole structure.

    Args:
        table: Its table.
        loads: Its loads.
        constraints: Its constraints.
        stress: By membrane, its stress as a function of place.
        warp: By membrane, the direction of its warp in space, away from an axis or along geodesics.
    """
    method = METHODS[table.method]
    options = given(table, "method", "loads", "constraints", "stress", "geodesics", "net", "supports")
    if constraints:
        options["constraints"] = list(constraints)
    if stress:
        options["stress"] = dict(stress)
    if warp and "warp" in inspect.signature(method).parameters:
        options["warp"] = dict(warp)

    def act(outline: Outline) -> Outline:
        form = method(outline.structure, list(loads), **options)
        return Outline(form.structure, form, outline.renumbered)

    return act


def check_constraints(table: Any) -> None:
    """Refuse constraints of force densities: the net of these is of several parts, and constraints name one.

    Raises:
        ValueError: There are some.
    """
    if table.constraints and table.method == "force density":
        raise ValueError(
            f"method {table.method!r} takes no constraints in a case file; leave them out, take a method of stress, as "
            "'projected stress', or write a script"
        )


def density_step(
    branches: Sequence[tuple[str, Nodes, Any]], supports: Sequence[Support], loads: NDArray[np.float64]
) -> Step:
    """Prepare a net of force densities.

    Args:
        branches: Name of the part, empty for lines that make none; pairs of nodes, shape (n, 2); force
            densities, shape (n,).
        supports: Held nodes.
        loads: Loads on the nodes, shape (nodes, 3) [N].

    Raises:
        ValueError: There is no branch.
    """
    if not branches:
        raise Wrong("it is empty; add branches", "net")
    pairs = np.vstack([cells for _, cells, _ in branches])
    densities = np.concatenate([values for *_, values in branches])
    used = np.unique(pairs)

    def act(outline: Outline) -> Outline:
        structure = outline.structure
        row = np.full(len(structure.points), -1)
        row[used] = np.arange(len(used))
        held = [(np.intersect1d(entry.nodes, used), entry.components) for entry in supports]
        fixed = [Support(row[nodes], components) for nodes, components in held if len(nodes)]
        found = force_density(structure.points[used], row[pairs], densities, fixed, loads[used])
        points, reactions = structure.points.copy(), np.zeros(structure.points.shape)
        points[used], reactions[used] = found.points, found.reactions
        starts = np.cumsum([0, *(len(cells) for _, cells, _ in branches)])
        forces = {
            name: found.forces["net"][start : start + len(cells)]
            for (name, cells, _), start in zip(branches, starts, strict=False)
            if name
        }
        parts = {
            name: replace(part, prestress=forces[name]) if name in forces else part
            for name, part in structure.parts.items()
        }
        made = replace(structure, points=points, parts=parts)
        return Outline(made, Form(points, forces, reactions, made=made), outline.renumbered)

    return act


def masts_step(bars: Mapping[str, Any], points: Any, heads: Nodes | None, components: str | None) -> Step:
    """Prepare masts and stays."""
    options: dict[str, Any] = {} if components is None else {"components": components}

    def act(outline: Outline) -> Outline:
        assert outline.form is not None
        form = masts_and_stays(outline.form, bars, points, heads, **options)
        return Outline(form.structure, form)

    return act


def mesh_step(table: NewMesh, keep: Nodes) -> Step:
    """Prepare a new mesh."""

    def act(outline: Outline) -> Outline:
        made = remeshed(outline.form or outline.structure, table.size, keep).structure
        form = Form(made.points, {}, np.zeros(made.points.shape), made=made)
        return Outline(made, form, renumbered=True)

    return act


def stress_of(table: StressModel) -> RadialStress:
    """Make a stress.

    Raises:
        ValueError: It has no term, or a distance that is not positive.
        Unknown: It has a fault.
    """
    if not is_whole(table):
        raise Unknown
    if not table.terms:
        raise Wrong("terms is empty; add one", "terms")
    for row, term in enumerate(table.terms):
        with at_key("terms", row, "at"):
            validation.positive("at", term.at)
    with at_key("axis"):
        direction = RadialDirection(table.origin, table.axis)
    return RadialStress(direction, tuple((term.values, term.at, term.power) for term in table.terms))


def densities_of(values: Any, count: int) -> NDArray[np.float64]:
    """Force densities of some branches, shape (count,) [N/m].

    Raises:
        ValueError: They are not as many.
    """
    found = np.asarray(values, dtype=np.float64)
    if found.shape not in ((), (count,)):
        raise ValueError(f"it has shape {found.shape}; give a number, or one for each of the {count} branches")
    return np.broadcast_to(found, count)
