"""Volumes of chambers that are refused: none to seal, and given ones under solvers without a pressure for them."""

import re
from dataclasses import replace

import pytest

from cushions import SEAL, cushion, run
from fx_membrane import Chamber, ConjugateGradient, GasVolume, Stage


def test_first_order_methods_keep_no_volume():
    with pytest.raises(ValueError, match=re.escape("ConjugateGradient finds no pressure that holds it; take Newton()")):
        run(Stage("fill", changes=[GasVolume(0.8, "gas")]), solver=ConjugateGradient())


def test_nothing_to_seal():
    flat = cushion(height=0.0, separate=[("top", "bottom")], chambers={"gas": Chamber({"top": 1, "bottom": -1})})
    with pytest.raises(ValueError, match="closes chamber 'gas', whose volume is 0 at its start"):
        run(Stage("rest"), replace(SEAL, after="rest"), structure=flat)
