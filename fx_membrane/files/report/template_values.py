"""Content of a report as texts: what the template shows."""

from __future__ import annotations

import importlib.metadata
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...checks.values import counted
from ...geometry.extremes import first_largest
from ...model.cable_changes import FixedLength, GivenForce, UnstressedLength
from ...model.changes import Change, LengthChange, NaturalStretch, PrestressFactor, TemperatureChange
from ...model.gas import GasChange
from ...model.loads import OwnLoad, PointLoad, Pressure, SpreadLoad
from ...model.ponds import Pond
from ...model.stages import Stage
from ...model.structure import Structure
from ...results.check import Check, Verdict
from ...results.limits import Limits
from ...results.plain_numbers import plain
from ...results.plain_summary import summary
from ...results.reader_words import for_readers
from ...results.state_checks import checks, split
from ...results.states import StageResult, StageResults
from ...results.unfinished_stages import unfinished
from .gas_actions import gas_action, gas_rows
from .part_rows import part_row

COMPUTED = {
    Verdict.PASS: "Computation: all checks of all stages pass.",
    Verdict.WARN: "Computation: some checks warn; read their remedies before the numbers.",
    Verdict.FAIL: "Computation: some checks fail; the numbers of these stages are not to be used.",
}
PROGRAMS = {"fx_membrane": "fx-membrane", "dolfinx": "fenics-dolfinx", "numpy": "numpy", "scipy": "scipy"}


def content(results: StageResults, title: str, force: str, length: str) -> dict[str, Any]:
    """Values of the template of a report."""
    limits = results.limits or Limits()
    states = results.states
    stages = [_stage(state, _of_name(results.stages, name), limits, force, length) for name, state in states.items()]
    lacking = unfinished(results)
    worst = _worst([*lacking, *(check for stage in stages for check in stage["checks"])])
    designed = [check for stage in stages for check in stage["limits"]]
    structure = next(iter(states.values())).structure
    return {
        "title": title,
        "force": force,
        "length": length,
        "verdict": worst.value,
        "sentence": _sentence(worst, [check.name for check in lacking]),
        "design": _worst(designed).value if designed else "",
        "design_sentence": _design_sentence(stages),
        "unfinished": lacking,
        "counts": ", ".join(
            counted(number, word)
            for number, word in (
                (len(structure.points), "node"),
                (len(structure.parts), "part"),
                (int(structure.supported.any(axis=1).sum()), "supported node"),
            )
        ),
        "parts": [part_row(structure, name, force, length) for name in structure.parts],
        "stages": stages,
        "warned": any(stage["remarks"] for stage in stages),
        "versions": dict(_versions()),
    }


def _worst(found: list[Check]) -> Verdict:
    verdicts = {check.verdict for check in found} | {Verdict.PASS}
    return next(verdict for verdict in (Verdict.FAIL, Verdict.WARN, Verdict.PASS) if verdict in verdicts)


def _sentence(worst: Verdict, lacking: list[str]) -> str:
    return f"The run is incomplete: {'; '.join(lacking)}." if lacking else COMPUTED[worst]


def _design_sentence(stages: list[dict[str, Any]]) -> str:
    """Sentence on the limits of the design; empty without limits."""
    if not any(stage["limits"] for stage in stages):
        return ""
    missed = [
        f"{check.name} in {stage['name']}"
        for stage in stages
        for check in stage["limits"]
        if check.verdict is Verdict.FAIL
    ]
    if not missed:
        warned = _worst([check for stage in stages for check in stage["limits"]]) is Verdict.WARN
        return f"Design: all limits are kept{'; some checks warn, with remedies' * warned}."
    return f"Design: limits are exceeded, by {', '.join(missed)}. The numbers themselves are not in question."


def _of_name(stages: tuple[Stage, ...], name: str) -> Stage | None:
    """Stage of a state, or of one that is named with its load factor."""
    named = {stage.name: stage for stage in stages}
    return named.get(name) or named.get(re.sub(r", (up to load factor [^,]*|at its start)$", "", name))


