"""Ponds, ropes and cables of given force in case files."""

import numpy as np
import pytest

from fx_membrane import FixedLength, GivenForce, Pond, Rope, UnstressedLength

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError
from roof_case import changed

CASE = """
format = 1
title = "Roof in the rain"
units = { force = "kN", length = "m" }
[geometry]
kind = "grid"
width = 8
height = 8
columns = 4
rows = 4
[materials.cloth]
kind = "fabric"
Et = 600
nu = 0.3
[parts.roof]
kind = "membrane"
group = "grid"
material = "cloth"
prestress = 2
[parts.edge]
kind = "rope"
edges_of = "roof"
where = { y = -4 }
axial_stiffness = "5 MN"
prestress = "20 kN"
[[supports]]
rim_of = "roof"
[[stages]]
name = "rain"
[[stages.loads]]
kind = "pond"
part = "roof"
rain = "5 cm"
weight = "9810 N/m3"
walls = { where = { y = 4 } }
[[stages]]
name = "jack"
after = "rain"
[[stages.changes]]
kind = "given force"
part = "edge"
force = "30 kN"
[[stages]]
name = "fixed"
after = "jack"
[[stages.changes]]
kind = "fixed length"
part = "edge"
[[stages]]
name = "cut"
after = "rain"
[[stages.changes]]
kind = "unstressed length"
part = "edge"
length = "7990 mm"
"""


def read(tmp_path, *changes):
    (tmp_path / "case.toml").write_text(changed(CASE, *changes))
    return read_case(tmp_path / "case.toml")


def test_case_is_that_of_the_script(tmp_path):
    case = read(tmp_path)
    rope = case.structure.parts["edge"]
    assert isinstance(rope, Rope)
    assert rope.axial_stiffness == 5e3
    assert rope.prestress == 20
    assert sorted(case.structure.points[rope.nodes, 0]) in ([-4, -2, 0, 2, 4], [4, 2, 0, -2, -4])
    assert np.all(np.abs(np.diff(case.structure.points[rope.nodes, 0])) == 2)
    pond = case.stages[0].loads[0]
    walls = np.flatnonzero(case.structure.points[:, 1] == 4)
    assert pond == Pond("roof", rain=0.05, weight=9.81, walls=walls)
    changes = [stage.changes[0] for stage in case.stages[1:]]
    assert changes == [GivenForce(30, "edge"), FixedLength("edge"), UnstressedLength(7.99, "edge")]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('rain = "5 cm"', "", "no level, volume or rain"),
        ('rain = "5 cm"', 'rain = "5 cm"\nvolume = 2', "one of level, volume and rain"),
        ('weight = "9810 N/m3"', "", "weight"),
        ('part = "roof"\nrain', 'part = "edge"\nrain', "edge"),
        ('prestress = "20 kN"', 'prestress = "20 kN"\nforce = 3', "prestress 20 and force 3"),
        ('force = "30 kN"', "force = -2", "positive"),
    ],
)
def test_faults_are_told_with_their_place(tmp_path, old, new, words):
    with pytest.raises(CaseError, match=words):
        read(tmp_path, (old, new))
