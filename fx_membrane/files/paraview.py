"""Results for ParaView: a step of the series for each state, with a block for each part."""

from __future__ import annotations

import re
import shutil
import warnings
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
from mpi4py import MPI

from ..checks import paths, validation
from ..results.states import StageResult, StageResults
from ..results.tables import WATER_DEPTH, cell_columns
from ..runtime.processes import by_the_first, together
from .whole_file import writing

SERIES = "series.pvd"
STATES = ("taut", "wrinkled", "slack")
TRIANGLE, LINE = 5, 3  # types of cells in VTK
FILE = re.compile(r"\d{4,}\.vtm")
STEP = re.compile(r'<DataSet timestep="([^"]+)" file="([^"]+)"/>')


class SeriesWarning(UserWarning):
    """Failure to write a step of a series: the run continues, and has the state in its results."""


class ParaViewSeries:
    """Series of states in a folder, which ParaView opens as `series.pvd`: at any time, also after a kill.

    Give it to `Analysis.run(stages, observe=series)` for every load increment. Each step is a complete file before the
    series names it. Its time is the number of the stage in the run, from 0, plus the load factor. Nodes have
    `displacement` ("Warp By Vector" shows the current shape), loads, reactions and the depth of water. Cells have its
    mean depth, stresses, forces, strains and `state`: 0 taut, 1 wrinkled, 2 slack. Names tell units. The field data of
    a step have the name of the stage.

    Under MPI make it, and call it, on all processes; the first one writes.

    Args:
        folder: The folder; it is made. An earlier series in it is removed, with all its steps.
        append: Keep the steps of an earlier series, as in a run that a checkpoint file continues.
        force_unit: Name of the force unit of the structure and its loads; nothing is converted.
        length_unit: Name of the length unit.

    Raises:
        ValueError: The folder cannot be written; a unit is not a text.
        ModuleNotFoundError: pyvista is not installed.

    Warns:
        SeriesWarning: A step could not be written, as on a full disk.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))], increments=2)
        >>> results = Analysis(rope).run([pull], observe=ParaViewSeries("output/rope"))
        >>> print(open("output/rope/series.pvd").read().splitlines()[3])
        <DataSet timestep="0.5" file="0001.vtm"/>
    """

    def __init__(
        self, folder: str | Path, append: bool = False, *, force_unit: str = "N", length_unit: str = "m"
    ) -> None:
        import pyvista  # noqa: F401, PLC0415  (optional, and missed before anything is computed)

        with together(MPI.COMM_WORLD):
            self._units = (
                validation.text("ParaViewSeries force_unit", force_unit),
                validation.text("ParaViewSeries length_unit", length_unit),
            )
            self._folder = paths.path("folder", folder)
            append = validation.truth("ParaViewSeries append", append)
            self._stages: list[str] = []
            self._steps: dict[float, str] = {}
            self._failed = False
            if MPI.COMM_WORLD.rank == 0:
                paths.check_writable("folder", self._folder / SERIES)
                if append and (self._folder / SERIES).exists():
                    found = STEP.findall((self._folder / SERIES).read_text(encoding="utf-8"))
                    self._steps = {float(time): file for time, file in found}
                elif not append:
                    _remove_series(self._folder)

    @by_the_first
    def __call__(self, state: StageResult) -> None:
        """Write a step.

        Warns:
            SeriesWarning: It could not be written.
        """
        validation.instance("The state of a ParaViewSeries", state, StageResult)
        if state.name not in self._stages:
            self._stages.append(state.name)
        factor = state.increments[-1].load_factor if state.increments else 0.0
        time = self._stages.index(state.name) + factor
        file = self._steps.get(time) or f"{len(self._steps) + 1:04d}.vtm"
        try:
            _write(state, self._folder / file, self._units)
            self._steps[time] = file
            _write_series(self._folder / SERIES, self._steps)
        except (OSError, ValueError, RuntimeError) as error:
            if not self._failed:
                warnings.warn(
                    f"Stage {state.name!r} is not in the series: {str(error).rstrip('.')}. The run goes on, and the "
                    "series keeps the steps that it has.",
                    SeriesWarning,
                    stacklevel=4,
                )
            self._failed = True


