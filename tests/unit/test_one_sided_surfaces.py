"""Surfaces without two sides: taken until a normal or a shear is asked for."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    Pressure,
    Problem,
    Stage,
    Structure,
    Support,
    updated_reference,
)

FABRIC = Fabric(Et=1e5, nu=0.3)


def moebius(prestress, n=12):
    """Strip with half a turn, held along its rim."""
    angle = 2 * np.pi * np.arange(n) / n
    radius = np.cos(angle / 2)
    half = 0.3 * np.stack([radius * np.cos(angle), radius * np.sin(angle), np.sin(angle / 2)], axis=1)
    centre = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    low, middle, high = np.arange(3 * n).reshape(3, n)
    ahead = [np.roll(row, -1) for row in (low, middle, high)]
    ahead[0][-1], ahead[2][-1] = high[0], low[0]  # half a turn
    cells = [
        np.stack(corners, axis=1)
        for a, b, c, d in [(low, middle, ahead[1], ahead[0]), (middle, high, ahead[2], ahead[1])]
        for corners in [(a, b, c), (a, c, d)]
    ]
    fabric = Membrane(np.concatenate(cells), FABRIC, prestress, warp=(1, 0.3, 0.2))
    points = np.concatenate([centre - half, centre, centre + half])
    return Structure(points, {"fabric": fabric}, [Support([*low, *high])])


def branching(prestress):
    """Three sheets on one edge."""
    points = [[0.0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0.5], [0, 0.5, 1]]
    fabric = Membrane([[0, 1, 2], [0, 1, 3], [0, 1, 4]], FABRIC, prestress, warp=(0, 1, 0))
    return Structure(points, {"fabric": fabric}, [Support([2, 3, 4])])


@pytest.mark.parametrize(("surface", "reason"), [(moebius, "one side.*Moebius strip"), (branching, "branches.*edge")])
def test_surface_without_two_sides(surface, reason):
    structure = surface((900.0, 700.0))
    air = [Stage("air", [Pressure(1.0, "fabric")])]
    for refused in (
        lambda: structure.normals("fabric"),
        lambda: Analysis(structure).run(air),
        lambda: updated_reference(structure, air[0].loads),
    ):
        with pytest.raises(ValueError, match=f"^Part 'fabric'.*{reason}"):
            refused()
    with pytest.raises(ValueError, match=rf"^Part 'fabric'.*shear.*prestress \[\[900.*{reason}"):
        surface([[900, 200], [200, 700]])
    problem = Problem(structure)
    loaded, x = problem.under(), problem.create_vector()
    with pytest.raises(ValueError, match=rf"^Part 'fabric'.*shear.*direction of 'prestress' \[\[0.*{reason}"):
        loaded.derivative(x, "fabric", "prestress", [[0, 1], [1, 0]])
    assert loaded.derivative(x, "fabric", "prestress", [[1, 0], [0, 1]]).norm() > 0
    assert np.abs(structure.warp("fabric")).max() > 0.1


def test_soap_film_on_a_moebius_strip_is_found_and_handed_over():
    form = updated_reference(moebius(1e3))
    assert form.converged
    assert form.steps[-1].area < form.steps[0].area
    rest = Analysis(form.structure).run([Stage("rest")])["rest"]
    assert np.abs(rest.displacement).max() < 1e-9
