"""Pictures and reports that a case asks for."""

import re
import unicodedata
from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ... import plot, write_report
from ...results.states import StageResult, StageResults


def check_drawing(output: Any) -> None:
    """Refuse outputs whose packages are not installed, before anything is computed.

    Raises:
        ImportError: One is not installed.
    """
    if output.paraview and not find_spec("pyvista"):
        raise ImportError("output.paraview needs the package pyvista: pip install 'fx-membrane[plot]'.")
    if output.pictures and not find_spec("pyvista"):
        raise ImportError("output.pictures needs the package pyvista: pip install 'fx-membrane[plot]'.")
    if output.report and not find_spec("jinja2"):
        raise ImportError("output.report needs the package jinja2: pip install 'fx-membrane[report]'.")
    if "pdf" in output.report and not find_spec("weasyprint"):
        raise ImportError("output.report as pdf needs the package weasyprint: pip install 'fx-membrane[report]'.")


def drawings(output: Any, results: StageResults, folder: Path) -> Iterator[Callable[[], None]]:
    """Writers of a picture of each stage and quantity, and of the reports."""
    force, length = results.force_unit, results.length_unit
    if output.pictures:
        for number, state in enumerate(results.values()):
            fields = _fields(state, output.pictures, force, length)
            for title, values in fields.items():
                quantity = title.split(" [")[0].replace(" ", "-").lower()
                file = folder / f"{safe_name(number, state.name)}-{quantity}.png"
                yield partial(plot.contours, state, {title: values}, file)
    for ending in output.report:
        title, file = results.title or "Structural analysis", folder / f"report.{ending}"
        yield partial(write_report, results, file, title=title, force_unit=force, length_unit=length)


def safe_name(number: int, stage: str) -> str:
    """Name of a file for a stage: its number, and of its name letters, digits and hyphens, at most forty."""
    words = re.sub(r"[^0-9A-Za-z]+", "-", unicodedata.normalize("NFKD", stage).encode("ascii", "ignore").decode())
    return "-".join(filter(None, (f"{number:02d}", words[:40].strip("-").lower())))


def _fields(state: StageResult, names: list[str], force: str, length: str) -> dict[str, Any]:
    membranes = {name: part for name, part in state.parts.items() if part.dimension == 2}
    bars = {name: part.principal[:, 0] for name, part in state.parts.items() if part.dimension == 1}
    found: dict[str, Any] = {f"displacement [{length}]": np.linalg.norm(state.displacement, axis=1)}
    if membranes:
        for number, word in enumerate(("I", "II")):
            values = {name: part.principal[:, number] for name, part in membranes.items()}
            found[f"principal stress {word} [{force}/{length}]"] = values
        found["state"] = {name: part.state for name, part in membranes.items()}
    if bars:
        found[f"axial force [{force}]"] = bars
    return {title: values for title, values in found.items() if title.split(" [")[0] in names}
