"""Form finding of a case, step by step: prepared, so that faults are found at once, then done."""

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
from ...model.parts import Membrane
from ...model.structure import Structure
from ...model.supports import Support
from .choices import Nodes, Outline, given
from .faults import nearest
from .form_schema import NewMesh, StressModel

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


def method_step(
    table: Any, structure: Structure, loads: Sequence[Any], constraints: Sequence[Any], axes: Mapping[str, Any]
) -> Step:
    """Prepare a method on the whole structure.

    Args:
        table: Its table.
        structure: The structure, for its names.
        loads: Its loads.
        constraints: Its constraints.
        axes: By membrane, the axis of its radial warp.

    Raises:
        ValueError: The method takes no constraints; an option is out of range; a name is that of no membrane.
    """
    method = METHODS[table.method]
    options = given(table, "method", "loads", "constraints", "stress", "net", "supports")
    for name in options.keys() & CHECKS.keys():
        CHECKS[name](name, options[name])
    check_constraints(table)
    if constraints:
        options["constraints"] = list(constraints)
    if getattr(table, "stress", None):
        options["stress"] = {name: _stress(name, entry, structure) for name, entry in table.stress.items()}
    if axes and "warp" in inspect.signature(method).parameters:
        options["warp"] = dict(axes)

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
        branches: Name of the part, empty for lines that make none; pairs of nodes, shape (n, 2); force densities.
        supports: Held nodes.
        loads: Loads on the nodes, shape (nodes, 3) [N].

    Raises:
        ValueError: There is no branch, or the force densities of one are not as many as its cells.
    """
    if not branches:
        raise ValueError("net is empty; add branches")
    pairs = np.vstack([cells for _, cells, _ in branches])
    densities = np.concatenate([_densities(values, len(cells)) for _, cells, values in branches])
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


def _stress(name: str, table: StressModel, structure: Structure) -> RadialStress:
    membranes = structure.parts_of(Membrane)
    if name not in membranes:
        raise ValueError(f"stress names {name!r}, which is no membrane{nearest(name, membranes)}")
    if not table.terms:
        raise ValueError(f"stress of {name!r} has no terms; add one")
    terms = tuple((term.values, validation.positive("at", term.at), term.power) for term in table.terms)
    return RadialStress(RadialDirection(table.origin, table.axis), terms)


def _densities(values: Any, count: int) -> NDArray[np.float64]:
    found = np.asarray(values, dtype=np.float64)
    if found.shape not in ((), (count,)):
        raise ValueError(f"density has shape {found.shape}; give a number, or one for each of the {count} branches")
    return np.broadcast_to(found, count)
