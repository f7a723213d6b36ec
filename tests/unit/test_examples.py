"""The examples in docstrings of public names run as printed, with the names of fx_membrane and numpy as np known."""

import doctest
import inspect

import numpy as np
import pytest

import fx_membrane

NAMES = {name: getattr(fx_membrane, name) for name in fx_membrane.__all__} | {"np": np}
SHOWN = {
    "Analysis", "Cable", "DistributedLoad", "Fabric", "Mast", "Membrane", "OrthotropicFabric", "PlanLoad",
    "PointLoad", "PrescribedDisplacement", "Pressure", "Stage", "StageResult", "Structure", "Support",
    "RoundHole", "boundary_edges", "drainage", "edges_where", "equilibrium_path", "force_density", "masts_and_stays",
    "natural_force_density", "natural_frequencies", "polyline", "prescribed_stress", "projected_stress", "rectangle",
    "report", "sail_mesh", "stability", "updated_reference",
}  # fmt: skip
# Packages that Debian does not have, or that are optional.
NEEDS = {"ParaViewSeries": "pyvista", "geodesic": "potpourri3d", "warp_along": "potpourri3d"}


def examples(name):
    """Doctests of a name, and of its own methods."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    public = inspect.unwrap(NAMES[name])
    return [test for test in finder.find(public, name, globs=dict(NAMES)) if test.examples]


@pytest.mark.parametrize("name", [name for name in fx_membrane.__all__ if name in SHOWN or examples(name)])
def test_examples(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # some write files
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    found = examples(name)
    assert found, "has no example"
    for test in found:
        told = []
        doctest.DocTestRunner().run(test, out=told.append)
        assert not told, "".join(told)
