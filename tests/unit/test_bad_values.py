"""Every argument of every public function and class refuses or accepts values of wrong kinds."""

import inspect
import itertools
from pathlib import Path

import numpy as np
import pytest

import fx_membrane
from bad_values import faults, scalars, values
from by_command import leave_out_pictures
from fx_membrane import (
    ParaViewSeries,
    cut_pieces,
    equilibrium_path,
    load_results,
    plot,
    read_compas,
    save_results,
    structure_from_file,
    structure_from_gmsh,
    updated_reference,
    write_paraview,
    write_patterns,
    write_report,
    write_scene,
)
from right_arguments import CASES
from right_subjects import RESULTS, STATE

NO_INPUT = {  # made by the package
    "ChamberResult", "Depression", "Drainage", "Edge", "Remeshed", "SailMesh", "Strips", "SurfaceLine",
    "CuttingPattern", "FlatStrip", "PatternProof", "SeamLengths", "Side", "StressErrors", "StressFit", "StripProof",
    "Actions", "BarResult", "Constraints", "EnergyTerm", "Equilibrium", "EquilibriumPath", "LoadedProblem", "Net",
    "Outcome", "ForceTerm", "Form", "FormStep", "Increment", "Iteration", "Law", "MembraneResult", "Modes",
    "PartFunctions", "Problem", "PathPoint", "Solution", "Solve", "Solver", "Stability", "StageResult", "StageResults",
    "Piece", "PondResult", "BasinResult", "WaterEvent", "RollLayout", "RopeResult", "TermResult", "plot",
}  # fmt: skip
ELSEWHERE = {
    "Allowances",
    "BiaxialTests",
    "Chamber",
    "cut_strips",
    "cutting_pattern",
    "drainage",
    "flatten",
    "geodesic",
    "nearest_stress_pattern",
    "prove_pattern",
    "reassembled",
    "remeshed",
    "planar_cut",
    "sail_mesh",
    "seams_between",
    "stress_trajectories",
    "warp_along",
    "warp_lines",
    "with_copies",
    "wrinkle_lines",
}  # in tests/unit/model/test_chambers.py, and in tests/unit/surfaces and patterns
NOT_RIGHT = (
    structure_from_gmsh,
    structure_from_file,
    read_compas,
    load_results,
    type(STATE).cable,
    type(STATE).membrane,
)  # their arguments are refused, too
NEEDS = {
    plot.contours: "pyvista", ParaViewSeries: "pyvista", write_paraview: "pyvista", write_report: "jinja2",
    write_scene: "plotly", type(STATE).to_dataframe: "pandas", cut_pieces: "shapely", write_patterns: "shapely",
}  # fmt: skip
SLOW = (
    plot.convergence,
    plot.compare_convergence,
    plot.wireframe,
    plot.contours,
    equilibrium_path,
    updated_reference,
    write_patterns,
)


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    file = tmp_path_factory.mktemp("archive") / "results"
    save_results(RESULTS, file)
    return file.read_bytes()


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(archive, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("results").write_bytes(archive)
    Path("roof.obj").write_text("v 0 0 0\nv 9 0 0\nv 0 9 0\nf 1 2 3\n")
    Path("net.json").write_text('{"node": {"0": {}}}')


def names(function):
    return [name for name in inspect.signature(function).parameters if name != "self"]


@pytest.mark.parametrize("function", CASES, ids=lambda function: function.__qualname__)
def test_values_of_a_wrong_kind_are_refused_in_words(function, monkeypatch):
    if function in NEEDS:
        pytest.importorskip(NEEDS[function])
    if function is write_report:
        leave_out_pictures(monkeypatch)
    given, kinds = CASES[function]
    assert set(kinds) == set(names(function))
    if function not in NOT_RIGHT:
        function(**given)
    tries = [
        (name, value, allowed)
        for name, kind in kinds.items()
        for value, allowed in values(kind)
        if not (allowed and function in SLOW) and not (name in ("on", "observe") and callable(value))
    ]
    found = faults(function, given, tries)
    assert not found, "\n".join([f"{len(found)} of {len(tries)}", *found])


@pytest.mark.parametrize("function", CASES, ids=lambda function: function.__qualname__)
def test_one_wrong_value_in_an_array_is_refused_in_words(function):
    given, kinds = CASES[function]
    tries = []
    for (name, kind), (value, right) in itertools.product(kinds.items(), scalars()):
        if kind.rstrip("?") not in ("array", "rows") or np.ndim(given[name]) == 0 or (right and function in SLOW):
            continue
        whole = kind.startswith("rows")
        for dtype in (None, object):
            entries = np.array(given[name], dtype=object)
            entries.flat[-1] = value
            allowed = right and (not whole or isinstance(value, int | np.integer))
            tries.append((name, entries if dtype else entries.tolist(), allowed))
    found = faults(function, given, tries)
    assert not found, "\n".join([f"{len(found)} of {len(tries)}", *found])


def test_no_public_function_is_left_out():
    public = {name: getattr(fx_membrane, name) for name in fx_membrane.__all__}
    raised = {name for name, entry in public.items() if isinstance(entry, type) and issubclass(entry, Exception)}
    assert {name for name, entry in public.items() if entry not in CASES} - raised == NO_INPUT | ELSEWHERE
