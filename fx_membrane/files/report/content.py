"""Content of a report as texts: what the template shows."""

import importlib.metadata
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...geometry.measures import measures
from ...model.loads import DistributedLoad, PlanLoad, PointLoad, Pressure
from ...model.materials import SHIPPED
from ...model.stages import Stage
from ...model.structure import Structure
from ...results.check import Check, Verdict
from ...results.checks import checks, split
from ...results.limits import Limits
from ...results.states import StageResult, StageResults
from ...results.summary import summary
from ...results.unfinished import unfinished

COMPUTED = {
    Verdict.PASS: "Computation: all checks of all stages pass.",
    Verdict.WARN: "Computation: some checks warn; read their remedies before the numbers.",
    Verdict.FAIL: "Computation: some checks fail; the numbers of these stages are not to be used.",
}
KINDS = {
    PointLoad: "Point load",
    DistributedLoad: "Distributed load",
    PlanLoad: "Plan load",
    Pressure: "Pressure",
}
PROGRAMS = {"fx_membrane": "fx-membrane", "dolfinx": "fenics-dolfinx", "numpy": "numpy", "scipy": "scipy"}


def content(results: StageResults, title: str, force: str, length: str) -> dict[str, Any]:
    """Values of the template of a report."""
    limits = results.limits or Limits()
    stages = [_stage(state, _of_name(results.stages, name), limits, force, length) for name, state in results.items()]
    lacking = unfinished(results)
    worst = _worst([*lacking, *(check for stage in stages for check in stage["checks"])])
    designed = [check for stage in stages for check in stage["limits"]]
    structure = next(iter(results.values())).structure
    return {
        "title": title,
        "force": force,
        "length": length,
        "verdict": worst.value,
        "sentence": _sentence(worst, [check.name for check in lacking]),
        "design": _worst(designed).value if designed else "",
        "design_sentence": _design_sentence(stages),
        "unfinished": lacking,
        "nodes": len(structure.points),
        "supported": int(structure.supported.any(axis=1).sum()),
        "parts": [_part(structure, name, force, length) for name in structure.parts],
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
        return "Design: all limits are kept."
    return f"Design: limits are exceeded, by {', '.join(missed)}. The numbers themselves are not in question."


def _of_name(stages: tuple[Stage, ...], name: str) -> Stage | None:
    return next((stage for stage in stages if stage.name == name), None)


def _stage(state: StageResult, stage: Stage | None, limits: Limits, force: str, length: str) -> dict[str, Any]:
    told, (computed, designed) = summary(state), split(checks(state, limits))
    return {
        "name": state.name,
        "after": (stage.after if stage else None) or "",
        "loads": [_load(load, state.structure, force, length) for load in stage.loads] if stage else [],
        "checks": computed,
        "limits": designed,
        "sums": {"loads": _force(state, told["sum of loads"]), "reactions": _force(state, told["sum of reactions"])},
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
        "remarks": [str(remark) for remark in state.remarks],
    }


def _load(load: Any, structure: Structure, force: str, length: str) -> str:
    """Line on a load: its kind, value with unit, and part."""
    value: Any = getattr(load, "load", getattr(load, "force", getattr(load, "pressure", None)))
    shown = "" if value is None else f"{value:.6g}" if np.ndim(value) == 0 else _vector(value)
    unit = "" if value is None else _load_unit(load, structure, force, length)
    where = getattr(load, "part", "") or f"{np.size(getattr(load, 'nodes', ()))} nodes"
    cells = getattr(load, "cells", None)
    some = f", {len(cells)} cells" if cells is not None else ""
    return f"{KINDS.get(type(load), type(load).__name__)} {shown}{unit} on {where}{some}"


def _load_unit(load: Any, structure: Structure, force: str, length: str) -> str:
    """Name the unit of a load after its value; empty for terms of a user's own."""
    if isinstance(load, PointLoad):
        return f" {force}"
    if isinstance(load, DistributedLoad | PlanLoad | Pressure):
        return f" {force}/{length}" + ("2" if structure.parts[load.part].dimension == 2 else "")
    return ""


def _extremes(state: StageResult, told: dict[str, Any], force: str, length: str) -> Iterator[dict[str, str]]:
    largest = told["largest displacement"]
    yield {
        "part": "",
        "quantity": "displacement",
        "least": "",
        "least_at": "",
        "largest": f"{largest['value']:.5g}",
        "largest_at": f"node {largest['node']} at {_vector(largest['place'])}",
        "unit": length,
    }
    for name, part in told["parts"].items():
        unit = force if state.parts[name].dimension == 1 else f"{force}/{length}"
        for quantity, ends in part.items():
            if isinstance(ends, dict):
                yield {
                    "part": name,
                    "quantity": quantity,
                    "least": f"{ends['least']['value']:.5g}",
                    "least_at": _at(ends["least"]),
                    "largest": f"{ends['largest']['value']:.5g}",
                    "largest_at": _at(ends["largest"]),
                    "unit": unit,
                }


def _at(entry: dict[str, Any]) -> str:
    return f"{entry['cell']} at {_vector(entry['place'])}"


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
    at = f"{node} at {_vector(state.structure.points[node])}"
    return {"name": name, "nodes": len(nodes), "x": x, "y": y, "z": z, "largest": f"{size.max():.5g}", "at": at}


def _part(structure: Structure, name: str, force: str, length: str) -> dict[str, Any]:
    part = structure.parts[name]
    size = measures(structure.points, part.cells).sum()
    tensors = part.prestress_tensors()
    values = tensors[:, range(part.dimension), range(part.dimension)]
    ends = " / ".join(
        f"{least:.4g}" if least == most else f"{least:.4g} to {most:.4g}"
        for least, most in zip(values.min(axis=0), values.max(axis=0), strict=True)
    )
    return {
        "name": name,
        "kind": type(part).__name__,
        "cells": len(part.cells),
        "size": f"{size:.5g} {length}{'2' if part.dimension == 2 else ''}",
        "material": _material(part.material, force, f"{force}/{length}"),
        "prestress": f"{ends} {force}{f'/{length}' if part.dimension == 2 else ''}",
    }


def _material(material: Any, force: str, stress: str) -> str:
    """Kind of a material and its numbers with units; a law of a user's own as it shows itself."""
    if not isinstance(material, SHIPPED):
        return repr(material)
    units = {"nu": "", "axial_stiffness": f" {force}"}
    numbers = {field.name: getattr(material, field.name) for field in fields(material)}
    told = [
        f"{name.replace('_', ' ')} = {value:.6g}{units.get(name, f' {stress}')}"
        for name, value in numbers.items()
        if isinstance(value, float)
    ]
    return f"{type(material).__name__}: {', '.join(told)}"


def _force(state: StageResult, values: Any) -> str:
    return "(" + ", ".join(_components(state, values)) + ")"


def _components(state: StageResult, values: Any) -> list[str]:
    """Components of a force; rounding beside the reactions is 0."""
    rounding = 1e-12 * np.abs(state.reactions).sum()
    return [f"{value:.5g}" if abs(value) > rounding else "0" for value in values]


def _vector(values: Any) -> str:
    return "(" + ", ".join(f"{value + 0.0:.4g}" for value in values) + ")"


def _versions() -> Iterator[tuple[str, str]]:
    for name, package in PROGRAMS.items():
        try:
            yield name, importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            yield name, "unknown"
