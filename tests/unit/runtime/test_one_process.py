"""Errors of one process end all of them, with the same message."""

import ast
import re

import pytest

import launch

DIFFERENT = "ValueError: The input of process 1 differs from that of process 0 in: {}; give all processes the same"

EXPECTED = {
    "checkpoint that cannot be written": r"ValueError: The checkpoint /proc/fx/state cannot be written \(No such file",
    "checkpoint on a full disk, warnings as errors": "CheckpointWarning: Stage 'snow': its state could not be saved",
    "checkpoint of another structure": "ValueError: The checkpoint .* is of another structure, which differs in: pres",
    "checkpoint that one process sees": "done",
    "picture that cannot be written": "ValueError: path is '/proc/fx/picture.png', which cannot be written",
    "picture of nothing": "ValueError: path is .* which ends in no format of pictures",
    "warning as error": "LargeStrainWarning: Part 'ridge' is prestressed by 50 %",
    "other loads": DIFFERENT.format("loads of stage 'snow'"),
    "other increments": DIFFERENT.format("increments of stage 'snow'"),
    "fewer stages": DIFFERENT.format("names of the stages, loads of stage 'wind: 45°', disp.*and 3 more"),
    "other order": DIFFERENT.format("names of the stages"),
    "other points": DIFFERENT.format("points"),
    "other number of points": DIFFERENT.format("points"),
    "other solver": DIFFERENT.format("solver"),
    "other method": DIFFERENT.format("solver"),
    "no solver on one": "ValueError: Analysis solver is 'Newton'",
    "no stages on one": "ValueError: .*stages.*'snow'",
    "stage that does not fit on one": "ValueError: Stage 'snow' has a load on part 'roof', which does not exist",
    "no count on one": "ValueError: stability count is 0",
    "other count": DIFFERENT.format("count"),
    "other state": DIFFERENT.format("displacement of the state, actions of the state"),
    "no state on one": "ValueError: No part has mass",
    "path without end on one": "ValueError: equilibrium_path rtol is -1",
    "other path": DIFFERENT.format("load_factor"),
    "other start of a path": DIFFERENT.format("start, after of stage 'pull'"),
    "other form": DIFFERENT.format("prestress of part 'fabric'"),
    "other tolerance of a form": DIFFERENT.format("tolerance"),
    "stage of actions that does not fit on one": "ValueError: Stage 'pull' has a load on part 'roof', which does not",
    "other stage of actions": DIFFERENT.format("loads of stage 'pull'"),
    "other start of actions": DIFFERENT.format("start"),
    "no parameter on one": r"ValueError: Part 'fabric' has no parameter 'Gt'; those .* are \['prestress', .*'Et', 'nu'",
    "no part on one": "ValueError: No part is named 'roof'",
    "no direction on one": "ValueError: direction of 'Et' is the text 'text'; give a number",
    "other parameter": DIFFERENT.format("parameter"),
    "other direction": DIFFERENT.format("direction"),
    "no start of a load factor on one": "ValueError: start is 3; give an Actions",
    "other start of a load factor": DIFFERENT.format("start"),
    "no values on one": "ValueError: to_petsc values must be an array of numbers .*, not None",
    "other values": DIFFERENT.format("values"),
    "no elasticity on one": "ValueError: Problem elastic is 'no'; give",
    "other elasticity": DIFFERENT.format("elastic"),
    "other rows": "ValueError: x is a PETSc vector with the rows of the problem, but distributed otherwise",
    "part of a mesh that fails on one": "RuntimeError: the words of one",
    "other part of a mesh": DIFFERENT.format("prestress of part 'fabric'"),
    "other name of a part of a mesh": DIFFERENT.format("names of the parts, group 'fabric', group 'roof'"),
    "other support of a mesh": DIFFERENT.format("supports"),
}


@pytest.fixture(scope="module", params=[launch.PROCESSES])
def ended(request, tmp_path_factory):
    output = launch.start([launch.SCRIPTS / "one_process.py", tmp_path_factory.mktemp("one")], request.param)
    cases = [ast.literal_eval(text) for text in re.findall(r"^CASE (.*)$", output, re.MULTILINE)]
    assert all(len(lines) == request.param for _, lines in cases)
    return dict(cases)


def test_every_case_comes_to_its_end(ended):
    assert list(ended) == list(EXPECTED)


@pytest.mark.parametrize("case", EXPECTED)
def test_all_processes_say_the_same(ended, case):
    assert re.match(EXPECTED[case], ended[case][0])
    assert len(set(ended[case])) == 1


def test_error_of_a_script_on_one_process_ends_the_others():
    """Run under `python -m mpi4py`, as the README says; PETSc is loaded, which waits for all at its end."""
    script = (
        "from mpi4py import MPI; from fx_membrane import Analysis\n"
        "if MPI.COMM_WORLD.rank: raise ValueError('the words of one')\n"
        "MPI.COMM_WORLD.Barrier()"
    )
    with pytest.raises(AssertionError) as told:
        launch.start(["-m", "mpi4py", "-c", script], 2, timeout=120)
    assert "did not end" not in str(told.value)
    if launch.launcher().endswith("mpirun"):  # MPICH's launcher may cut them as it kills the others
        assert "ValueError: the words of one" in str(told.value)
