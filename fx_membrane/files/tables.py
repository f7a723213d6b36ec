"""Results as tables on disk: CSV with units in the head, and a summary in JSON."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import get_args

from .. import __version__
from ..checks import paths, validation
from ..model.parts import Part
from ..results.plain_summary import summary
from ..results.states import StageResult, StageResults
from ..results.tables import Columns, cell_columns, node_columns
from ..results.unfinished_stages import unfinished
from ..runtime.processes import by_the_first
from .whole_file import writing

FORMULA = (
    *"=+-@\t\r\n",
    *"\uff1d\uff0b\uff0d\uff20",
)  # first letters of computed cells; the last: full width
LONE = "backslashreplace"  # of lone surrogates in names, which no encoding has
CELLS = {f"{kind.__name__.lower()}s.csv": kind for kind in get_args(Part)}
TABLES = ("nodes.csv", *CELLS, "summary.json")


@by_the_first
def write_tables(
    results: StageResults, folder: str | Path, *, force_unit: str | None = None, length_unit: str | None = None
) -> None:
    """Write the results of an analysis as tables: CSV for spreadsheets, JSON for scripts.

    `nodes.csv` has a row for each stage and node, `membranes.csv`, `cables.csv`, `masts.csv` and `ropes.csv` one for
    each stage, part and cell. Their first row names each column with its unit. With ponds in any stage, nodes and
    membranes have the depth of the water. `summary.json` has sums of forces, extremes with places, iterations, water
    and its events, and remarks of each stage. It names the stages that a failed run lacks. Numbers have all their
    digits. A name that a spreadsheet would take for a formula begins with an apostrophe. Files of earlier calls are
    replaced, each by a complete one. Under MPI call it on all processes; the first one writes.

    No number is converted: the names of the units are only printed.

    Args:
        results: What `Analysis.run` returned.
        folder: The folder; it is made.
        force_unit: Name of the force unit of the structure and its loads; None for that of the results, or "N".
        length_unit: Name of the length unit; None for that of the results, or "m".

    Raises:
        ValueError: The results are of another kind; a unit is not a text; a file cannot be written.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> write_tables(Analysis(rope).run([Stage("rest")]), "output/rope")
        >>> print(open("output/rope/cables.csv").readlines()[1].strip())
        rest,rope,0,1.5,0.0,0.0,3.0,taut,0.0,1000.0
    """
    validation.instance("write_tables results", results, StageResults)
    validation.instances("write_tables results", list(results.values()), StageResult)
    states = results.states
    units = results.units(force_unit, length_unit)
    place = paths.path("folder", folder)
    paths.check_writable("folder", place / "summary.json")
    water = any(state.ponds for state in states.values())
    nodes = (({"stage": name}, node_columns(state, *units, water)) for name, state in states.items())
    _write_csv(place / "nodes.csv", nodes)
    for file, kind in CELLS.items():
        tables = [
            ({"stage": stage, "part": name}, cell_columns(state, name, *units, water))
            for stage, state in states.items()
            for name in state.structure.parts_of(kind)
        ]
        if tables:
            _write_csv(place / file, iter(tables))
    document = {
        "fx_membrane": __version__,
        "units": dict(zip(("force", "length"), units, strict=True)),
        "stages": {name: summary(state) for name, state in states.items()},
        "unfinished": [
            {"verdict": check.verdict.value, "check": check.name, "remedy": check.remedy}
            for check in unfinished(results)
        ],
    }
    with writing(place / "summary.json", encoding="utf-8", errors=LONE) as stream:
        json.dump(document, stream, ensure_ascii=False, indent=1)


def _write_csv(file: Path, tables: Iterator[tuple[dict[str, str], Columns]]) -> None:
    with writing(file, encoding="utf-8-sig", errors=LONE, newline="") as stream:  # with a mark for Excel
        writer = csv.writer(stream)
        for number, (names, columns) in enumerate(tables):
            if number == 0:
                heads = list(columns)
                writer.writerow([*names, *heads])
            same = [quoted(name) for name in names.values()]
            blank = [""] * len(next(iter(columns.values())))  # of a state from an older archive
            entries = [columns[head].tolist() if head in columns else blank for head in heads]
            writer.writerows([*same, *row] for row in zip(*entries, strict=True))


def quoted(name: str) -> str:
    """Put an apostrophe before a name that a spreadsheet would take for a formula."""
    return f"'{name}" if name.startswith(FORMULA) else name
