"""Marks of tests: the first case of a study is chosen for each value of the arguments that the study does not vary."""

import importlib.util
from pathlib import Path

import pytest

CONFTEST = Path(__file__).parents[1] / "conftest.py"


class Case:
    """Case of a test with two arguments, marked `study` with the names of those that differ in numbers."""

    def __init__(self, method, force, varied):
        self.nodeid, self.params = f"test_edge[{method}-{force}]", {"method": method, "force": force}
        self.path = Path(f"test_{method}.py")
        self.callspec, self.marks = self, {"study": pytest.mark.study(*varied)}

    def get_closest_marker(self, name):
        return self.marks.get(name)

    def add_marker(self, mark):
        self.marks[mark.name] = mark


@pytest.fixture(scope="module")
def conftest():
    spec = importlib.util.spec_from_file_location("conftest_of_all", CONFTEST)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("varied", "first"), [((), [(0, 0)]), (("force",), [(0, 0), (1, 0)]), (("method", "force"), [(0, 0)])]
)
def test_first_case_of_a_study_is_not_marked_further(conftest, varied, first):
    cases = [Case(method, force, varied) for method in range(2) for force in range(3)]
    conftest.pytest_collection_modifyitems(cases)
    assert [tuple(case.params.values()) for case in cases if "further" not in case.marks] == first


def test_first_test_of_each_file_is_marked(conftest):
    cases = [Case(method, force, ()) for method in (0, 1, 0) for force in range(3)]
    conftest.pytest_collection_modifyitems(cases)
    assert [number for number, case in enumerate(cases) if "first" in case.marks] == [0, 3]


def test_first_collective_test_of_a_file_is_marked_too(conftest):
    cases = [Case(0, force, ()) for force in range(4)]
    cases[1].marks["mpi"] = cases[2].marks["mpi"] = pytest.mark.mpi
    conftest.pytest_collection_modifyitems(cases)
    assert [number for number, case in enumerate(cases) if "first" in case.marks] == [0, 1]


def test_names_in_marks_are_arguments(request):
    """A misspelt name would leave out no case."""
    studies = [item for item in request.session.items if item.get_closest_marker("study")]
    for item in studies:
        assert set(item.get_closest_marker("study").args) <= item.callspec.params.keys(), item.nodeid
