"""Sails drawn in plan and new meshes in case files: places and names of points, not numbers of nodes."""

import re

import numpy as np
import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")
from fx_membrane import (
    RadialDirection,
    RoundHole,
    projected_stress,
    remeshed,
    sail_mesh,
)
from sail_cases import SAIL, case_of, refused, tent

pytestmark = pytest.mark.filterwarnings("ignore:The form is in equilibrium")


def test_sail_drawn_in_plan_with_a_radial_warp(tmp_path):
    pytest.importorskip("gmsh")
    found = case_of(tmp_path, "", SAIL).structure
    corners = {"A": (0, 0), "B": (6, 0), "C": (6, 6), "D": (0, 6)}
    holes = {"ring": RoundHole((3, 3, 2), 0.5)}
    mesh = sail_mesh(corners, 1.5, 0.05, holes, {"valley": ["A", ("ring", 0.625)]})
    assert np.array_equal(found.points, mesh.points)
    warp = RadialDirection((3, 3, 0))(mesh.points[mesh.triangles].mean(axis=1).T)
    assert np.array_equal(found.parts["sail"].warp, warp)
    assert np.array_equal(np.unique(found.parts["edge"].cells), np.unique(np.r_[tuple(map(edge_of(mesh), "ABCD"))]))
    assert found.parts["sail"].material.Gt == pytest.approx(500 / 3, rel=1e-14)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ('["Z"]', "'Z'"),
        ('["A-B"]', "'A-B' is the name of"),
        ('[""]', "its name in quotes"),
        ("[true]", "number"),
    ],
)
def test_names_of_nodes_are_those_of_points(wrong, words, tmp_path):
    pytest.importorskip("gmsh")
    (line,) = refused(tmp_path, "", SAIL.replace('{ group = "A" }', f"{{ nodes = {wrong} }}"))
    assert "supports.0" in line
    assert words in line


def edge_of(mesh):
    return lambda corner: mesh.lines[f"{corner}-{'ABCDA'['ABCD'.index(corner) + 1]}"]


def test_new_mesh_carries_stages_that_choose_by_place(tmp_path):
    pytest.importorskip("gmsh")
    text = """
        [[form_finding]]
        method = "projected stress"
        cables = "force density"
        [[form_finding]]
        method = "new mesh"
        size = 0.7
        keep = { nodes = [12] }
        [[stages]]
        name = "snow"
        loads = [
          { kind = "plan", part = "film", load = [0, 0, -0.5], where = { x = [0, 2] } },
          { kind = "point", where = { x = [-0.1, 0.1], y = [-0.1, 0.1] }, force = [0, 0, -1] },
        ]
    """
    case = case_of(tmp_path, text)
    form = case.form()
    expected = remeshed(projected_stress(tent(), cables="force density"), 0.7, [12]).structure
    assert np.array_equal(form.structure.points, expected.points)
    plan, point = case.stages_of(form.structure)[0].loads
    centres = expected.points[expected.parts["film"].cells].mean(axis=1)
    assert np.array_equal(plan.cells, np.flatnonzero(centres[:, 0] >= -1e-8))
    assert len(point.nodes) == 1
    for choice in ("nodes = [12]", 'group = "edge"'):
        words = refused(tmp_path, text.replace("where = { x = [-0.1, 0.1], y = [-0.1, 0.1] }", choice))
        assert len(words) == 1
        assert re.search(r"stages\.0\.loads\.1\.(nodes|group): after a new mesh there are other numbers", words[0])
