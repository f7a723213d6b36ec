"""The report as a file: one HTML page that needs no other file, or a PDF of the same page."""

from __future__ import annotations

import base64
import logging
import os
import re
import tempfile
import urllib.parse
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from ...checks import paths, validation
from ...checks.values import counted
from ...patterns.proofs import PatternProof
from ...plot.contour_maps import small_picture
from ...plot.screen import obstacle
from ...results.states import StageResult, StageResults
from ...runtime.processes import by_the_first
from ...solvers.progress import Pulse, beating
from ..patterns.proof_files import PROOF
from ..patterns.saved_patterns import proof_at
from ..whole_file import writing
from .gas_actions import gas_rows
from .pattern_rows import pattern_chapter
from .template_values import content

ENDINGS = (".html", ".pdf")
TITLE = "Structural analysis"
SIZE = 15.0  # of numbers in pictures, which a page shows at half their size [points]
WORD = 18  # letters of a word, after which it may be broken
UNIT = re.compile(r"(?<![\w<;/])[^\W\d]\w{0,5}/\w{1,6}(?![\w/])")


@by_the_first
def write_report(
    results: StageResults,
    path: str | Path,
    *,
    title: str | None = None,
    force_unit: str | None = None,
    length_unit: str | None = None,
    pictures: bool = True,
    scene: str | Path | None = None,
    patterns: PatternProof | str | Path | None = None,
) -> None:
    """Write a report of an analysis: HTML, or PDF, by the ending of the path.

    It begins with a verdict and the checks of each stage. Then come model, materials, load cases with sums, and
    extremes with places. Reactions by support, a certificate of equilibrium and stability, pictures, convergence,
    warnings and versions end it. No number is converted: the names of the units are only printed. Under MPI call it on
    all processes; the first one writes.

    Args:
        results: What `Analysis.run` returned, `ConvergenceError.results`, or `load_results`.
        path: The file, ending in .html or .pdf; its folder is made.
        title: Title of the report; None for that of the results, or "Structural analysis".
        force_unit: Name of the force unit of the structure and its loads; None for that of the results, or "N".
        length_unit: Name of the length unit; None for that of the results, or "m".
        pictures: Draw the stress and the displacement of each stage; left out, with a warning, where nothing can draw.
        scene: A scene of the same results, written by `write_scene`, to which stages and extremes are linked.
        patterns: Proof of a cutting pattern, for a chapter with its strips; or its archive, or the folder of
            `fx-membrane patterns`.

    Raises:
        ValueError: The results are of another kind, or have no stage; a text is none; there is no scene; the file
            cannot be written.
        ImportError: jinja2 is not installed, or for a PDF weasyprint and its libraries.
    """
    validation.instance("write_report results", results, StageResults)
    if not results.states:
        raise ValueError("write_report results have no stage; run at least one.")
    title = validation.text("title", (results.title or TITLE) if title is None else title)
    drawn = validation.truth("pictures", pictures)
    force, length = results.units(force_unit, length_unit)
    file = checked_file(path)
    base = "" if scene is None else _address(paths.path("scene", scene, spare=0), file)
    values = content(results, title, force, length) | {"pictures": [], "scene": base}
    values["patterns"] = pattern_chapter(_proof_of(patterns), length, drawn)
    if drawn:
        values["pictures"] = list(_pictures(results, force, length))
    _write(_template().render(values), file)


@by_the_first
def write_reports(results: StageResults, *files: Path, scene: Path | None = None, patterns: Path | None = None) -> None:
    """Write the same report into several files, HTML and PDF, with pictures that are drawn once; see `write_report`."""
    force, length = results.units()
    values = content(results, results.title or TITLE, force, length)
    values["patterns"] = pattern_chapter(_proof_of(patterns), length)
    for file in files:
        checked_file(file)
    values["pictures"] = list(_pictures(results, force, length))
    for file in files:
        _write(_template().render(values | {"scene": "" if scene is None else _address(scene, file)}), file)


def checked_file(path: str | Path) -> Path:
    """File of a report, checked."""
    file = paths.path("path", path)
    if file.suffix.lower() not in ENDINGS:
        raise ValueError(f"path is {str(file)!r}; give a name that ends in .html or .pdf.")
    paths.check_writable("path", file)
    return file


def _write(page: str, file: Path) -> None:
    if file.suffix.lower() == ".html":
        with writing(file, encoding="utf-8", errors="xmlcharrefreplace") as stream:  # names may have lone surrogates
            stream.write(page)
    else:
        pulse = Pulse(file.name, shown=True)
        pulse.tell("pages of the PDF")
        with writing(file, "wb") as stream, _telling_pages(pulse):
            stream.write(_pdf(page, file.parent))


def _proof_of(patterns: Any) -> PatternProof | Path | None:
    """Check the proof of a cutting pattern, or its folder, and open its archive.

    Raises:
        ValueError: It is none of these; the folder or the archive has no proof.
    """
    if patterns is None or isinstance(patterns, PatternProof):
        return patterns
    folder = paths.path("patterns", patterns, spare=0)
    if os.path.isfile(folder / PROOF):
        return folder
    if os.path.isfile(folder) and (found := proof_at(folder)):
        return found
    raise ValueError(
        f"patterns is {str(folder)!r}, no archive of a proof and no folder with {PROOF}; write it by `fx-membrane "
        "patterns`."
    )


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
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    environment.filters["soft"] = _soft
    return environment.from_string(text)


