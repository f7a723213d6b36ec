"""Forms of masts between guys: found wherever their forces balance, refused without a claim that none exists."""

from itertools import pairwise

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Mast,
    PointLoad,
    Stage,
    Structure,
    Support,
    updated_reference,
)
from fx_membrane.form_finding.masts.bar_balance import balanced_points

ANGLES = np.radians([0, 120, 240])
FEET = np.column_stack([3 * np.cos(ANGLES), 3 * np.sin(ANGLES), 0 * ANGLES])


def guyed(force, head=(0.0, 0, 4), unit=1.0, guy=1e3):
    points = np.vstack([[[0, 0, 0], head], FEET])
    parts = {
        "mast": Mast([[0, 1]], 2e8 * unit, prestress=force * unit),
        "guys": Cable([[1, 2], [1, 3], [1, 4]], 12e6 * unit, prestress=np.multiply(guy, unit)),
    }
    return Structure(points, parts, [Support([0, 2, 3, 4])])


def divided(force, count):
    """Make the same with guys of several cells."""
    head, points, cells = np.array([0.0, 0, 4]), [[0.0, 0, 0], [0, 0, 4]], []
    for foot in FEET:
        line = head + np.linspace(0, 1, count + 1)[1:, None] * (foot - head)
        nodes = [1, *range(len(points), len(points) + count)]
        points += list(line)
        cells += list(pairwise(nodes))
    feet = np.arange(1 + count, len(points), count)
    parts = {"mast": Mast([[0, 1]], 2e8, force), "guys": Cable(cells, 12e6, 1e3)}
    return Structure(np.array(points), parts, [Support([0, *feet])])


def height(push):
    """Where three guys of 1 kN balance it: 3000 h / sqrt(9 + h^2) = push."""
    share = push / 3000
    return 3 * share / np.sqrt(1 - share**2)


@pytest.mark.study
@pytest.mark.parametrize("push", [2400.0, 2399, 2500, 2900, 2000, 1000, 500])
@pytest.mark.parametrize("unit", [1e-3, 1.0], ids=["kN", "N"])
def test_head_comes_where_the_forces_balance(push, unit):
    form = updated_reference(guyed(-push, unit=unit))
    assert form.converged
    assert form.structure.points[1] == pytest.approx([0, 0, height(push)], abs=1e-9)
    assert form.structure.parts["mast"].prestress == pytest.approx([-push * unit], rel=1e-9)
    rest = Analysis(form.structure).run([Stage("form")])["form"]
    assert rest.largest_displacement < 1e-9
    assert updated_reference(form.structure).structure.points == pytest.approx(form.structure.points, abs=1e-9)


@pytest.mark.parametrize("head", [(0.1, 0, 4), (0.5, 0.2, 4), (-0.3, 0.4, 3)])
def test_first_shape_need_not_be_symmetric(head):
    form = updated_reference(guyed(-2390.0, head))
    assert form.structure.points[1] == pytest.approx([0, 0, height(2390.0)], abs=1e-9)


@pytest.mark.parametrize("count", [2, 3])
def test_guys_of_several_cells(count):
    form = updated_reference(divided(-2300.0, count))
    assert form.structure.points[1] == pytest.approx([0, 0, height(2300.0)], abs=1e-6)
    assert Analysis(form.structure).run([Stage("form")])["form"].largest_displacement < 1e-6


@pytest.mark.mpi
def test_load_on_the_head_counts():
    load = PointLoad(1, (0, 0, 200.0))
    form = updated_reference(guyed(-2400.0), [load])
    assert form.structure.points[1] == pytest.approx([0, 0, height(2600.0)], abs=1e-9)
    rest = Analysis(form.structure).run([Stage("form", [load])])["form"]
    assert rest.largest_displacement < 1e-9


def test_uneven_guys():
    form = updated_reference(guyed(-1000.0, (0.1, 0.2, 1.2), guy=[1e3, 1e3, 1.1e3]))
    head = form.structure.points[1]
    assert head[2] > 0.9
    ways = head - np.vstack([form.structure.points[0], FEET])
    forces = np.array([-1000.0, 1e3, 1e3, 1.1e3])
    assert forces @ (ways / np.linalg.norm(ways, axis=1, keepdims=True)) == pytest.approx(np.zeros(3), abs=1e-8)


@pytest.mark.parametrize("push", [3000.0, 3100.0, 1e4])
def test_more_than_the_guys_can_hold_is_refused(push):
    structure = guyed(-push)
    assert balanced_points(structure, np.zeros((5, 3)), print) is None
    with pytest.raises(RuntimeError, match=r"no length.*balances.*forces.*ends; hold.*mast"):
        updated_reference(structure)
