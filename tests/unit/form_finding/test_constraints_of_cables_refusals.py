"""Cables that cannot have the geometry given: refused at the door, or named with the form before."""

import numpy as np
import pytest

from constrained import canopy, rope, with_a_hole
from fx_membrane import (
    Cable,
    CableDensity,
    CableForce,
    CableLength,
    CableSag,
    EdgeAngle,
    Mast,
    Structure,
    Support,
    UnsettledFormWarning,
    natural_force_density,
    projected_stress,
)

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


def net(kind=Cable):
    points = [[0.0, 0, 0], [2, 0, 0], [1, 1, 0]]
    return Structure(points, {"bar": kind([[0, 2], [2, 1]], 1e6, 10.0 * (kind is Cable))}, [Support([0, 1])])


REFUSED = [
    (rope, [CableLength("rope", 99.0)], r"'rope' from node \d at .* length 99, and its held ends are 100 ap"),
    (rope, [CableLength("rope", 100.0)], "ends are 100 apart; give a larger length"),
    (lambda: rope(n=1), [CableLength("rope", 101.0)], "one segment between held ends"),
    (lambda: rope(n=1), [CableSag("rope", 1.0)], "one segment, which stays straight; divide it for a sag"),
    (rope, [CableSag("rope", 1.0, along=(1, 0, 0))], "chord along the direction of its sag"),
    (rope, [CableSag("rope", 1.0), CableForce("rope", 1.0, [3])], r"cell 3 at .* has two constraints"),
    (rope, [CableForce("rope", 1.0, [8])], "CableForce of part 'rope' names cell 8"),
    (rope, [CableForce("cord", 1.0)], "No Cable is named 'cord'"),
    (lambda: net(Mast), [CableLength("bar", 1.0)], "No Cable is named 'bar', which is a Mast"),
    (rope, CableForce("rope", 1.0), "constraints must be a list"),
    (rope, ["sag"], "constraints has 'sag'"),
]


@pytest.mark.parametrize("number", range(len(REFUSED)))
@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
def test_refusals(method, number):
    structure, constraints, words = REFUSED[number]
    with pytest.raises(ValueError, match=words):
        method(structure(), constraints=constraints)


@pytest.mark.parametrize("constraint", [CableSag("ring", 1.0), EdgeAngle("ring", 20.0)])
def test_closed_line_has_no_chord(constraint):
    with pytest.raises(ValueError, match=r"'ring' from node .* is closed, so it has no chord"):
        projected_stress(with_a_hole(), constraints=[constraint])


@pytest.mark.parametrize(
    "make",
    [
        lambda: CableLength("edge", 0.0),
        lambda: CableSag("edge", -1.0),
        lambda: CableForce("edge", 0.0),
        lambda: CableDensity("edge", -1.0),
        lambda: EdgeAngle("edge", 91.0),
        lambda: EdgeAngle("edge", 0.0),
        lambda: CableSag("edge", 1.0, along=(0, 0, 0)),
        lambda: CableForce("", 1.0),
        lambda: CableForce("edge", 1.0, [0, 0]),
    ],
)
def test_unfit_data_are_refused(make):
    with pytest.raises(ValueError, match=r"\.$"):
        make()


@pytest.mark.mpi_once
@pytest.mark.parametrize("method", [projected_stress, natural_force_density])
@pytest.mark.parametrize("constraint", [CableSag("rope", 1.0), CableLength("rope", 101.0)])
def test_straight_rope_without_a_load_is_named(method, constraint):
    with pytest.raises(RuntimeError, match=r"'rope' from node .* has no sag under any force, as no load"):
        method(rope(), constraints=[constraint])


def test_sag_beyond_reach_is_named_and_the_last_form_kept():
    structure = canopy(depth=0.0, height=0.0)
    with pytest.warns(UnsettledFormWarning, match="reaches the sag 8 under no force: it is 4"):
        form = projected_stress(structure, cables="force", constraints=[CableSag("edge", 8.0)])
    assert not form.converged
    assert np.isfinite(form.points).all()
    with pytest.raises(RuntimeError, match="reaches the sag 8 under no force"):
        natural_force_density(structure, constraints=[CableSag("edge", 8.0)])


def test_too_few_steps_name_the_line():
    with pytest.warns(UnsettledFormWarning, match=r"cable 'edge' from node .* has the sag .* instead of 0\.9"):
        form = projected_stress(canopy(), constraints=[CableSag("edge", 0.9)], max_iterations=2)
    assert len(form.steps) == 2
    assert not form.converged
