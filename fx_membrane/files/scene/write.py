"""The scene as a file: one HTML page with its library and data inside, which asks for nothing."""

from __future__ import annotations

import html
import json
import re
from importlib import resources
from pathlib import Path
from typing import Any

from ...checks import paths, validation
from ...form_finding.form import Form
from ...model.structure import Structure
from ...results.states import StageResult, StageResults
from ...runtime.processes import by_the_first
from ...solvers.progress import Pulse
from ..whole_file import writing
from .scene_data import document

SCRIPTS = (  # in the order in which they need each other
    "data.js",
    "colours.js",
    "traces.js",
    "view.js",
    "choice.js",
    "words.js",
    "controls.js",
)
ENDINGS = (".html", ".htm")
MANY_CELLS = 50_000  # cells of all stages, from which writing takes seconds


@by_the_first
def write_scene(
    results: StageResults | StageResult | Form | Structure,
    path: str | Path,
    *,
    title: str | None = None,
    force_unit: str | None = None,
    length_unit: str | None = None,
) -> None:
    """Write results as an interactive scene: one HTML file that any browser opens, without a network.

    Stage, field and deformation factor are switched in the page. The pointer shows the values of a cell and of its
    nearest node. The colours go from the least to the largest value of the stage, both shown as numbers with their
    places. Supports, loads, reactions and remarks are shown, too. `#stage=snow&field=state&scale=5` behind the address
    of the page opens it there. Of more than 100 000 triangles fewer are drawn, and the page says so. Numbers are in
    single precision, apart from the least and largest. Under MPI call it on all processes; the first one writes.

    No number is converted: the names of the units are only printed.

    Args:
        results: What `Analysis.run` returned, `ConvergenceError.results`, or `load_results`; one of its stages; a form;
            or a structure, with its stress as built.
        path: The file, ending in .html; its folder is made.
        title: Title of the page; None for that of the results, or "Scene".
        force_unit: Name of the force unit of the structure and its loads; None for that of the results or the form, or
            "N".
        length_unit: Name of the length unit; None for that of the results or the form, or "m".

    Raises:
        ValueError: The results are of another kind, have no stage, or are of different structures; the form is that of
            a net; a text is none; the file cannot be written.
        ImportError: plotly is not installed.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 4, 4)
        >>> roof = Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)
        >>> sheet = Structure(points, {"roof": roof}, [Support(np.unique(boundary_edges(triangles)))])
        >>> snow = Stage("snow", [DistributedLoad((0, 0, -600.0), part="roof")])
        >>> write_scene(Analysis(sheet).run([snow]), "output/roof.html", title="Roof")
        >>> print(open("output/roof.html", encoding="utf-8").readlines()[6].strip())
        <title>Roof</title>
    """
    validation.instance("write_scene results", results, StageResults | StageResult | Form | Structure)
    own = results if isinstance(results, StageResults | Form) else StageResults()
    title = validation.text("title", getattr(own, "title", "") or "Scene" if title is None else title)
    force = validation.text("force_unit", own.force_unit if force_unit is None else force_unit)
    length = validation.text("length_unit", own.length_unit if length_unit is None else length_unit)
    file = paths.path("path", path)
    if file.suffix.lower() not in ENDINGS:
        raise ValueError(f"path is {str(file)!r}; give a name that ends in .html.")
    paths.check_writable("path", file)
    library = _library()
    Pulse(file.name, shown=_cells(results) > MANY_CELLS).tell(f"shapes and values of {_cells(results)} cells")
    page = _page(document(results, title, force, length), library)
    with writing(file, encoding="utf-8", errors="xmlcharrefreplace") as stream:  # names may have lone surrogates
        stream.write(page)


def _cells(results: StageResults | StageResult | Form | Structure) -> int:
    """Count the cells of all stages."""
    if isinstance(results, StageResults):
        return sum(map(_cells, results.states.values()))
    structure = results if isinstance(results, Structure) else results.structure
    return sum(len(part.cells) for part in structure.parts.values())


def _library() -> str:
    try:
        from plotly.offline import get_plotlyjs  # noqa: PLC0415  (optional)
    except ImportError:
        raise ImportError("A scene needs the package plotly: pip install 'fx-membrane[scene]'.") from None
    found: str = get_plotlyjs()
    return found.replace("</script", "<\\/script")


def _page(scene: dict[str, Any], library: str) -> str:
    folder = resources.files(__package__).joinpath("page")
    texts = {name: folder.joinpath(name).read_text(encoding="utf-8") for name in ("scene.html", "scene.css", *SCRIPTS)}
    data = json.dumps(scene, separators=(",", ":"), allow_nan=False)
    pieces = {
        "title": html.escape(scene["title"]),
        "style": texts["scene.css"],
        "data": data.replace("<", "\\u003c"),
        "library": library,
        "script": "\n".join(texts[name] for name in SCRIPTS),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda found: pieces[found[1]], texts["scene.html"])
