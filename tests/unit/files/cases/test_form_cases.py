"""Form finding in case files: the forms of scripts, constraints by method, and refusals in words."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane import (
    Analysis,
    Cable,
    CableForce,
    GeodesicDirection,
    Mast,
    PointLoad,
    Pressure,
    Support,
    force_density,
    masts_and_stays,
    natural_force_density,
    polyline,
    prescribed_stress,
    projected_stress,
    updated_reference,
)
from fx_membrane.files.cases import forms
from sail_cases import TENT, case_of, tent

pytestmark = pytest.mark.filterwarnings("ignore:The form is in equilibrium")


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


def test_cables_in_balance_with_stress_in_plan_are_those_of_the_script(tmp_path):
    woven = TENT.replace("prestress = 2 }", "prestress = [3, 2], warp = [1, 1, 0] }")
    text = '[form_finding]\nmethod = "projected stress"\ncables = "balanced force"'
    form = case_of(tmp_path, text, woven).form()
    film = replace(tent().parts["film"], prestress=(3.0, 2.0), warp=(1.0, 1.0, 0.0))
    sail = replace(tent(), parts=tent().parts | {"film": film})
    expected = projected_stress(sail, cables="balanced force")
    assert np.array_equal(form.points, expected.points)
    assert np.array_equal(form.forces["edge"], expected.forces["edge"])
    assert not np.allclose(form.forces["edge"], projected_stress(sail).forces["edge"], rtol=1e-3)


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


WOVEN = TENT.replace("prestress = 2 }", "prestress = [3, 2], warp = [1, 0, 0] }")


def test_geodesics_reach_the_method_as_pairs_of_nodes(tmp_path):
    pytest.importorskip("potpourri3d")
    text = """
        [form_finding]
        method = "prescribed stress"
        tolerance = 1e-2
        geodesics = { film = [[0, 20], [4, 24]] }
    """
    case = case_of(tmp_path, text, WOVEN)
    expected = prescribed_stress(case.structure, warp={"film": GeodesicDirection([[0, 20], [4, 24]])}, tolerance=1e-2)
    assert np.array_equal(case.form().points, expected.points)


@pytest.mark.parametrize(
    ("pairs", "words"),
    [
        ("{ film = [[0, 0]] }", "form_finding.geodesics.film.*node twice"),
        ("{ edge = [[0, 20]] }", "form_finding.geodesics.edge.*membrane"),
        ("{ film = [[0, 'a']] }", "form_finding.geodesics.film.*'a'"),
        ("{ film = 3 }", "form_finding.geodesics.film"),
    ],
)
def test_geodesics_that_are_none_are_named_with_their_place(tmp_path, pairs, words):
    with pytest.raises(ValueError, match=words):
        case_of(tmp_path, f'[form_finding]\nmethod = "prescribed stress"\ngeodesics = {pairs}', WOVEN).form()
