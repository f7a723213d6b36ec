"""Form finding in case files: the forms of scripts, constraints by method, and refusals in words."""

import re
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane import (
    Analysis,
    Cable,
    CableForce,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    Pressure,
    RadialDirection,
    RoundHole,
    Structure,
    Support,
    boundary_edges,
    force_density,
    masts_and_stays,
    natural_force_density,
    polyline,
    prescribed_stress,
    projected_stress,
    rectangle,
    remeshed,
    sail_mesh,
    updated_reference,
    write_mesh,
)
from fx_membrane.files.cases import forms
from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError

pytestmark = pytest.mark.filterwarnings("ignore:The form is in equilibrium")

TENT = """
format = 1
geometry = { kind = "file", file = "tent.obj" }
materials.pvc = { kind = "fabric", Et = 500, nu = 0.3 }
parts.film = { kind = "membrane", material = "pvc", prestress = 2 }
parts.edge = { kind = "cable", axial_stiffness = 1e4, prestress = 40 }
supports = [{ nodes = [0, 4, 20, 24] }]
"""


def tent():
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    points[:, 2] = points[:, 0] * points[:, 1] / 4
    parts = {
        "film": Membrane(triangles, Fabric(500.0, 0.3), 2.0),
        "edge": Cable(boundary_edges(triangles), 1e4, prestress=40.0),
    }
    return Structure(points, parts, [Support([0, 4, 20, 24])])


def case_of(folder, text, head=TENT):
    write_mesh(tent(), folder / "tent.obj")
    (folder / "tent.toml").write_text(head + text, encoding="utf-8")
    return read_case(folder / "tent.toml")


def refused(folder, text, head=TENT):
    """Lines of the faults of a case."""
    with pytest.raises(CaseError) as caught:
        case_of(folder, text, head)
    return [line.split("tent.toml:", 1)[1] for line in caught.value.lines]


METHODS = {
    "projected stress": (
        """cables = "force density"
        loads = [{ kind = "pressure", part = "film", pressure = 0.1 }]
        constraints = [{ kind = "cable force", part = "edge", force = 15, cells = [0, 1, 2, 3] }]""",
        lambda sail: projected_stress(
            sail,
            [Pressure(0.1, "film")],
            cables="force density",
            constraints=[CableForce("edge", 15.0, range(4))],
        ),
    ),
    "natural force density": ("iterations = 2", lambda sail: natural_force_density(sail, iterations=2)),
    "prescribed stress": ("tolerance = 1e-2", lambda sail: prescribed_stress(sail, tolerance=1e-2)),
    "updated reference": (
        'tolerance = 1e-2\nloads = [{ kind = "point", nodes = [12], force = [0, 0, 1] }]',
        lambda sail: updated_reference(sail, [PointLoad(12, (0, 0, 1.0))], tolerance=1e-2),
    ),
}


@pytest.mark.parametrize("method", METHODS)
def test_form_of_a_method_is_that_of_the_script(method, tmp_path):
    options, script = METHODS[method]
    form = case_of(tmp_path, f'[form_finding]\nmethod = "{method}"\n{options}').form()
    expected = script(tent())
    assert np.array_equal(form.points, expected.points)
    assert all(np.array_equal(form.forces[name], expected.forces[name]) for name in ("film", "edge"))


def test_net_of_force_densities_takes_cables_and_other_lines(tmp_path):
    text = """
        [form_finding]
        method = "force density"
        net = [
          { part = "edge", density = [4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5] },
          { lines = [[2, 7, 12, 17, 22], [10, 11, 12, 13, 14]], density = "1 kN/m" },
        ]
        loads = [{ kind = "point", nodes = [12], force = [0, 0, "500 N"] }]
    """
    case = case_of(tmp_path, text, 'units = { force = "kN", length = "m" }\n' + TENT)
    form, sail = case.form(), tent()
    lines = [*sail.parts["edge"].cells, *polyline([2, 7, 12, 17, 22]), *polyline([10, 11, 12, 13, 14])]
    loads = np.zeros((25, 3))
    loads[12, 2] = 0.5
    net = np.unique(lines)
    row = np.searchsorted(net, np.arange(25))
    densities = [4.0] * 8 + [5.0] * 8 + [1.0] * 8
    expected = force_density(sail.points[net], row[lines], densities, [Support(row[[0, 4, 20, 24]])], loads[net])
    assert np.array_equal(form.points[net], expected.points)
    others = np.setdiff1d(np.arange(25), net)
    assert np.array_equal(form.points[others], sail.points[others])
    assert np.array_equal(form.structure.parts["edge"].prestress, expected.forces["net"][:16])


