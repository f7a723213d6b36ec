"""The index of the paper's equations is complete, and each entry leads to an existing function."""

import inspect
import pydoc
import re

import pytest

from fx_membrane.forms import EQUATIONS, NOT_NEEDED


def test_each_equation_of_the_formulation_is_in_the_index():
    assert set(EQUATIONS) | NOT_NEEDED == {f"({number})" for number in range(12, 78)}
    assert not set(EQUATIONS) & NOT_NEEDED


def cited(text):
    """Numbers of equations in a text, as in "Gil (12), (41)"; of a range, the ends: no search finds those between."""
    groups = re.findall(r"Gil((?:(?:,| and|-)?\s*\(\d+\))+)", text)
    return {int(number) for group in groups for number in re.findall(r"\d+", group)}


@pytest.mark.parametrize("number", sorted(EQUATIONS))
def test_place_is_a_function_that_names_the_equation(number):
    """As `help("fx_membrane.forms.stress.cauchy")` and pydoc find it."""
    place = EQUATIONS[number][1]
    found = pydoc.locate(place)
    assert inspect.isfunction(found), place
    assert not [name for name in place.split(".") if name.startswith("_") and name != "_dolfinx"]
    assert int(number[1:-1]) in cited(inspect.getsource(found))
