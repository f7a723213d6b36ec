"""Paths that slack parts carry: one warning, with their names."""

import warnings

import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    PathError,
    PointLoad,
    Stage,
    Structure,
    Support,
    UnstableStateWarning,
    equilibrium_path,
)
from fx_membrane.analysis.arc_length import _Tracer
from models import LIMIT, SNOW, arch, inclined_sheet


def pushed(structure, load, **arguments):
    """Trace a path; return it with the sentences of the warnings about it."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        path = equilibrium_path(structure, Stage("wind", [PointLoad(1, load)], increments=10), **arguments)
    return path, [entry for entry in caught if issubclass(entry.category, UnstableStateWarning)]


def guyed(kept=1e-4, prestress=0.0, feet=((-3, -1, 0), (-3, 1, 0))):
    points = [[0, 0, 0], [0, 0, 4.0], *feet]
    guys = Cable([[1, 2 + i] for i in range(len(feet))], 12e6, prestress=prestress, compression_stiffness=kept)
    return Structure(points, {"mast": Mast([[0, 1]], 2e8), "guys": guys}, [Support([0, *range(2, len(points))])])


@pytest.mark.mpi_once
@pytest.mark.parametrize("kept", [1e-2, 1e-3, 1e-4])
def test_mast_that_leans_on_slack_guys_is_told(kept):
    path, said = pushed(guyed(kept), (-300.0, 0, -300), max_points=20)
    assert not path.negative_pivots.any()
    assert len(said) == 1
    message = str(said[0].message)
    count = len(path.points) - 1
    assert f"stage 'wind' has {count} of {count + 1} points" in message
    assert f"load factor {path.load_factors[1]:.6g} (point 1)" in message
    assert "'guys' is compressed" in message
    assert "mast 'mast' (cell 0, at node 1)" in message
    assert said[0].filename == __file__


def test_mast_that_guys_hold_is_not():
    """In the wind that the guys are for, and with all that it takes."""
    assert not pushed(guyed(), (300.0, 0, -300))[1]
    feet = [(3, 0, 0), (-2, 3, 0), (-2, -3, 0)]
    start = Analysis(guyed(prestress=1e3, feet=feet)).run([Stage("rest")])["rest"]
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStateWarning)
        path = equilibrium_path(start, Stage("wind", [PointLoad(1, (-300.0, 0, -300))], after="rest"))
    assert path.complete


def test_healthy_paths_are_silent():
    with warnings.catch_warnings():
        warnings.simplefilter("error", UnstableStateWarning)
        equilibrium_path(inclined_sheet(), Stage("snow", [SNOW], increments=3))
        equilibrium_path(arch(), Stage("push", [PointLoad(1, (0, 0, -1.2 * LIMIT))], increments=8))


@pytest.mark.mpi
def test_path_that_is_lost_is_told_of_too(monkeypatch):
    following = _Tracer.next

    def lost(self, *arguments):
        if len(self.path.points) == 4:
            raise PathError("The path was lost.", self.path)
        return following(self, *arguments)

    monkeypatch.setattr(_Tracer, "next", lost)
    with (
        pytest.warns(UnstableStateWarning, match="has 3 of 4 points"),
        pytest.raises(PathError, match=r"^The path was lost\.$"),
    ):
        equilibrium_path(guyed(1e-3), Stage("wind", [PointLoad(1, (-300.0, 0, -300))], increments=10))
