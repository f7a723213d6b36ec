"""The examples in docstrings of public names run as printed, with the names of fx_membrane and numpy as np known."""

import doctest
import inspect

import numpy as np
import pytest

import fx_membrane

NAMES = {name: getattr(fx_membrane, name) for name in fx_membrane.__all__} | {"np": np}
PICTURES = [name for name in fx_membrane.plot.__all__ if callable(getattr(fx_membrane.plot, name))]
NAMES_OF_PICTURES = {f"plot.{name}": getattr(fx_membrane.plot, name) for name in PICTURES}
CLASSES = {  # exceptions and warnings are met, not made
    name: public
    for name, public in (NAMES | NAMES_OF_PICTURES).items()
    if inspect.isclass(public) and not issubclass(public, BaseException)
}
SHOWN = {
    "boundary_edges", "drainage", "edges_where", "equilibrium_path", "force_density", "masts_and_stays",
    "natural_force_density", "natural_frequencies", "polyline", "prescribed_stress", "projected_stress", "rectangle",
    "plot.animation", "plot.contours", "plot.trajectories", "report", "sail_mesh", "stability",
    "stress_trajectories", "updated_reference", "wrinkle_lines",
}  # fmt: skip
# Packages that Debian does not have, or that are optional.
NEEDS = {"ParaViewSeries": "pyvista", "cut_strips": "potpourri3d", "geodesic": "potpourri3d", "write_scene": "plotly"}
NEEDS |= {"seams_between": "potpourri3d", "warp_along": "potpourri3d", "with_copies": "potpourri3d"}
NEEDS["GeodesicDirection"] = "potpourri3d"
NEEDS |= dict.fromkeys(NAMES_OF_PICTURES, "pyvista")


def examples(name):
    """Doctests of a name, and of its own methods."""
    finder = doctest.DocTestFinder(exclude_empty=True)
    public = inspect.unwrap((NAMES | NAMES_OF_PICTURES)[name])
    return [test for test in finder.find(public, name, globs=dict(NAMES)) if test.examples]


def test_public_classes_have_examples():
    assert len(CLASSES) > 90
    assert [name for name, public in CLASSES.items() if ">>>" not in (public.__doc__ or "")] == []


@pytest.mark.parametrize(
    "name", [name for name in (*fx_membrane.__all__, *NAMES_OF_PICTURES) if name in SHOWN or examples(name)]
)
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
