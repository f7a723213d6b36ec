"""Cutting patterns as files: DXF, sheets to print, tables, or a folder with all of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ...checks import paths, validation
from ...geometry.length_units import METRES
from ...patterns.allowances import Allowances
from ...patterns.cloth_pieces import Piece, cut_pieces
from ...patterns.flat_strips import CuttingPattern, check_pattern
from ...patterns.roll_layout import PIECE_DISTANCE, Placement, RollLayout, laid_on_roll, one_by_one
from ...runtime.processes import by_the_first
from ...solvers.progress import Pulse
from ..file_names import safe_name
from .drawing_of_pieces import write_drawing
from .length_units import in_unit, warn_of_length_unit
from .paper import Paper, paper_of
from .proof_files import BOOK, DRAWING, SHEETS, TABLE
from .sheet_plans import BAND_DISTANCE, Head, all_sheets, piece_sheet
from .sheets import write_pdf, write_svg
from .tables_of_strips import write_strip_tables


class Job(NamedTuple):
    """Pieces and all that their files need.

    Attributes:
        pieces: The pieces.
        roll: Their layout on the roll; None without.
        head: Entries of title blocks, and the unit.
        paper: Paper of sheets.
        scale: Scale of sheets, 20 for 1:20; None to choose one for each.
    """

    pieces: Mapping[str, Piece]
    roll: RollLayout | None
    head: Head
    paper: Paper
    scale: int | None

    @property
    def placements(self) -> tuple[Placement, ...]:
        """Places of the pieces: on the roll if there is one, or else one behind the other."""
        gap = BAND_DISTANCE * max(piece.width for piece in self.pieces.values())
        return (self.roll or one_by_one(self.pieces, gap)).placements


@by_the_first
def write_patterns(
    pattern: CuttingPattern,
    path: str | Path,
    allowances: Allowances | None = None,
    *,
    roll_width: float | None = None,
    mark_spacing: float | None = None,
    project: str = "",
    material: str = "",
    date: str = "",
    paper: str = "A3",
    scale: int | None = None,
    length_unit: str | None = None,
) -> None:
    """Write a cutting pattern for the workshop; the ending of the path says in which form.

    - .dxf: all pieces in millimetres, on the layers cut, sew, warp, marks and text.
    - .pdf: a sheet of all pieces, then one of each, at standard scales, with title blocks.
    - .svg: the sheet of all pieces.
    - .csv: areas, lengths, widths and numbers of the strips, and the cloth with its waste; beside it a table of sides
      with their lengths, its name ending in `_sides.csv`.
    - another name, also with a dot, or with a slash at its end: a folder with patterns.dxf, patterns.pdf, strips.csv,
      strips_sides.csv, and an SVG of each piece.

    With the width of a roll, pieces are laid on it as often as they are cut. Files are whole or not written, and equal
    for equal patterns. Under MPI call it on all processes; the first one writes.

    Args:
        pattern: The cutting pattern, see `cutting_pattern`.
        path: The file, or the folder; folders are made.
        allowances: Widths beyond the sewing lines; None for those of `Allowances()`.
        roll_width: Width of the roll [m].
        mark_spacing: Distance between marks along seams, nearly; None for 0.5 m [m].
        project: Name of the project, for title blocks.
        material: Name of the cloth, for title blocks.
        date: Date, for title blocks; empty for none.
        paper: "A0" to "A4", in landscape.
        scale: Scale of all sheets, 20 for 1:20; None for the largest of 1:1, 1:5, 1:10, 1:20, 1:25, 1:50 and 1:100 at
            which a sheet fits.
        length_unit: Unit of length of the pattern: "m", "mm", "ft", ...; None for that of its strips.

    Raises:
        ValueError: A strip is wider than the roll, or lies on itself; a sheet does not fit on the paper; the path has
            another ending, or cannot be written.
        ImportError: shapely or ezdxf is not installed.

    Warns:
        LengthUnitWarning: The longest piece is longer than 300 m, or shorter than 50 mm; an allowance is narrower than
            1 mm, and not zero.
    """
    check_pattern("write_patterns", pattern)
    closed = isinstance(path, str) and path != path.rstrip("/")
    file = paths.path("path", path.rstrip("/") or path if isinstance(path, str) else path)
    ending = "" if closed or file.is_dir() else file.suffix.lower()
    if ending in OTHERS:
        raise ValueError(f"path is {str(file)!r}; give a name that ends in {', '.join(WRITERS)}, or a folder.")
    unit = validation.text("length_unit", pattern.strips.length_unit if length_unit is None else length_unit)
    validation.choice("length_unit", unit, list(METRES), f"one of {list(METRES)}")
    words = [validation.text(*entry) for entry in (("project", project), ("material", material), ("date", date))]
    head = Head(words[0], words[1], words[2], unit, 1000 * METRES[unit])
    chosen = None if scale is None else validation.positive_integer("scale", scale)
    sheet = paper_of(paper)
    wide = None if roll_width is None else validation.positive("roll_width", roll_width)
    pieces = cut_pieces(in_unit(pattern, unit), allowances, mark_spacing=mark_spacing)
    warn_of_length_unit(pieces, unit, stacklevel=3)
    roll = None if wide is None else laid_on_roll(pieces, wide, gap=PIECE_DISTANCE / METRES[unit])
    job = Job(pieces, roll, head, sheet, chosen)
    writers = [(file, WRITERS[ending])] if ending in WRITERS else _in_folder(file, job)
    for target, _ in writers:
        paths.check_writable("path", target)
    pulse = Pulse("cutting patterns", shown=True)
    for target, write in writers:
        pulse(target.name)
        write(job, target)


def _dxf(job: Job, file: Path) -> None:
    write_drawing(job.pieces, job.placements, file, job.head.millimetres)


def _pdf(job: Job, file: Path) -> None:
    sheets = all_sheets(job.pieces, job.roll, job.head, job.paper, job.scale)
    sheets += [piece_sheet(piece, job.head, job.paper, job.scale) for piece in job.pieces.values()]
    write_pdf(job.pieces, sheets, file, job.head, job.paper)


def _svg(job: Job, file: Path) -> None:
    sheets = all_sheets(job.pieces, job.roll, job.head, job.paper, job.scale)
    if len(sheets) > 1:
        raise ValueError(
            f"The drawing takes {len(sheets)} sheets {job.paper.name} at 1:{sheets[0].scale}, and an SVG is one; give "
            "larger paper, or a path that ends in .pdf."
        )
    write_svg(job.pieces, sheets[0], file, job.head, job.paper)


def _svg_of_piece(name: str, job: Job, file: Path) -> None:
    sheet = piece_sheet(job.pieces[name], job.head, job.paper, job.scale)
    write_svg(job.pieces, sheet, file, job.head, job.paper)


def _csv(job: Job, file: Path) -> None:
    write_strip_tables(job.pieces, job.roll, file, job.head.unit)


Writer = Callable[[Job, Path], None]
WRITERS: dict[str, Writer] = {".dxf": _dxf, ".pdf": _pdf, ".svg": _svg, ".csv": _csv}
OTHERS = (  # of files that no writer makes: a folder of this name would surprise
    *(".ai", ".bmp", ".doc", ".docx", ".dwf", ".dwg", ".eps", ".fxm", ".gif", ".htm", ".html", ".hpgl", ".jpeg"),
    *(".jpg", ".json", ".obj", ".ods", ".odt", ".plt", ".png", ".ps", ".stl", ".tif", ".tiff", ".toml", ".txt"),
    *(".xls", ".xlsx", ".xml", ".zip"),
)


def _in_folder(folder: Path, job: Job) -> list[tuple[Path, Writer]]:
    """Files of a folder, with their writers."""
    files: list[tuple[Path, Writer]] = [
        (folder / DRAWING, _dxf),
        (folder / BOOK, _pdf),
        (folder / TABLE, _csv),
    ]
    for number, name in enumerate(job.pieces, 1):
        files.append((folder / SHEETS / f"{safe_name(number, name)}.svg", partial(_svg_of_piece, name)))
    return files