def test_masts_and_stays_follow_a_form(tmp_path):
    text = """
        [[form_finding]]
        method = "projected stress"
        cables = "force density"
        [[form_finding]]
        method = "masts and stays"
        points = [[1.5, 1.5, -3], [4, 2, -3], [2, 4, -3]]
        heads = { nodes = [24] }
        bars.mast = { kind = "mast", E = 2e8, area = 1e-3, cells = [[25, 24]] }
        bars.stays = { kind = "cable", axial_stiffness = 1e4, cells = [[26, 24], [27, 24]] }
        [[stages]]
        name = "form"
        [[stages]]
        name = "pull"
        loads = [{ kind = "line", part = "mast", load = [0, 0, -0.1] }]
    """
    case = case_of(tmp_path, text)
    form = projected_stress(tent(), cables="force density")
    bars = {"mast": Mast([[25, 24]], 2e5), "stays": Cable([[26, 24], [27, 24]], 1e4)}
    expected = masts_and_stays(form, bars, [(1.5, 1.5, -3), (4, 2, -3), (2, 4, -3)], heads=[24])
    found = case.form()
    assert np.array_equal(found.points, expected.points)
    assert found.forces.keys() == expected.forces.keys()
    assert all(np.array_equal(found.forces[name], forces) for name, forces in expected.forces.items())
    states = Analysis(found.structure, progress=False).run(case.stages_of(found.structure))
    assert states["form"].largest_displacement < 1e-9


SAIL = """
format = 1
materials.pvc = { kind = "neo-hooke", E = 5e5, thickness = 1e-3 }
parts.sail = { kind = "membrane", material = "pvc", prestress = 2, warp = { origin = [3, 3, 0] } }
parts.edge = { kind = "cable", group = ["A-B", "B-C", "C-D", "D-A"], axial_stiffness = 1e4, prestress = 20 }
supports = [{ group = "A" }, { group = "B" }, { group = "C" }, { group = "D" }, { group = "ring" }]
[geometry]
kind = "sail"
corners = { A = [0, 0], B = [6, 0], C = [6, 6], D = [0, 6] }
size = 1.5
sag = 0.05
holes.ring = { centre = [3, 3, 2], radius = 0.5 }
lines.valley = ["A", ["ring", 0.625]]
"""


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


CONSTRAINTS: dict[str, tuple[str, dict[str, Any]]] = {
    "CableForce": ('kind = "cable force", part = "edge", force = "15 kN", horizontal = true', {"force": 15.0}),
    "CableDensity": ('kind = "cable density", part = "edge", density = 3, cells = [1, 2]', {"density": 3.0}),
    "CableLength": ('kind = "cable length", part = "edge", length = "450 cm"', {"length": 4.5}),
    "CableSag": ('kind = "cable sag", part = "edge", sag = 0.4, along = [0, 0, 1]', {"sag": 0.4}),
    "EdgeAngle": ('kind = "edge angle", part = "edge", angle = 30, where = { x = -2 }', {"angle": 30.0}),
    "Slide": ('kind = "slide", nodes = [10, 14], normal = [0, 1, 1]', {"direction": None}),
    "Ring": ('kind = "ring", nodes = [6, 8, 16, 18], radius = 0.9', {"radius": 0.9}),
    "RigidBody": ('kind = "rigid body", nodes = [11, 12]', {}),
}


@pytest.mark.parametrize("name", CONSTRAINTS)
def test_each_constraint_reaches_the_method(name, tmp_path, monkeypatch):
    seen = {}

    def method(structure, loads, constraints=()):
        seen["constraints"] = constraints
        return projected_stress(structure, cables="force density")

    monkeypatch.setitem(forms.METHODS, "projected stress", method)
    table, fields = CONSTRAINTS[name]
    text = f'[form_finding]\nmethod = "projected stress"\nconstraints = [{{ {table} }}]'
    case_of(tmp_path, text, 'units = { force = "kN", length = "m" }\n' + TENT).form()
    (found,) = seen["constraints"]
    assert type(found).__name__ == name
    assert all(getattr(found, field) == value for field, value in fields.items())
    assert getattr(found, "horizontal", "true" in table) is ("true" in table)
    cells = {"CableDensity": [1, 2], "EdgeAngle": [0, 1, 2, 3]}.get(name)
    if cells:
        assert len(found.cells) == len(cells)


