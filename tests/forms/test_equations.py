"""The index of the paper's equations is complete, and each entry leads to an existing function."""

import importlib

import pytest

from fx_membrane.forms import EQUATIONS, NOT_NEEDED


def test_each_equation_of_the_formulation_is_in_the_index():
    assert set(EQUATIONS) | NOT_NEEDED == {f"({number})" for number in range(12, 78)}
    assert not set(EQUATIONS) & NOT_NEEDED


@pytest.mark.parametrize("place", sorted({place for _, place in EQUATIONS.values()}))
def test_places_exist(place):
    module, name = place.rsplit(".", 1)
    try:
        owner = importlib.import_module(f"fx_membrane.{module}")
    except ModuleNotFoundError:  # a method
        module, owner_name = module.rsplit(".", 1)
        owner = getattr(importlib.import_module(f"fx_membrane.{module}"), owner_name)
    assert callable(getattr(owner, name))
