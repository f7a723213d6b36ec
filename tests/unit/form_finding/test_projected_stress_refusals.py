"""Form finding with stress in plan refuses bad input."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Mast,
    Membrane,
    Pressure,
    Structure,
    Support,
    projected_stress,
    rectangle,
)
from own_terms import ElasticBed
from sails import FABRIC, sail


def warped(structure, warp):
    return replace(structure, parts={"film": replace(structure.parts["film"], warp=warp)})


def upright():
    points, triangles = rectangle(4.0, 4.0, 2, 2)
    points = points[:, [0, 2, 1]] + [0, 1, 0] * points[:, 1:2] ** 2 * (points[:, 1:2] > 0)
    return Structure(points, {"film": Membrane(triangles, FABRIC, 1e3)}, [Support(range(3))])


def tilted():
    structure = sail()
    return replace(structure, points=structure.points + structure.points[:, :1] * [0, 0, 2])


def folded():
    structure = sail()
    points = structure.points.copy()
    points[40, :2] += 0.6
    points[40, 2] = 1.0
    return replace(structure, points=points)


def bars(kind, prestress, ends=(0, 8)):
    points = np.array([[0.0, 0, 0], [0, 0, 3], [1, 0, 0], [0, 1, 0]])
    parts = {"bar": kind([[0, 1]], 1e6, prestress), "guys": Cable([[1, 2], [1, 3]], 1e6, 1e3)}
    return Structure(points, parts, [Support([0, 2, 3])])


REFUSED = [
    (lambda: projected_stress(sail(prestress=(3e3, 0.0))), r"'film', cell 0 at \(.*not positive.*0; give a tension"),
    (lambda: projected_stress(sail(prestress=[[1e3, 2e3], [2e3, 1e3]])), r"'film'.*not positive.*-1000"),
    (lambda: projected_stress(sail(), stress={"film": lambda x: 1e3 * x[0]}), r"'film', cell \d+ at .*not positive"),
    (lambda: projected_stress(sail(), stress={"film": lambda x: np.ones(7)}), r"stress of part 'film'.*shape \(7,\)"),
    (lambda: projected_stress(sail(), stress={"film": 1e3}), "stress of part 'film' is 1000.*function of place"),
    (lambda: projected_stress(sail(), stress={"roof": len}), "stress names 'roof'"),
    (lambda: projected_stress(upright()), r"'film', cell 0 at .*no area in plan"),
    (lambda: projected_stress(folded()), r"'film' folds over itself in plan at cell \d+, \("),
    (lambda: projected_stress(warped(folded(), (1.0, 0, 0)), direction=(0, 0, 0)), "direction"),
    (
        lambda: projected_stress(warped(tilted(), (0.0, 0, 1))),
        r"'film', cell 0 at .*warp .* vanishes in plan",
    ),
    (lambda: projected_stress(replace(sail(), supports=[])), r"Node 0 at .*in x; support"),
    (lambda: projected_stress(replace(sail(), supports=[Support(range(81), "xy")])), r"Node 0 at .*in z"),
    (lambda: projected_stress(bars(Cable, 0.0), cables="weight"), "cables is 'weight'.*horizontal force"),
    (lambda: projected_stress(bars(Cable, 1e3)), r"'bar', cell 0 at .*no length in plan.*cables=\"force\""),
    (lambda: projected_stress(bars(Cable, -1e3)), r"'bar', cell 0 at .*-1000, is in compression"),
    (lambda: projected_stress(bars(Mast, -1e3)), r"'bar', cell 0 at .*-1000, has an end that is not held"),
    (lambda: projected_stress(sail(), [Pressure(1.0, "roof")]), "'roof'"),
    (lambda: projected_stress(sail(), tolerance=0.0), "tolerance"),
    (lambda: projected_stress(replace(sail(), terms=[ElasticBed("film", 1.0)])), "energy terms"),
]


def test_numbers_of_a_function_of_place_are_by_cell():
    form = projected_stress(sail(), stress={"film": lambda x: np.full(x.shape[1], 2e3)})
    expected = projected_stress(sail(prestress=2e3))
    assert np.array_equal(form.points, expected.points)


@pytest.mark.parametrize("number", range(len(REFUSED)))
def test_refusals(number):
    call, message = REFUSED[number]
    with pytest.raises(ValueError, match=message):
        call()


def test_stresses_that_differ_too_much_are_refused():
    structure = sail(prestress=1e-13, warp=None)
    rigid = Cable(structure.parts["film"].cells[60:61, :2], 1e6, 1e9)
    with pytest.raises(ValueError, match="differ so much"):
        projected_stress(replace(structure, parts={**structure.parts, "rigid": rigid}))


def test_loads_that_grow_faster_than_the_stress_holds_are_refused():
    with pytest.raises(RuntimeError, match="grow with the form"):
        projected_stress(sail(prestress=1e2), [Pressure(1e3, "film")])
