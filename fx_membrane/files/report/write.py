"""The report as a file: one HTML page that needs no other file, or a PDF of the same page."""

import base64
import os
import tempfile
import urllib.parse
import warnings
from collections.abc import Iterator
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ...checks import paths, validation
from ...plot.contour_maps import contours
from ...plot.screen import obstacle
from ...results.states import StageResult, StageResults
from ...runtime.processes import by_the_first
from ...solvers.progress import Pulse
from ..whole_file import writing
from .content import content

ENDINGS = (".html", ".pdf")


@by_the_first
def write_report(
    results: StageResults,
    path: str | Path,
    *,
    title: str = "Structural analysis",
    force_unit: str | None = None,
    length_unit: str | None = None,
    pictures: bool = True,
    scene: str | Path | None = None,
) -> None:
    """Write a report of an analysis: HTML, or PDF, by the ending of the path.

    It begins with a verdict and the checks of each stage. Then come model and materials, load cases with their sums,
    extremes with cell and place, reactions by support, pictures, convergence, warnings and versions. No number is
    converted: the names of the units are only printed. Under MPI call it on all processes; the first one writes.

    Args:
        results: What `Analysis.run` returned, `ConvergenceError.results`, or `load_results`.
        path: The file, ending in .html or .pdf; its folder is made.
        title: Title of the report.
        force_unit: Name of the force unit of the structure and its loads; None for that of the results, or "N".
        length_unit: Name of the length unit; None for that of the results, or "m".
        pictures: Draw the stress and the displacement of each stage; left out, with a warning, where nothing can draw.
        scene: A scene of the same results, written by `write_scene`, to which stages and extremes are linked.

    Raises:
        ValueError: The results are of another kind, or have no stage; a text is none; there is no scene; the file
            cannot be written.
        ImportError: jinja2 is not installed, or for a PDF weasyprint and its libraries.
    """
    validation.instance("write_report results", results, StageResults)
    if not results:
        raise ValueError("write_report results have no stage; run at least one.")
    title, drawn = validation.text("title", title), validation.truth("pictures", pictures)
    force, length = results.units(force_unit, length_unit)
    file = paths.path("path", path)
    if file.suffix.lower() not in ENDINGS:
        raise ValueError(f"path is {str(file)!r}; give a name that ends in .html or .pdf.")
    paths.check_writable("path", file)
    base = "" if scene is None else _address(paths.path("scene", scene, spare=0), file)
    values = content(results, title, force, length) | {"pictures": [], "scene": base}
    if drawn:
        values["pictures"] = list(_pictures(results, force, length))
    page = _template().render(values)
    if file.suffix.lower() == ".html":
        with writing(file, encoding="utf-8") as stream:
            stream.write(page)
    else:
        with writing(file, "wb") as stream:
            stream.write(_pdf(page, file.parent))


def _address(scene: Path, file: Path) -> str:
    """Address of a scene from the place of a report, so that both can be moved together.

    Raises:
        ValueError: There is no scene.
    """
    if not os.path.isfile(scene):
        raise ValueError(f"scene is {str(scene)!r}, which does not exist; write it first, by write_scene.")
    return urllib.parse.quote(Path(os.path.relpath(scene, file.parent)).as_posix())


def _template() -> Any:
    try:
        import jinja2  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError("A report needs the package jinja2: pip install 'fx-membrane[report]'.") from None
    text = resources.files(__package__).joinpath("template.html").read_text(encoding="utf-8")
    return jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined).from_string(text)


def _pdf(page: str, folder: Path) -> bytes:
    try:
        import weasyprint  # noqa: PLC0415  (optional)
    except (ImportError, OSError) as error:  # OSError: a library of the system is missing
        raise ImportError(
            f"A PDF needs weasyprint ({error}): pip install 'fx-membrane[report]', and on Debian the packages "
            "libpango-1.0-0 and libpangoft2-1.0-0; or give a path that ends in .html."
        ) from None
    found: bytes = weasyprint.HTML(string=page, base_url=f"{folder.absolute().as_uri()}/").write_pdf()
    return found


def _pictures(results: StageResults, force: str, length: str) -> Iterator[dict[str, str]]:
    if reason := obstacle():
        warnings.warn(f"The report has no pictures: {reason}", stacklevel=4)
        return
    with tempfile.TemporaryDirectory(prefix="fx_membrane-") as folder:
        pulse = Pulse("report", shown=True)
        for number, (name, state) in enumerate(results.items()):
            pulse(f"picture {number + 1} of {len(results)}")
            file = Path(folder, f"{number}.png")
            contours(state, _fields(state, force, length), file)
            data = base64.b64encode(file.read_bytes()).decode()
            yield {"data": f"data:image/png;base64,{data}", "words": f"Stage {name}, deformed shape to scale"}


def _fields(state: StageResult, force: str, length: str) -> dict[str, Any]:
    fields: dict[str, Any] = {f"displacement [{length}]": np.linalg.norm(state.displacement, axis=1)}
    stress = {name: part.principal[:, 0] for name, part in state.parts.items() if part.dimension == 2}
    forces = {name: part.principal[:, 0] for name, part in state.parts.items() if part.dimension == 1}
    if stress:
        fields[f"principal stress I [{force}/{length}]"] = stress
    if forces:
        fields[f"axial force [{force}]"] = forces
    return fields