def _soft(text: str) -> Any:
    """HTML of a text in which long words, as names of users, may be broken, but no unit, as kN/m."""
    import markupsafe  # noqa: PLC0415  (comes with jinja2)

    pieces = re.sub(rf"(\S{{{WORD}}})(?=\S)", "\\1\0", text).split("\0")
    found = str(markupsafe.Markup("<wbr>").join(pieces))
    return markupsafe.Markup(UNIT.sub(r'<span class="unit">\g<0></span>', found))


def _pdf(page: str, folder: Path) -> bytes:
    try:
        import weasyprint  # noqa: PLC0415  (optional)
    except (ImportError, OSError) as error:  # OSError: a library of the system is missing
        raise ImportError(
            f"A PDF needs weasyprint ({error}): pip install 'fx-membrane[report]', and on Debian the packages "
            "libpango-1.0-0 and libpangoft2-1.0-0; or give a path that ends in .html."
        ) from None
    with _letters_without_a_font() as lacking:
        found: bytes = weasyprint.HTML(string=page, base_url=f"{folder.absolute().as_uri()}/").write_pdf()
    if lacking:
        some = ", ".join(map(repr, sorted(lacking)[:5]))
        warnings.warn(
            f"No font of this machine has {counted(len(lacking), 'letter')} of names ({some}): the PDF shows boxes. "
            "Install a font that has them, as fonts-noto-cjk, or write .html.",
            stacklevel=5,
        )
    return found


@contextmanager
def _telling_pages(pulse: Pulse) -> Iterator[None]:
    """Write a line every ten seconds, with the number of the page where weasyprint tells it."""
    with beating(pulse, "styles of the PDF") as change:

        def note(record: logging.LogRecord) -> bool:
            if page := re.search(r"Page (\d+)$", record.getMessage()):
                change(f"page {page[1]} of the PDF")
            elif record.getMessage().startswith("Step 6"):
                change("pages of the PDF are drawn")
            return level <= logging.INFO  # as without this filter

        logger = logging.getLogger("weasyprint.progress")
        before, level = logger.level, logger.getEffectiveLevel()
        logger.addFilter(note)
        logger.setLevel(logging.INFO)
        try:
            yield
        finally:
            logger.setLevel(before)
            logger.removeFilter(note)


@contextmanager
def _letters_without_a_font() -> Iterator[set[str]]:
    """Collect the letters that weasyprint tells one by one, each time they occur."""
    lacking: set[str] = set()

    def note(record: logging.LogRecord) -> bool:
        told = re.search(r"\.notdef glyph .*\(U\+([0-9A-F]+)\)", record.getMessage())
        if told:
            lacking.add(chr(int(told[1], 16)))
        return not told

    logger = logging.getLogger("weasyprint")
    logger.addFilter(note)
    try:
        yield lacking
    finally:
        logger.removeFilter(note)


def _pictures(results: StageResults, force: str, length: str) -> Iterator[dict[str, Any]]:
    if reason := obstacle():
        warnings.warn(f"The report has no pictures: {reason}", stacklevel=4)
        return
    import matplotlib  # noqa: PLC0415  (numbers alone must not wait for it)

    with (
        tempfile.TemporaryDirectory(prefix="fx_membrane-") as folder,
        matplotlib.rc_context({"font.size": SIZE}),
    ):
        pulse = Pulse("report", shown=True)
        pulse.tell(f"pictures of {counted(len(results.states), 'stage')}")
        for name, state in results.states.items():
            images = []
            for number, (title, values) in enumerate(_fields(state, force, length).items()):
                pulse(f"picture {number + 1} of stage {name}")
                file = Path(folder, f"{number}.png")
                small_picture(state, {title: values}, file)
                data = base64.b64encode(file.read_bytes()).decode()
                images.append({"data": f"data:image/png;base64,{data}", "title": title})
            moved = "deformed shape to scale" if state.largest_displacement else "without displacements"
            gas = [f"; {row['name']}: {row['state']}, {row['pressure']}" for row in gas_rows(state, force, length)]
            yield {"images": images, "words": f"Stage {name}, {moved}{''.join(gas)}"}


def _fields(state: StageResult, force: str, length: str) -> dict[str, Any]:
    fields: dict[str, Any] = {}
    if state.largest_displacement:
        fields[f"displacement [{length}]"] = np.linalg.norm(state.displacement, axis=1)
    stress = {name: part.principal[:, 0] for name, part in state.membranes.items()}
    forces = {name: part.force for name, part in state.bars.items()}
    if stress:
        fields[f"principal stress I [{force}/{length}]"] = stress
    if state.water_depth.any():
        fields[f"water depth [{length}]"] = state.water_depth
    if forces:
        fields[f"axial force [{force}]"] = forces
    return fields
