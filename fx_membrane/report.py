"""A stage in words and numbers: iterations, forces, stresses, strains, states, reactions and their balance."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from . import validation
from .parts import Cable
from .results import MembraneResult, StageResult
from .rigid_motion import loose_ends


def report(
    result: StageResult, nodes: Sequence[int] = (), *, first: int = 0, force_unit: str = "N", length_unit: str = "m"
) -> str:
    """Table of a stage, to print.

    It begins with the remarks on the state, if there are any. It gives of each part the least and the largest value:
    forces of cables and masts, principal stresses of membranes and their largest principal strain; how many cells are
    slack or wrinkled; and which cables end in the air. The largest force (in masts of either sign), stress I and strain
    are given with their cell, a row of the part's cells, and where its centroid is in the reference shape.

    No number is converted: a structure in kN and m gives a report in kN and m, and the names of the units say so.

    Args:
        result: A stage.
        nodes: Nodes whose reactions are listed.
        first: The number written for node 0.
        force_unit: Name of the unit in which the structure and its loads were given, to be written behind forces.
        length_unit: The same for lengths.

    Returns:
        The lines, without a line end after the last.

    Raises:
        ValueError: The result is not that of a stage, or a node does not exist.
    """
    validation.instance("The first argument of report", result, StageResult)
    validation.in_range("nodes", np.asarray(nodes, dtype=np.int64), len(result.structure.points), "node")
    iterations = [len(increment.iterations) - 1 for increment in result.increments]
    more = sum(increment.unlisted for increment in result.increments)
    remarks = f", drawn smooth first ({more} iterates more)" * any(entry.drawn_smooth for entry in result.increments)
    remarks += ", not stable" * any(increment.unstable for increment in result.increments)
    units = f"units as given: {force_unit}, {length_unit}"
    lines = [f"WARNING: {remark}" for remark in result.remarks]
    lines += [f"Stage {result.name!r}, iterations per increment: {iterations}{remarks}; {units}"]
    width = max(map(len, result.parts)) + 2
    for name in result.parts:
        said = _part(result, name, first, force_unit, length_unit)
        lines += [f"  {name if not row else '':{width}}{text}" for row, text in enumerate(said)]
    size = np.linalg.norm(result.displacement, axis=1)
    lines.append(f"  largest displacement {size.max():.6g} {length_unit}, at node {size.argmax() + first}")
    for node in nodes:
        lines.append(f"  reaction at node {node + first}: {_vector(result, result.reactions[node])} {force_unit}")
    return "\n".join(lines + _balance(result, force_unit, length_unit))


def _part(result: StageResult, name: str, first: int, force_unit: str, length_unit: str) -> list[str]:
    part = result.parts[name]
    if not isinstance(part, MembraneResult):
        cable = isinstance(result.structure.parts[name], Cable)
        slack = f", {part.slack.sum()} of {len(part.slack)} cells slack" if cable else ""
        where = _where(result, name, part.force if cable else np.abs(part.force))
        ends = loose_ends(result.structure, name, result.actions.held)
        hanging = (
            [f"ends in the air: {len(ends)}, first cell {ends[0][0]} at node {ends[0][1] + first}"] if ends else []
        )
        return [f"{_range(part.force)} {force_unit}, largest {where}{slack}", *hanging]
    states = ", ".join(f"{(part.state == state).sum()} {state}" for state in ("taut", "wrinkled", "slack"))
    strain = np.linalg.eigvalsh(part.strain)[:, 1]
    stress = part.principal[:, 0]
    return [
        f"{_range(stress)} {force_unit}/{length_unit}, principal stress I, largest {_where(result, name, stress)}",
        f"{_range(part.principal[:, 1])} {force_unit}/{length_unit}, principal stress II",
        f"largest principal strain {strain.max():.5f} {_where(result, name, strain)}; cells: {states}",
    ]


def _where(result: StageResult, name: str, values: NDArray[np.float64]) -> str:
    """The cell of a part with the largest value, and where it is."""
    cell = int(values.argmax())
    centroid = result.structure.points[result.structure.parts[name].cells[cell]].mean(axis=0)
    return f"in cell {cell} at ({', '.join(f'{x + 0.0:.4g}' for x in centroid)})"


def _balance(result: StageResult, force_unit: str, length_unit: str) -> list[str]:
    balance = result.equilibrium
    force = np.abs(balance.loads + balance.reactions).max()
    moment = np.abs(balance.load_moment + balance.reaction_moment).max()
    loads, reactions = _vector(result, balance.loads), _vector(result, balance.reactions)
    return [
        f"  sum of loads {loads}, of reactions {reactions} {force_unit}",
        f"  they balance to {force:.0e} {force_unit}, moments to {moment:.0e} {force_unit} {length_unit}; "
        f"largest unbalanced nodal force {balance.residual:.0e} {force_unit}",
    ]


def _range(values: NDArray[np.float64]) -> str:
    return f"{values.min():12.6g} to {values.max():12.6g}"


def _vector(result: StageResult, values: NDArray[np.float64]) -> str:
    """Components of a force; what is rounding beside the reactions is 0."""
    rounding = 1e-12 * np.abs(result.reactions).sum()
    return f"({', '.join(f'{value:.6g}' if abs(value) > rounding else '0' for value in values)})"
