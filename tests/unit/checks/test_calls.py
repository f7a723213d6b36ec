"""Functions of a user that take other arguments are refused at the door."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Stage,
    edges_where,
    prescribed_stress,
    projected_stress,
    structure_from_gmsh,
)
from fx_membrane.checks.calls import takes, unfit
from fx_membrane.files.groups import check_arguments
from models import POINTS, SNOW, TRIANGLES, sheet


def none():
    return 3


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: Analysis(sheet()).run([Stage("a", [SNOW])], observe=none),
            r"observe is a function of \(\); give a func",
        ),
        (lambda: edges_where(POINTS, TRIANGLES, none), r"on is a function of \(\); give a function of positions"),
        (
            lambda: projected_stress(sheet(), stress={"fabric": none}),
            r"stress of part 'fabric' is a function of \(\); giv",
        ),
        (
            lambda: prescribed_stress(sheet(), warp={"fabric": none}),
            r"warp of part 'fabric' is a function of \(\); give",
        ),
        (
            lambda: structure_from_gmsh("x.msh", {"f": none}),
            r"The part 'f' is a function of \(\); give a function of its",
        ),
        (lambda: check_arguments({"f": lambda a, b, c: 3}, None), r"The part 'f' is a function of \(a, b, c\); give"),
    ],
)
def test_function_of_other_arguments(call, words):
    with pytest.raises(ValueError, match=f"^{words}"):
        call()


def test_functions_that_fit():
    for function in (np.sin, len, dict, lambda x: x, lambda *x: x, lambda x, y=1: x, "".join):
        assert not unfit(function, 1)
    assert not takes(lambda x, *, y: x, 1)
    assert unfit(3, 1) == "3"
    assert unfit(lambda x, y: x, 1) == "a function of (x, y)"
