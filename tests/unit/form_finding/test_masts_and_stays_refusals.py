"""Masts and stays that cannot balance held nodes, and bad input: each is refused."""

from dataclasses import replace

import pytest

from fx_membrane import Cable, Mast, Membrane, masts_and_stays, projected_stress
from masted_sails import FABRIC, guys, head, sail
from own_terms import ElasticBed

pytestmark = pytest.mark.filterwarnings("ignore::fx_membrane.UnsettledFormWarning")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        (((0.3, 0, 0), (-3, 2, 0)), r"balance node 0 at \(0, 0, 4\).*force \(-3000, 0, 0\).*missing.*add a stay.*feet"),
        (((0.3, 0, 0), (3, 2, 0), (3, -2, 0)), r"mast in cell 0 of part 'mast', from .*tension, \d.*move.*foot"),
        (((0.3, 0, 0), (3, 2, 0), (3, -2, 0), (5, 0, 0)), r"masts in compression.*stays in tension balance node 0"),
        (((0.3, 0, 0), (-3, 3, 0), (-3, 1, 0)), r"stay in cell 0 of part 'stay', from .* would be in compression"),
        (((0.0, 0, 4), (-3, 2, 0), (-3, -2, 0)), r"part 'mast', cell 0.*nodes 2 and 0.*\(0, 0, 4\); move.*foot"),
    ],
    ids=["two bars", "stays in front", "choice", "stay in front", "foot on the head"],
)
def test_what_cannot_balance_is_refused(given, message):
    kinds = ["mast"] + ["stay"] * (len(given) - 1)
    with pytest.raises(ValueError, match=f"(?i){message}"):
        masts_and_stays(*head(*given, kinds=kinds)[:3])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"heads": [12]}, r"node 12 at .*not held.*hold it"),
        ({"heads": [0, 80]}, "No bar ends at node 80 .*add masts"),
        ({"heads": [0, 0]}, "twice"),
        ({"heads": [999]}, "does not exist"),
        ({"points": [(1.0, 2, 3)] * 4}, r"No bar ends at node 84.*point 3.*leave it out"),
        ({"points": [(1.0, 2, 3)]}, "bars names node .*does not exist"),
        ({"components": "w"}, "components"),
        ({"bars": {}}, "bars is empty"),
        ({"bars": {"fabric": Mast([[81, 0]], 1e6)}}, "'fabric' already"),
        ({"bars": {"m": Mast([[81, 0]], 1e6, prestress=5.0)}}, r"cell 0.*prestress 5.*tension.*no mast"),
        ({"bars": {"m": Cable([[81, 0]], 1e6, prestress=-5.0)}}, r"cell 0.*prestress -5.*compression.*no stay"),
        ({"bars": {"m": Mast([[81, 40]], 1e6)}, "points": [(0, 0, 9)]}, "No bar ends.*held.*hold"),
        ({"bars": {"m": Membrane([[0, 1, 2]], FABRIC)}}, "Membrane.*Mast or Cable"),
    ],
)
def test_bad_input_is_refused(change, message):
    structure, _ = sail()
    form = projected_stress(structure)
    bars = {"mast": Mast([[81, 0]], 1e8), "stays": Cable([[82, 0], [83, 0]], 1e7)}
    given = {"form": form, "bars": bars, "points": [(0.0, 0, 0), (-9, 1, 0), (-9, -1, 0)]} | change
    with pytest.raises(ValueError, match=message):
        masts_and_stays(**given)


def test_energy_terms_are_refused():
    structure, corners = sail()
    form = projected_stress(structure)
    bars, feet = guys(structure, corners)
    bedded = replace(form, made=replace(form.made, terms=[ElasticBed("fabric", 1e3)]))
    with pytest.raises(ValueError, match="energy terms"):
        masts_and_stays(bedded, bars, feet)
