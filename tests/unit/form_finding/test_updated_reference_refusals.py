"""Form finding refuses bad input, and prestress without a form."""

import numpy as np
import pytest

from constrained import assert_last_good
from films import CORNERS, FABRIC, RIM, TRIANGLES, film, saddle
from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    PointLoad,
    Pressure,
    Structure,
    Support,
    UnsettledFormWarning,
    boundary_edges,
    rectangle,
    updated_reference,
)

# Refusals


def test_structure_without_prestress_is_refused():
    structure = Structure(saddle(), {"film": Membrane(TRIANGLES, FABRIC)}, [Support(RIM)])
    with pytest.raises(ValueError, match=r"^No part.*prestress"):
        updated_reference(structure)


@pytest.mark.mpi_once
@pytest.mark.parametrize("supports", [[], [Support(0)], [Support(RIM, "xy")]])
def test_structure_without_enough_supports_is_refused(supports):
    structure = Structure(saddle(), {"film": Membrane(TRIANGLES, FABRIC, prestress=1e3)}, supports)
    with pytest.raises(ValueError, match=r"not supported enough|held at one place only"):
        updated_reference(structure)


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (Pressure(1.0, "roof"), "load.*part 'roof'"),
        (PointLoad(999, (0, 0, 1)), "names node 999.*not exist"),
        (5.0, r"loads has 5\.0"),
    ],
)
def test_loads_that_do_not_fit_are_refused(load, message):
    with pytest.raises(ValueError, match=message):
        updated_reference(film()[0], [load])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"max_iterations": 0}, "max_iterations is 0.*whole number above zero"),
        ({"tolerance": 0.0}, r"tolerance is 0\.0.*positive"),
        ({"tolerance": np.nan}, "tolerance is nan.*finite number"),
    ],
)
def test_settings_out_of_range(settings, message):
    with pytest.raises(ValueError, match=message):
        updated_reference(film()[0], **settings)


def test_film_without_an_equilibrium_is_reported():
    # A film of tension on four points only shrinks to lines between them.
    structure = Structure(saddle(), {"film": Membrane(TRIANGLES, FABRIC, prestress=1e3)}, [Support(CORNERS)])
    with pytest.warns(UnsettledFormWarning, match=r"form is that of step \d+.*Form finding stopped.*step \d+"):
        assert_last_good(updated_reference(structure))


@pytest.mark.parametrize(
    ("film", "edge", "message"),
    [
        (-1e3, 15e3, r"'film', cell 0.*prestress.*compressive \(-1000\)"),
        (2e3, -1.0, "'edge', cell 0: .*compressive"),
        (0.0, 15e3, r"'film', cell 0 at \(.*no prestress.*give a tension"),
    ],
)
def test_prestress_that_is_no_tension_is_refused(film, edge, message):
    points, triangles = rectangle(10.0, 10.0, 4, 4)
    parts = {
        "film": Membrane(triangles, Fabric(5e5, 0.3), prestress=film),
        "edge": Cable(boundary_edges(triangles), 1e6, edge),
    }
    with pytest.raises(ValueError, match=message):
        updated_reference(Structure(points, parts, [Support([0, 4, 20, 24])]))


def test_edge_cables_too_weak_for_the_film_collapse():
    # A circle of radius force / stress = 1.5 m cannot span 10 m.
    points, triangles = rectangle(10.0, 10.0, 8, 8)
    parts = {
        "film": Membrane(triangles, Fabric(5e5, 0.3), prestress=2e3),
        "edge": Cable(boundary_edges(triangles), 1e6, 3e3),
    }
    with pytest.warns(UnsettledFormWarning, match="the shape collapses"):
        assert_last_good(updated_reference(Structure(points, parts, [Support([0, 8, 72, 80])])))
