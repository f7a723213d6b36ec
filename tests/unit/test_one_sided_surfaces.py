"""Surfaces without two sides: taken until a normal or a shear is asked for."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from ufl import inner

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    MooneyRivlin,
    NeoHooke,
    OrthotropicFabric,
    Pressure,
    Problem,
    ShearSignWarning,
    Stage,
    Structure,
    Support,
    load_results,
    rectangle,
    save_results,
    updated_reference,
)
from fx_membrane.results.tables import cell_columns

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
    sheared = [[900, 200], [200, 700]]
    cells = len(structure.parts["fabric"].cells)
    for shear in (sheared, np.tile(sheared, (cells, 1, 1))):  # the same shear in all cells, in two notations
        with pytest.raises(ValueError, match=rf"^Part 'fabric'.*shear.*prestress \[\[900.*{reason}"):
            surface(shear)
    problem = Problem(structure)
    loaded, x = problem.under(), problem.create_vector()
    with pytest.raises(ValueError, match=rf"^Part 'fabric'.*shear.*direction of 'prestress' \[\[0.*{reason}"):
        loaded.derivative(x, "fabric", "prestress", [[0, 1], [1, 0]])
    assert loaded.derivative(x, "fabric", "prestress", [[1, 0], [0, 1]]).norm() > 0
    assert np.abs(structure.warp("fabric")).max() > 0.1


@dataclass(frozen=True)
class Woven:
    """Law with warp and weft, and a coupling of shear and stretch that another side turns over."""

    k: float
    coupling: float

    def energy(self, E, sigma0, parameters):
        return inner(sigma0, E) + parameters.k * (inner(E, E) + 2 * parameters.coupling * E[0, 0] * E[0, 1]) / 2

    @property
    def stiffness(self):
        return self.k


@pytest.mark.parametrize("surface", [moebius, branching])
def test_laws_that_tell_a_shear_from_its_opposite_are_refused(surface):
    """A woven fabric is the same from both sides; a fabric whose yarns are askew is not."""
    structure = surface(900.0)
    askew, even = (replace(structure.parts["fabric"], material=Woven(1e5, coupling)) for coupling in (0.3, 0.0))
    with pytest.raises(ValueError, match=r"^Part 'fabric'.*shear from its opposite, Woven\(.*0\.3\)"):
        replace(structure, parts={"fabric": askew})
    for law in (even.material, OrthotropicFabric(1e5, 5e4, 0.3, 2e4), NeoHooke(1e4), MooneyRivlin(1e4, 1e3)):
        replace(structure, parts={"fabric": replace(even, material=law)})
    points, cells = rectangle(1.0, 1.0, 2, 2)
    assert Structure(points, {"fabric": replace(askew, cells=cells, warp=(1, 0, 0))}).has_sides("fabric")


def test_shear_strains_of_a_moebius_strip_are_told_and_left_out_of_tables():
    """Each of two structures with cells in other senses has shear of other signs; all else is the same."""
    structure = moebius((900.0, 700.0))
    fabric = structure.parts["fabric"]
    other = replace(structure, parts={"fabric": replace(fabric, cells=fabric.cells[:, [0, 2, 1]])})
    states = []
    for given in (structure, other):
        with pytest.warns(ShearSignWarning, match="'fabric' has no two sides.*cauchy"):
            states.append(Analysis(given, progress=False).run([Stage("rest")])["rest"])
    a, b = (state.membrane("fabric") for state in states)
    assert np.abs(a.strain[:, 0, 1] + b.strain[:, 0, 1]).max() < 1e-9
    for name in ("cauchy", "principal", "warp_weft_stress"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=1e-8, atol=1e-6)
    columns = cell_columns(states[0], "fabric")
    assert [bool(np.isnan(columns[f"strain {along} [-]"]).all()) for along in ("warp", "weft", "shear")] == [0, 0, 1]
    assert any(remark.category is ShearSignWarning for remark in states[0].remarks)


@pytest.mark.filterwarnings("ignore::fx_membrane.ShearSignWarning")
def test_remarks_on_shear_are_kept_in_archives(tmp_path):
    results = Analysis(moebius((900.0, 700.0)), progress=False).run([Stage("rest")])
    save_results(results, tmp_path / "moebius.npz")
    assert load_results(tmp_path / "moebius.npz")["rest"].remarks == results["rest"].remarks


def test_soap_film_on_a_moebius_strip_is_found_and_handed_over():
    form = updated_reference(moebius(1e3))
    assert form.converged
    assert form.steps[-1].area < form.steps[0].area
    rest = Analysis(form.structure).run([Stage("rest")])["rest"]
    assert np.abs(rest.displacement).max() < 1e-9
