"""Masts whose feet slide on rails: a tie along the rail holds them; without one they are refused with the reason."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    RigidBody,
    Stage,
    Structure,
    Support,
    masts_and_stays,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    stability,
    updated_reference,
)
from masted_sails import guys, sail


def guyed(unit=1.0):
    held, corners = sail(unit=unit)
    form = updated_reference(held)
    bars, feet = guys(held, corners)
    return masts_and_stays(form, bars, feet), len(form.points), corners


def tied(form, foot, anchor):
    n = len(form.points)
    ties = Cable([[n, foot], [n + 1, foot + 1]], 2e7)
    return masts_and_stays(
        form, {"ties": ties}, [(-anchor, 0, 0), (anchor, 0, 0)], heads=[foot, foot + 1], components="x"
    )


@pytest.mark.mpi
@pytest.mark.parametrize("unit", [1.0, 1e-3])
def test_tie_takes_the_thrust_along_the_rail(unit):
    form, foot, _ = guyed(unit)
    on_rail = tied(form, foot, 9.0)
    thrust = np.abs(form.reactions[[foot, foot + 1], 0])
    assert thrust.min() > 1e4 * unit
    assert on_rail.forces["ties"] == pytest.approx(thrust, rel=1e-12)
    assert on_rail.reactions[[foot, foot + 1], 0] == pytest.approx(0.0, abs=1e-12 * thrust.max())
    assert on_rail.reactions[[foot, foot + 1], 2] == pytest.approx(form.reactions[[foot, foot + 1], 2], rel=1e-12)
    assert not on_rail.structure.supported[[foot, foot + 1], 0].any()
    assert on_rail.structure.supported[[foot, foot + 1], 1:].all()
    state = Analysis(on_rail.structure).run([Stage("form")])["form"]
    assert state.largest_displacement <= 1e-12 * on_rail.structure.size
    assert stability(state).stable


def test_tie_on_the_wrong_side_is_refused():
    form, foot, _ = guyed()
    with pytest.raises(ValueError, match=r"stay in cell \d of part 'ties', .* would be in compression"):
        tied(form, foot, 2.0)


@pytest.mark.parametrize("find", [projected_stress, natural_force_density, updated_reference, prescribed_stress])
def test_mast_of_given_length_without_a_tie_is_refused_with_the_reason(find):
    form, foot, (west, east, south, north) = guyed()
    structure = form.structure
    parts = structure.parts | {"masts": Mast(structure.parts["masts"].cells, 3e8)}
    others = np.arange(foot + 2, foot + 6)
    supports = [Support([south, north]), Support(others), Support([foot, foot + 1], "yz")]
    loose = Structure(structure.points, parts, supports)
    masts = [RigidBody([foot, west]), RigidBody([foot + 1, east])]
    with pytest.raises(ValueError, match=rf"can move node {foot} at \(-5.2, 0, 0\) in x, where no stress ties it"):
        find(loose, constraints=masts)


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_tie_that_pulls_a_foot_to_its_anchor_is_named():
    held, (west, *_) = sail()
    n = len(held.points)
    points = np.concatenate([held.points, [(-5.2, 0, 0), (-9.0, 0, 0)]])
    parts = held.parts | {"mast": Mast([[n, west]], 3e8), "tie": Cable([[n, n + 1]], 2e7, prestress=3e4)}
    structure = Structure(points, parts, [*held.supports, Support([n], "yz"), Support([n + 1])])
    with pytest.raises(RuntimeError, match="part 'tie', cell 0 shrinks to nothing at"):
        prescribed_stress(structure)
