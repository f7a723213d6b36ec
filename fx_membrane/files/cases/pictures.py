"""Pictures and reports that a case asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ... import plot, write_scene
from ...results.states import StageResult, StageResults
from ..file_names import safe_name
from ..patterns.proof_files import pattern_folder
from ..report.write import write_reports

SCENE = "scene.html"


def check_drawing(output: Any) -> None:
    """Refuse outputs whose packages are not installed, before anything is computed.

    Raises:
        ImportError: One is not installed.
    """
    if output.paraview and not find_spec("pyvista"):
        raise ImportError("output.paraview needs the package pyvista: pip install 'fx-membrane[plot]'.")
    if output.pictures and not find_spec("pyvista"):
        raise ImportError("output.pictures needs the package pyvista: pip install 'fx-membrane[plot]'.")
    if output.animation and not find_spec("pyvista"):
        raise ImportError("output.animation needs the package pyvista: pip install 'fx-membrane[plot]'.")
    if output.animation == "mp4" and not find_spec("imageio_ffmpeg"):
        raise ImportError("output.animation as mp4 needs the package imageio-ffmpeg: pip install 'fx-membrane[video]'.")
    if output.scene and not find_spec("plotly"):
        raise ImportError("output.scene needs the package plotly: pip install 'fx-membrane[scene]'.")
    if output.report and not find_spec("jinja2"):
        raise ImportError("output.report needs the package jinja2: pip install 'fx-membrane[report]'.")
    if "pdf" in output.report and not find_spec("weasyprint"):
        raise ImportError("output.report as pdf needs the package weasyprint: pip install 'fx-membrane[report]'.")


def drawings(output: Any, results: StageResults, folder: Path) -> Iterator[Callable[[], None]]:
    """Writers of a picture of each stage and quantity, of scene, moving picture and reports."""
    force, length = results.force_unit, results.length_unit
    if output.pictures:
        for number, state in enumerate(results.states.values()):
            fields = _fields(state, output.pictures, force, length)
            for title, values in fields.items():
                quantity = title.split(" [")[0].replace(" ", "-").lower()
                file = folder / f"{safe_name(number, state.name)}-{quantity}.png"
                yield partial(plot.contours, state, {title: values}, file)
    scene = folder / SCENE if output.scene else None
    if scene:
        yield partial(write_scene, results, scene)
    if output.animation:
        states, file = list(results.states.values()), folder / f"stages.{output.animation}"
        yield partial(plot.animation, states, file, force_unit=force, length_unit=length)
    if output.report:
        files = [folder / f"report.{ending}" for ending in output.report]
        yield partial(write_reports, results, *files, scene=scene, patterns=pattern_folder(folder))


def _fields(state: StageResult, names: list[str], force: str, length: str) -> dict[str, Any]:
    membranes = state.membranes
    bars = {name: part.force for name, part in state.bars.items()}
    found: dict[str, Any] = {f"displacement [{length}]": np.linalg.norm(state.displacement, axis=1)}
    if membranes:
        for number, word in enumerate(("I", "II")):
            values = {name: part.principal[:, number] for name, part in membranes.items()}
            found[f"principal stress {word} [{force}/{length}]"] = values
        found["state"] = {name: part.state for name, part in membranes.items()}
    if state.water_depth.any():
        found[f"water depth [{length}]"] = state.water_depth
    if bars:
        found[f"axial force [{force}]"] = bars
    return {title: values for title, values in found.items() if title.split(" [")[0] in names}
