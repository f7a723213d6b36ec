"""Missing folders: whatever writes a file makes them."""

import importlib.util

import numpy as np
import pytest
from click.testing import CliRunner

from fx_membrane import (
    Analysis,
    ParaViewSeries,
    Stage,
    plot,
    save_results,
    write_mesh,
    write_paraview,
    write_report,
    write_scene,
    write_tables,
)
from fx_membrane.cli import main
from models import SNOW, sheet

STAGE = Stage("snow", [SNOW])
WRITERS = {
    "checkpoint.sqlite": lambda results, file: Analysis(results["snow"].structure).run([STAGE], file),
    "results.fxm": save_results,
    "tables": write_tables,
    "shape.obj": lambda results, file: write_mesh(results["snow"], file),
    "shape.dxf": lambda results, file: write_mesh(results["snow"], file),
    "report.html": write_report,
    "scene.html": write_scene,
    "lines.png": lambda results, file: plot.wireframe(sheet().points, sheet().parts, file),
    "contours.png": lambda results, file: plot.contours(results["snow"], {"w": np.ones(25)}, file),
    "convergence.png": lambda results, file: plot.convergence(results["snow"], file),
    "movie.gif": plot.animation,
    "paraview": write_paraview,
    "series": lambda results, file: ParaViewSeries(file)(results["snow"]),
    "case.toml": lambda _, file: CliRunner().invoke(main, ["init", str(file)], catch_exceptions=False),
    "run/log.txt": lambda _, file: run_with_log(file),
}
NEEDS = {
    "scene.html": "plotly",
    "contours.png": "pyvista",
    "movie.gif": "pyvista",
    "paraview": "pyvista",
    "series": "pyvista",
    "report.html": "pyvista",
}


def run_with_log(file):
    case = file.parents[3] / "case.toml"
    runner = CliRunner()
    assert runner.invoke(main, ["init", str(case)]).exit_code == 0
    done = runner.invoke(main, ["run", str(case), "--quiet", "--log", str(file)], catch_exceptions=False)
    assert done.exit_code == 0, done.output


@pytest.fixture(scope="module")
def results():
    return Analysis(sheet()).run([STAGE])


@pytest.mark.parametrize("name", WRITERS)
def test_missing_folders_are_made(name, results, tmp_path):
    if name in NEEDS and not importlib.util.find_spec(NEEDS[name]):
        pytest.skip(f"{NEEDS[name]} is not installed")
    file = tmp_path / "new" / "folder" / name
    WRITERS[name](results, file)
    assert file.exists()
