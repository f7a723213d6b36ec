"""Curves of convergence: visible content, and refused input."""

import pytest

from fx_membrane import Analysis, Stage, Structure, Support, plot
from pictures import assert_drawn, has_colour


def test_comparison_of_solvers(result, tmp_path):
    histories = {"one": [entry for _, entry in result.history], "other": result.increments[-1].iterations}
    plot.compare_convergence(histories, {"one": 2.0, "other": 0.1}, tmp_path / "new" / "solvers.png")
    assert_drawn(tmp_path / "new" / "solvers.png")
    assert has_colour(tmp_path / "new" / "solvers.png", "#1f77b4")
    assert has_colour(tmp_path / "new" / "solvers.png", "#ff7f0e")


@pytest.mark.parametrize(
    ("histories", "seconds", "message"),
    [
        ({}, {}, "histories is empty"),
        ({"one": []}, {"one": 1.0}, "without iterates"),
        ({"one": [1]}, {"other": 1.0}, r"seconds.*\['other'\].*time.*\['one'\]"),
        ([1], {}, "histories is"),
    ],
)
def test_comparison_of_nothing(histories, seconds, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        plot.compare_convergence(histories, seconds, tmp_path / "solvers.png")


def test_convergence(result, tmp_path):
    path = tmp_path / "new" / "folder" / "convergence.png"
    plot.convergence(result, path, force_unit="kN", energy_unit="kJ")
    assert assert_drawn(path) > 1.5


def test_convergence_of_a_state_that_is_exactly_in_equilibrium(result, tmp_path):
    (rest,) = (
        Analysis(Structure(result.structure.points, result.structure.parts, [Support(range(26))]))
        .run([Stage("rest")])
        .values()
    )
    plot.convergence(rest, tmp_path / "rest.png")
    assert_drawn(tmp_path / "rest.png", colours=3)


def test_convergence_of_no_result_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"^The first argument.*convergence is 5.*StageResult"):
        plot.convergence(5, tmp_path / "never.png")
