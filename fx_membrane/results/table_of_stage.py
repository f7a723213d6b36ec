"""Report of a stage: iterations, forces, stresses, strains, states, reactions and their balance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..checks import validation
from ..checks.values import counted
from ..geometry.extremes import first_largest
from ..model.parts import Line, Membrane
from ..model.restraint import loose_ends
from ..model.term_parameters import described
from ..solvers.outcome import Outcome
from .chamber_tables import chamber_lines
from .initial_stress import prestress
from .states import StageResult
from .strain_limits import elastic_strain
from .water_words import event_lines, pond_lines


def report(
    result: StageResult, nodes: Sequence[int] = (), *, first: int = 0, force_unit: str = "N", length_unit: str = "m"
) -> str:
    """Table of a stage, to print.

    It begins with the remarks on the state, if any. For each part it gives the minimum and maximum: forces of cables
    and masts, principal stresses of membranes and, with a given warp, stresses along warp and weft. Then follows the
    largest strain, from the natural shape where there is one, or else from the reference shape. If the law has a
    compliance, the elastic strain of the prestress is added. The number of slack or wrinkled cells and free cable ends
    come last. Largest values (in masts of either sign) come with their cell and its centroid in the reference shape.
    The cell is a row of the part's cells. The largest displacement is the length of a vector.

    Each energy term has a line with the sum of its forces, which is part of the sum of loads. Each chamber has a line
    with its volume, its pressure above the air around, and dp/dV.

    No number is converted: a structure in kN and m gives a report in kN and m, labelled by the names of the units.

    Args:
        result: A stage.
        nodes: Nodes whose reactions are listed.
        first: Printed number of node 0.
        force_unit: Name of the force unit of the structure and its loads, printed after forces.
        length_unit: Name of the length unit, printed after lengths.

    Returns:
        The lines, without a line end after the last.

    Raises:
        ValueError: The result is not that of a stage; a node does not exist; first is not a whole number; the name of a
            unit is not a text.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> state = Analysis(rope).run([Stage("pull", [PointLoad(1, (0, 0, -10.0))])])["pull"]
        >>> print(report(state, nodes=[1]).splitlines()[0])
        Stage 'pull', iterations per increment: [3]; units as given: N, m
    """
    validation.instance("The first argument of report", result, StageResult)
    listed = validation.indices("nodes", nodes, empty=True)
    validation.in_range("nodes", listed, len(result.structure.points), "node")
    first = validation.integer("first", first)
    force_unit, length_unit = validation.text("force_unit", force_unit), validation.text("length_unit", length_unit)
    iterations = [len(increment.iterations) - 1 for increment in result.increments]
    more = sum(increment.extra_iterations for increment in result.increments)
    outcomes = {increment.outcome for increment in result.increments}
    remarks = ", stabilized first" * (Outcome.STABILIZED in outcomes) + f" ({counted(more, 'iteration')} more)" * bool(
        more
    )
    remarks += ", not stable" * (Outcome.UNSTABLE in outcomes)
    units = f"units as given: {force_unit}, {length_unit}"
    lines = [f"WARNING: {remark}" for remark in result.remarks]
    lines += [f"Stage {result.name!r}, iterations per increment: {iterations}{remarks}; {units}"]
    width = max(map(len, result.parts)) + 2
    for name in result.parts:
        said = _part(result, name, first, force_unit, length_unit)
        lines += [f"  {name if not row else '':{width}}{text}" for row, text in enumerate(said)]
    size = np.linalg.norm(result.displacement, axis=1)
    lines.append(f"  largest displacement {size.max():.6g} {length_unit}, at node {first_largest(size) + first}")
    for node in listed:
        lines.append(f"  reaction at node {node + first}: {_vector(result, result.reactions[node])} {force_unit}")
    return "\n".join(lines + chamber_lines(result, force_unit, length_unit) + _balance(result, force_unit, length_unit))


def _part(result: StageResult, name: str, first: int, force_unit: str, length_unit: str) -> list[str]:
    membranes, bars = result.structure.membranes, result.structure.bars
    if name in membranes:
        return _membrane(result, name, membranes[name], force_unit, length_unit)
    return _bars(result, name, bars[name], first, force_unit, length_unit)


def _rope(result: StageResult, name: str, force_unit: str, length_unit: str) -> list[str]:
    found = result.rope(name)
    tension = f"{found.tension:12.6g} {force_unit}, tension of the rope{', slack' if found.slack[0] else ''}"
    return [tension, f"length {found.length:.6g}, without stress {found.unstressed_length:.6g} {length_unit}"]


def _bars(result: StageResult, name: str, given: Line, first: int, force_unit: str, length_unit: str) -> list[str]:
    if given.shares_tension:
        return _rope(result, name, force_unit, length_unit)
    part, before = result.parts[name], elastic_strain(given, prestress(result.structure, name, result.actions))
    force = part.principal[:, 0]
    slack = "" if given.is_strut else f", {part.slack.sum()} of {len(part.slack)} cells slack"
    where = _where(result, name, np.abs(force) if given.is_strut else force)
    ends = loose_ends(result.structure, name, result.actions.held)
    hanging = [f"free ends: {len(ends)}, first cell {ends[0][0]} at node {ends[0][1] + first}"] if ends else []
    total = part.strain + (0.0 if before is None else before[:, 0, 0])
    size = np.abs(total) if given.is_strut else total
    natural = name in result.actions.natural
    kind = f"strain from the {'natural' if natural else 'reference'} shape"
    kind = kind if before is None else "strain with that of the prestress"
    strained = f"largest {kind} {total[first_largest(size)]:.5f} {_where(result, name, size)}"
    return [f"{_range(force)} {force_unit}, largest {where}{slack}", strained, *hanging]


def _membrane(result: StageResult, name: str, given: Membrane, force_unit: str, length_unit: str) -> list[str]:
    part, before = result.membrane(name), elastic_strain(given, prestress(result.structure, name, result.actions))
    states = ", ".join(f"{(part.state == state).sum()} {state}" for state in ("taut", "wrinkled", "slack"))
    strain = np.linalg.eigvalsh(part.strain)[:, 1]
    whole = []
    if before is not None:
        largest = np.linalg.eigvalsh(part.strain + before)[:, 1]
        where = _where(result, name, largest)
        whole = [f"largest principal strain with that of the prestress {largest.max():.5f} {where}"]
    stress, unit = part.principal[:, 0], f"{force_unit}/{length_unit}"
    directions = zip(("warp", "weft"), part.warp_weft_stress.T, strict=True) if given.warp is not None else ()
    return [
        f"{_range(stress)} {unit}, principal stress I, largest {_where(result, name, stress)}",
        f"{_range(part.principal[:, 1])} {unit}, principal stress II",
        *(
            f"{_range(force)} {unit}, along {direction}, largest {_where(result, name, force)}"
            for direction, force in directions
        ),
        f"largest principal strain {strain.max():.5f} {_where(result, name, strain)}; cells: {states}",
        *whole,
    ]


def _where(result: StageResult, name: str, values: NDArray[np.floating[Any]]) -> str:
    """Name the cell of a part with the largest value, and its place."""
    cell = first_largest(values)
    centroid = result.structure.points[result.structure.parts[name].cells[cell]].mean(axis=0)
    return f"in cell {cell} at ({', '.join(f'{x + 0.0:.4g}' for x in centroid)})"


def _balance(result: StageResult, force_unit: str, length_unit: str) -> list[str]:
    balance = result.equilibrium
    force = np.abs(balance.loads + balance.reactions).max()
    moment = np.abs(balance.load_moment + balance.reaction_moment).max()
    loads, reactions = _vector(result, balance.loads), _vector(result, balance.reactions)
    return [
        *(f"  {line}" for entry in result.ponds for line in pond_lines(entry, length_unit)),
        *(f"  {line}" for line in event_lines(result, length_unit)),
        *(
            f"  {described(entry.term)}: sum of forces {_vector(result, entry.forces.sum(axis=0))} {force_unit}"
            for entry in result.terms
        ),
        f"  sum of loads {loads}, of reactions {reactions} {force_unit}",
        f"  they balance to {force:.0e} {force_unit}, moments to {moment:.0e} {force_unit} {length_unit}; "
        f"largest unbalanced nodal force {balance.residual:.0e} {force_unit}",
    ]


def _range(values: NDArray[np.float64]) -> str:
    return f"{values.min():12.6g} to {values.max():12.6g}"


def _vector(result: StageResult, values: NDArray[np.float64]) -> str:
    """Components of a force; rounding beside the reactions is printed as 0."""
    rounding = 1e-12 * np.abs(result.reactions).sum()
    return f"({', '.join(f'{value:.6g}' if abs(value) > rounding else '0' for value in values)})"