def write_paraview(
    results: StageResults, folder: str | Path, *, force_unit: str | None = None, length_unit: str | None = None
) -> None:
    """Write the final states of all stages as a series for ParaView, see `ParaViewSeries`.

    Args:
        results: Those of `Analysis.run`.
        folder: The folder; it is made.
        force_unit: Name of the force unit of the structure and its loads; nothing is converted. None for that of the
            results, or "N".
        length_unit: Name of the length unit; None for that of the results, or "m".

    Raises:
        ValueError: The results are of another kind; the folder cannot be written; a unit is not a text.
        ModuleNotFoundError: pyvista is not installed.

    Warns:
        SeriesWarning: A step could not be written, as on a full disk.
    """
    validation.instance("write_paraview results", results, StageResults)
    force, length = results.units(force_unit, length_unit)
    series = ParaViewSeries(folder, force_unit=force, length_unit=length)
    for state in results.states.values():
        series(state)


def _remove_series(folder: Path) -> None:
    """Remove the files of an earlier series, its steps that no series names among them; others stay."""
    (folder / SERIES).unlink(missing_ok=True)
    for file in folder.glob("*.vtm"):
        if FILE.fullmatch(file.name):
            shutil.rmtree(file.with_suffix(""), ignore_errors=True)
            file.unlink(missing_ok=True)


def _write(state: StageResult, file: Path, units: tuple[str, str]) -> None:
    """Write a step aside, then put it in the place of an earlier one."""
    aside, folder = file.parent / ".part", file.with_suffix("")
    names = {name: f"{file.stem}/{file.stem}_{number}.vtu" for number, name in enumerate(state.parts)}
    try:
        shutil.rmtree(aside, ignore_errors=True)  # that of a run which was killed
        for name, place in names.items():
            with writing(aside / place, encoding="utf-8") as stream:
                stream.write(_text(_block(state, name, units)))
        with writing(aside / file.name, encoding="utf-8", errors="replace") as stream:
            stream.write('<?xml version="1.0"?>\n<VTKFile type="vtkMultiBlockDataSet" version="1.0">\n')
            stream.write("<vtkMultiBlockDataSet>\n")
            for number, (name, place) in enumerate(names.items()):
                stream.write(f'<DataSet index="{number}" name={quoteattr(name)} file="{place}"/>\n')
            stream.write("</vtkMultiBlockDataSet>\n</VTKFile>\n")
        shutil.rmtree(folder, ignore_errors=True)
        (aside / file.stem).replace(folder)
        (aside / file.name).replace(file)
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def _text(grid: Any) -> str:
    """Content of a file of VTK; its own writers end the process on a full disk."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter  # noqa: PLC0415

    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.WriteToOutputStringOn()
    writer.Write()
    return str(writer.GetOutputString())


def _block(state: StageResult, name: str, units: tuple[str, str]) -> Any:
    """Mesh of a part in its reference shape, with the fields of its nodes and cells."""
    import pyvista  # noqa: PLC0415

    force, length = units
    part = state.structure.parts[name]
    nodes = np.unique(part.cells)
    cells = np.searchsorted(nodes, part.cells)
    kind = np.full(len(cells), TRIANGLE if name in state.membranes else LINE, dtype=np.uint8)
    rows = np.column_stack([np.full(len(cells), cells.shape[1]), cells]).ravel()
    grid = pyvista.UnstructuredGrid(rows, kind, state.structure.points[nodes])
    grid.point_data["node"] = nodes
    grid.point_data["displacement"] = state.displacement[nodes]
    grid.point_data[f"load [{force}]"] = state.loads[nodes]
    grid.point_data[f"reaction [{force}]"] = state.reactions[nodes]
    if name in state.membranes and state.ponds:
        grid.point_data[f"{WATER_DEPTH} [{length}]"] = state.water_depth[nodes]
    columns = cell_columns(state, name, force, length)
    word = columns.pop("state")
    grid.cell_data["state"] = np.array([STATES.index(entry) for entry in word.tolist()], dtype=np.uint8)
    for head in columns:
        if head not in {f"{axis} [{length}]" for axis in "xyz"}:
            grid.cell_data[head] = columns[head]
    if name in state.membranes:
        cauchy = state.membranes[name].cauchy
        grid.cell_data[f"Cauchy stress [{force}/{length}]"] = cauchy.reshape(-1, 9)
    grid.field_data["stage"] = [state.name]
    return grid


def _write_series(file: Path, steps: dict[float, str]) -> None:
    with writing(file, encoding="utf-8") as stream:
        stream.write('<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n')
        for time, name in sorted(steps.items()):
            stream.write(f'<DataSet timestep="{time!r}" file={quoteattr(name)}/>\n')
        stream.write("</Collection>\n</VTKFile>\n")