def _stage(state: StageResult, stage: Stage | None, limits: Limits, force: str, length: str) -> dict[str, Any]:
    told, (computed, designed) = summary(state), split(checks(state, limits, length))
    return {
        "name": state.name,
        "after": (stage.after if stage else None) or "",
        "loads": list(_actions(stage, state.structure, force, length)) if stage else [],
        "checks": computed,
        "limits": designed,
        "sums": {"loads": _force(state, told["sum of loads"]), "reactions": _force(state, told["sum of reactions"])},
        "gas": gas_rows(state, force, length),
        "certificate": _certificate(state, computed),
        "extremes": list(_extremes(state, told, force, length)),
        "reactions": list(_reactions(state)),
        "increments": [
            {
                "factor": f"{increment.load_factor:.4g}",
                "outcome": increment.outcome.name.lower().replace("_", " "),
                "iterations": increment.total_iterations,
                "residual": f"{increment.iterations[-1].residual:.1e}",
            }
            for increment in state.increments
        ],
        "remarks": [for_readers(remark) for remark in state.remarks],
    }


def _certificate(state: StageResult, computed: list[Check]) -> dict[str, str]:
    """Show the moments of a state in equilibrium, the force that is left at a node, and its stability."""
    balance = state.equilibrium
    node, reach = first_largest(balance.unbalanced), float(np.abs(state.position).max())
    return {
        "loads": _force(state, balance.load_moment, reach),
        "reactions": _force(state, balance.reaction_moment, reach),
        "unbalanced": f"{balance.residual:.1e}",
        "at": f"{node} at {_place(state.structure, state.structure.points[node])}",
        "stable": next(check.found for check in computed if check.name == "stable"),
    }


def _actions(stage: Stage, structure: Structure, force: str, length: str) -> Iterator[str]:
    """Lines on the loads and changes of a stage."""
    for load in stage.loads:
        yield _load(load, structure, force, length)
    for change in stage.changes:
        if isinstance(change, GasChange):
            yield gas_action(change, force, length)
            continue
        cells = f", {counted(np.size(change.cells), 'cell')}" if change.cells is not None else ""
        yield f"{_change(change, force, length)} of {change.part}{cells}"


def _change(change: Change, force: str, length: str) -> str:
    """Kind of a change, and its value with units."""
    if isinstance(change, TemperatureChange):
        return f"Temperature change {change.difference:+.6g} K, expansion {_numbers(change.expansion)} 1/K,"
    if isinstance(change, LengthChange):
        return f"Change of unstressed length {change.change:+.6g} {length}"
    if isinstance(change, PrestressFactor):
        return f"Prestress times {change.factor:.6g}"
    if isinstance(change, NaturalStretch):
        return f"Natural shape times {_numbers(change.stretch)}"
    return _of_cable(change, force, length)


def _of_cable(change: GivenForce | UnstressedLength | FixedLength, force: str, length: str) -> str:
    """Kind of a change of cables or ropes, and its value with units."""
    if isinstance(change, GivenForce):
        return f"Given force {change.force:.6g} {force}"
    if isinstance(change, UnstressedLength):
        return f"Unstressed length {change.length:.6g} {length}"
    return "Length fixed as it is"


def _numbers(value: Any) -> str:
    """Show a number, a (warp, weft) pair or a tensor."""
    return " / ".join(f"{number:.6g}" for number in np.ravel(value))


def _load(load: Any, structure: Structure, force: str, length: str) -> str:
    """Line on a load: its kind, value with unit, and part."""
    if isinstance(load, Pond):
        return _pond(load, force, length)
    value: Any = getattr(load, "load", getattr(load, "force", getattr(load, "pressure", None)))
    shown = "" if value is None else plain(value, 6) if np.ndim(value) == 0 else _vector(value)
    unit = "" if value is None else _load_unit(load, structure, force, length)
    where = getattr(load, "part", "") or counted(np.size(getattr(load, "nodes", ())), "node")
    cells = getattr(load, "cells", None)
    some = f", {counted(len(cells), 'cell')}" if cells is not None else ""
    return f"{_kind_of(load)} {shown}{unit} on {where}{some}"


