"""A bound on the work of a path, and the points that are left where it is used up."""

import numpy as np
import pytest

from fx_membrane import PathError, PointLoad, Stage, WorkLimit, equilibrium_path
from fx_membrane.analysis import work
from models import LIMIT, arch, close

PUSH = Stage("push", [PointLoad(1, (0, 0, -1.2 * LIMIT))], increments=8)


@pytest.mark.mpi_once
@pytest.mark.parametrize("most", [5, 12, 40])
def test_points_before_the_limit_are_kept(most):
    whole = equilibrium_path(arch(), PUSH)
    with pytest.raises(PathError, match=rf"limit.*{most} iterations.*path.*\.$") as e:
        equilibrium_path(arch(), PUSH, limit=WorkLimit(iterations=most))
    path = e.value.path
    count = len(path.points)
    assert 1 <= count < len(whole.points)
    assert sum(len(point.iterations) - 1 for point in path.points) <= most
    assert not path.complete
    assert path.reason == str(e.value)
    assert f"{count} points, at load factor {path.load_factors[-1]:.6g}" in path.reason
    assert close(path.displacements, whole.displacements[:count])


def test_limit_that_is_enough_changes_nothing():
    whole = equilibrium_path(arch(), PUSH)
    assert np.array_equal(
        equilibrium_path(arch(), PUSH, limit=WorkLimit(iterations=10_000)).load_factors, whole.load_factors
    )


@pytest.mark.mpi
def test_limit_of_seconds(monkeypatch):
    clock = iter(np.arange(0.0, 1e6))
    monkeypatch.setattr(work, "monotonic", lambda: next(clock))
    with pytest.raises(PathError, match=r"limit.*9.5 s.*path.*after \d iterations"):
        equilibrium_path(arch(), PUSH, limit=WorkLimit(seconds=9.5))


def test_a_limit_of_another_kind_is_refused():
    with pytest.raises(ValueError, match="equilibrium_path limit is 40"):
        equilibrium_path(arch(), PUSH, limit=40)