def test_constraints_are_refused_where_the_method_takes_none(tmp_path):
    text = """
        [form_finding]
        method = "force density"
        net = [{ part = "edge", density = 1 }]
        constraints = [{ kind = "ring", nodes = [6, 8, 16, 18] }]
    """
    (line,) = refused(tmp_path, text)
    assert "form_finding.constraints: method 'force density' takes no constraints" in line
    assert "projected stress" in line


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ('method = "projected stres"', "form_finding.method", "'projected stress' may be meant"),
        ('method = "projected stress"\ntolerance = -1', "form_finding.tolerance", "tolerance"),
        ('method = "natural force density"\niterations = 0', "form_finding.iterations", "iterations"),
        ('method = "updated reference"\nsteps = 3', "form_finding.steps", "no key of that name"),
        ('method = "force density"', "form_finding.net", "missing"),
        ('method = "force density"\nnet = []', "form_finding.net", "it is empty"),
        ('method = "force density"\nnet = [{ part = "film", density = 1 }]', "form_finding.net.0.part", "no cable"),
        (
            'method = "force density"\nnet = [{ part = "edge", density = [1] }]',
            "form_finding.net.0.density",
            "16 branches",
        ),
        ('method = "masts and stays"\nbars = {}', "form_finding.method", "before them"),
        ('method = "projected stress"\nstress.film.terms = []', "form_finding.stress.film.terms", "terms is empty"),
        (
            'method = "projected stress"\nstress.edge.terms = [{ values = 1, at = 1, power = 0 }]',
            "form_finding.stress.edge",
            "no membrane",
        ),
        (
            'method = "projected stress"\nconstraints = [{ kind = "ring", nodes = [1, 2] }]',
            "form_finding.constraints.0.nodes",
            "at least three",
        ),
        (
            'method = "projected stress"\nconstraints = [{ kind = "cable sag", part = "film", sag = 1 }]',
            "form_finding.constraints.0.part",
            "no cable",
        ),
        (
            'method = "projected stress"\nconstraints = [{ kind = "cable sag", part = "egde", sag = 1 }]',
            "form_finding.constraints.0.part",
            "'edge' may be meant",
        ),
    ],
)
def test_faults_of_form_finding_have_line_and_key(text, key, words, tmp_path):
    (line,) = refused(tmp_path, f"[form_finding]\n{text}\n")
    assert f": {key}: " in line
    assert words in line


@pytest.mark.parametrize(
    ("material", "words"),
    [
        ('{ kind = "fabric", nu = 0.3 }', "give Et, or E and thickness"),
        ('{ kind = "fabric", nu = 0.3, Et = 500, E = 1e6 }', "give Et, or E and thickness, not E and Et"),
        ('{ kind = "mooney-rivlin", C10 = 1, C01 = 1 }', "or C10, C01 and thickness"),
    ],
)
def test_numbers_of_materials_are_whole(material, words, tmp_path):
    head = TENT.replace('{ kind = "fabric", Et = 500, nu = 0.3 }', material)
    (line,) = refused(tmp_path, "", head)
    assert "materials.pvc: " in line
    assert words in line


def test_radial_warp_and_stress_reach_the_method_as_functions_of_place(tmp_path, monkeypatch):
    seen = {}

    def method(structure, loads, stress=None, warp=None):
        seen.update(stress=stress, warp=warp)
        return projected_stress(structure, cables="force density")

    monkeypatch.setitem(forms.METHODS, "prescribed stress", method)
    head = TENT.replace("prestress = 2 }", "prestress = 2, warp = { origin = [-9, 0, 0], axis = [0, 0, 2] } }")
    text = """
        [form_finding]
        method = "prescribed stress"
        [form_finding.stress.film]
        origin = [-9, 0, 0]
        terms = [{ values = [3, 2], at = 2, power = -1 }, { values = [1, 1], at = 1, power = 0 }]
    """
    case_of(tmp_path, text, head).form()
    places = np.array([[-5.0, -8.0], [0.0, 1.0], [3.0, 0.0]])
    assert np.allclose(seen["warp"]["film"](places), [[1, 0, 0], [np.sqrt(0.5), np.sqrt(0.5), 0]], rtol=0, atol=1e-15)
    expected = [[3 * 2 / 4 + 1, 2 * 2 / 4 + 1], [3 * np.sqrt(2) + 1, 2 * np.sqrt(2) + 1]]
    assert np.allclose(seen["stress"]["film"](places), expected, rtol=1e-14)