def _kind_of(load: Any) -> str:
    """Name of a load: the words of its class, "Plan load"; the class itself of a user's own."""
    name = type(load).__name__
    return re.sub(r"(?<=[a-z])[A-Z]", lambda found: f" {found[0].lower()}", name) if isinstance(load, OwnLoad) else name


def _pond(pond: Pond, force: str, length: str) -> str:
    """Line on water: its level or amount, its specific weight, and part."""
    amounts = {"level": (pond.level, length), "volume": (pond.volume, f"{length}3"), "rain": (pond.rain, length)}
    how, (value, unit) = next((how, entry) for how, entry in amounts.items() if entry[0] is not None)
    return f"Water, {how} {value:.6g} {unit}, weight {pond.weight:.6g} {force}/{length}3, on {pond.part}"


def _load_unit(load: Any, structure: Structure, force: str, length: str) -> str:
    """Name the unit of a load after its value; empty for terms of a user's own."""
    if isinstance(load, PointLoad):
        return f" {force}"
    if isinstance(load, SpreadLoad | Pressure):
        return f" {force}/{structure.parts[load.part].size_unit(length)}"
    return ""


def _extremes(state: StageResult, told: dict[str, Any], force: str, length: str) -> Iterator[dict[str, str]]:
    largest = told["largest displacement"]
    yield {
        "part": "",
        "quantity": "displacement",
        "unit": length,
        "least": "",
        "least_at": "",
        "largest": plain(largest["value"]),
        "largest_at": f"node {largest['node']} at {_place(state.structure, largest['place'])}",
    }
    for name, part in told["parts"].items():
        unit = state.structure.parts[name].stress_unit(force, length)
        for quantity, ends in part.items():
            if isinstance(ends, dict):
                yield {
                    "part": name,
                    "quantity": quantity,
                    "unit": unit,
                    "least": plain(ends["least"]["value"]),
                    "least_at": _at(state.structure, ends["least"]),
                    "largest": plain(ends["largest"]["value"]),
                    "largest_at": _at(state.structure, ends["largest"]),
                }


def _at(structure: Structure, entry: dict[str, Any]) -> str:
    return f"{entry['cell']} at {_place(structure, entry['place'])}"


def _place(structure: Structure, point: Any) -> str:
    """Show a place to a thousandth of the size of the structure: enough to find a cell."""
    digits = max(0, int(-np.floor(np.log10(1e-3 * structure.size))))
    return "(" + ", ".join(f"{np.round(value, digits) + 0.0:.{digits}f}" for value in point) + ")"


def _reactions(state: StageResult) -> Iterator[dict[str, Any]]:
    """Reactions of each support, and of nodes that stages move."""
    left = state.actions.held.any(axis=1)
    for number, support in enumerate(state.structure.supports):
        nodes = np.asarray(support.nodes)
        left[nodes] = False
        yield _sum_of(state, f"{number}: {support.components}", nodes)
    if left.any():
        yield _sum_of(state, "prescribed displacements", np.flatnonzero(left))


def _sum_of(state: StageResult, name: str, nodes: NDArray[np.int64]) -> dict[str, Any]:
    reactions = state.reactions[nodes]
    size = np.linalg.norm(reactions, axis=1)
    node = int(nodes[size.argmax()])
    x, y, z = _components(state, reactions.sum(axis=0))
    at = f"{node} at {_place(state.structure, state.structure.points[node])}"
    return {"name": name, "nodes": len(nodes), "x": x, "y": y, "z": z, "largest": plain(size.max()), "at": at}


def _force(state: StageResult, values: Any, reach: float = 1.0) -> str:
    return "(" + ", ".join(_components(state, values, reach)) + ")"


def _components(state: StageResult, values: Any, reach: float = 1.0) -> list[str]:
    """Components of a force, or of a moment with that reach; rounding beside the reactions is 0."""
    rounding = 1e-12 * reach * np.abs(state.reactions).sum()
    return [plain(value) if abs(value) > rounding else "0" for value in values]


def _vector(values: Any) -> str:
    return "(" + ", ".join(plain(value + 0.0, 6) for value in values) + ")"


def _versions() -> Iterator[tuple[str, str]]:
    for name, package in PROGRAMS.items():
        try:
            yield name, importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            yield name, "unknown"
