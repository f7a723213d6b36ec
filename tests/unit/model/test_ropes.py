"""Ropes: refused input, the unstressed length in a structure, and changes that do not fit."""

from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    FixedLength,
    GivenForce,
    Mast,
    Membrane,
    PointLoad,
    Rope,
    Stage,
    Structure,
    Support,
    UnstressedLength,
    projected_stress,
    rectangle,
    remeshed,
)
from fx_membrane.analysis.stage_check import check_run

POINTS = [(0, 0, 0), (3, 0, 0), (6, 0, 4)]
STRUCTURE = Structure(
    POINTS,
    {"rope": Rope([0, 1, 2], 1e6, prestress=1e3), "mast": Mast([[0, 1]], 1e7), "stays": Cable([[1, 2], [0, 2]], 1e6)},
    [Support([0, 2])],
)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ({"nodes": [3]}, "two"),
        ({"nodes": [0, 4, 4, 2]}, "node 4 twice in a row"),
        ({"nodes": [0, 1, 0, 2]}, "twice between nodes 0 and 1"),
        ({"nodes": [5, 3, 4, 5, 3]}, "twice between nodes 5 and 3"),
        ({"axial_stiffness": 0.0}, "axial_stiffness"),
        ({"unstressed_length": 0.0}, "unstressed_length"),
        ({"unstressed_length": -2.0}, "unstressed_length"),
        ({"force": 0.0}, "force"),
        ({"prestress": -1.0}, "prestress"),
        ({"prestress": [1.0, 2.0]}, "Rope prestress"),
        ({"prestress": 5.0, "force": 2.0}, "prestress 5 and force 2"),
        ({"unstressed_length": 5.0, "force": 2.0}, "one of the two"),
        ({"compression_stiffness": 0.0}, "compression_stiffness"),
    ],
)
def test_bad_rope_is_refused_in_a_sentence(data, words):
    with pytest.raises(ValueError, match=words) as error:
        Rope(**{"nodes": [0, 1, 2], "axial_stiffness": 1e6} | data)
    assert str(error.value).endswith(".")


@pytest.mark.parametrize(
    ("rope", "words"),
    [
        (Rope([0, 1, 7], 1e6), "node 7"),
        (Rope([0, 1, -1], 1e6), "node -1"),
        (Rope([0, 1, 2], 1e6, unstressed_length=80.0), "unstressed_length 80"),
        (Rope([0, 1, 2], 1e6, unstressed_length=16.0), "unstressed_length 16"),
        (Rope([0, 1, 2], 1e6, unstressed_length=7.0, natural_stretch=1.1), "one of the two"),
    ],
)
def test_rope_that_does_not_fit_the_structure_is_refused(rope, words):
    with pytest.raises(ValueError, match=words):
        Structure(POINTS, {"rope": rope}, [Support([0, 2])])


def test_unstressed_length_becomes_a_natural_stretch_that_stays_in_copies():
    made = Structure(POINTS, {"rope": Rope([0, 1, 2], 1e6, unstressed_length=8.4)}, [Support([0, 2])])
    assert made.parts["rope"].natural_stretch == pytest.approx(8.4 / 8)
    again = Structure(made.points, made.parts, made.supports)
    assert again.parts["rope"] == made.parts["rope"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (GivenForce(1e3, "mast"), "a Mast"),
        (GivenForce(1e3, "rope", cells=[0]), "some cells"),
        (UnstressedLength(1.0, "stay"), "does not exist"),
        (UnstressedLength(1.0, "stays", cells=[5]), "cell 5"),
        (UnstressedLength(40.0, "rope"), "times as long"),
        (FixedLength("rope"), "follows no stage"),
    ],
)
def test_change_that_does_not_fit_is_refused(change, words):
    with pytest.raises(ValueError, match=words):
        Analysis(STRUCTURE, progress=False).run([Stage("change", changes=[change])])


@pytest.mark.parametrize("make", [lambda: GivenForce(0.0, "rope"), lambda: UnstressedLength(-1.0, "rope")])
def test_numbers_that_are_not_positive_are_refused(make):
    with pytest.raises(ValueError, match="positive"):
        make()


def test_form_finding_and_remeshing_tell_that_they_know_no_ropes():
    points, triangles = rectangle(1.0, 1.0, 2, 2)
    parts = {"roof": Membrane(triangles, Fabric(1e5, 0.3), 1e3), "edge": Rope([0, 1, 2], 1e6, 1e3)}
    made = Structure(points, parts, [Support([0, 2, 6, 8])])
    with pytest.raises(ValueError, match=r"Rope 'edge'.*Cable"):
        projected_stress(made)
    with pytest.raises(ValueError, match="Rope 'edge'"):
        remeshed(made, 0.3)


def test_path_that_ends_where_it_begins_is_a_ring():
    points = [(0, 0, 0), (4, 0, 0), (2, 3, 0)]
    made = Structure(points, {"ring": Rope([0, 1, 2, 0], 1e5, force=50.0)}, [Support([0, 1]), Support(2, "xz")])
    state = Analysis(made, progress=False).run([Stage("pull", [PointLoad(2, (0, 80, 0))])])["pull"]
    sides = np.linalg.norm(state.position - state.position[[1, 2, 0]], axis=1)
    assert state.rope("ring").length == pytest.approx(sides.sum())
    assert 2 * 50 * state.position[2, 1] / sides[1] == pytest.approx(80)


@pytest.mark.parametrize(
    ("supports", "stages", "words"),
    [
        ([0], [Stage("rest")], r"'rope'.* node 2\b"),
        ([0, 2], [Stage("rest")], r"'rope' passes node 1\b"),
        ([0, 2], [Stage("rest"), Stage("pull", [PointLoad(1, (0, 0, -10.0))], after="rest")], ""),
    ],
    ids=["free end", "loose node", "node loaded later"],
)
def test_rope_over_a_loose_node_is_refused(supports, stages, words):
    points = np.array([(0, 0, 0), (2, 0, -1), (4, 0, 0)], dtype=float)
    parts: dict[str, Any] = {"rope": Rope([0, 1, 2], 1e6, unstressed_length=4.4)}
    if supports == [0]:
        parts["stay"] = Cable([[0, 1]], 1e6)
    made = Structure(points, parts, [Support(supports), *([] if 2 in supports else [Support(1)])])
    with pytest.raises(ValueError, match=words) if words else nullcontext():
        check_run(made, stages)
