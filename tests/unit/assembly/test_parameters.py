"""Derivatives of the residual by parameters, against residuals of structures with other parameters.

Remainders |R(p + h dp) - R(p) - h dR| fall with h^2, or are rounding where the residual is linear in the parameter.
"""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Membrane,
    MooneyRivlin,
    NeoHooke,
    PointLoad,
    Pressure,
    Problem,
    Structure,
    Support,
    _dolfinx,
)
from fx_membrane.assembly.actions import between
from fx_membrane.results.evaluation import StateEvaluator
from models import CENTRE, MIXED, end, inclined_sheet
from observed_orders import rates

STEPS = 1e-3 / 2.0 ** np.arange(3)  # fractions of a parameter
SHEAR = np.random.default_rng(8).normal(size=(4, 2, 2))
SHAPE = 0.1 * np.random.default_rng(6).normal(size=MIXED.points.shape)

# Part, parameter, and its change; a number stands for that times the parameter itself.
PARAMETERS = [
    ("fabric", "Et", 1.0),
    ("fabric", "nu", 1.0),
    ("woven", "Et_warp", 1.0),
    ("woven", "Et_weft", -1.0),
    ("woven", "nu", 1.0),
    ("woven", "Gt", 1.0),
    ("edge", "axial_stiffness", 1.0),
    ("mast", "axial_stiffness", -2.0),
    ("fabric", "prestress", 1.0),
    ("woven", "prestress", (30.0, -20.0)),
    ("woven", "prestress", 20 * (SHEAR + SHEAR.swapaxes(1, 2))),
    ("edge", "prestress", [50.0, -10.0]),
    ("mast", "prestress", 1.0),
]


def changed(structure, part, parameter, direction, h):
    """Structure with another parameter, and its change for h = 1."""
    given = structure.parts[part]
    if parameter == "prestress":
        own = given.prestress_tensors() if np.ndim(direction) else np.asarray(given.prestress)
        step = replace(given, prestress=direction).prestress_tensors() if np.ndim(direction) else own * direction
        if own.ndim == 3 and own.shape[1] == 1:
            own, step = own[:, 0, 0], step[:, 0, 0]
        other = replace(given, prestress=own + h * step)
    else:
        step = direction * getattr(given.material, parameter)
        material = replace(given.material, **{parameter: getattr(given.material, parameter) + h * step})
        follows = {"axial_stiffness": None} if hasattr(given, "axial_stiffness") else {}
        other = replace(given, material=material, **follows)
    return Structure(structure.points, {**structure.parts, part: other}, structure.supports), step


def foils():
    """Two incompressible foils side by side."""
    fabric, woven = MIXED.parts["fabric"].cells, MIXED.parts["woven"].cells
    parts = {
        "rubber": Membrane(fabric, NeoHooke(700.0), 50.0),
        "foil": Membrane(woven, MooneyRivlin(300.0, 80.0), 40.0),
    }
    return Structure(MIXED.points, parts, [Support([0, 2])])


FOILS = [
    ("rubber", "Gt", 1.0),
    ("foil", "C10t", 1.0),
    ("foil", "C01t", 1.0),
    ("foil", "prestress", 1.0),
]


# On several processes one of each kind: constants and fields, of membranes, bars and foils.
KINDS = [("fabric", "Et"), ("edge", "axial_stiffness"), ("woven", "prestress"), ("edge", "prestress"), ("foil", "C10t")]
ALL = [pytest.param(*given, marks=[pytest.mark.mpi] if given[:2] in KINDS else []) for given in [*PARAMETERS, *FOILS]]


@pytest.mark.parametrize(("part", "parameter", "direction"), ALL)
def test_derivative_by_a_parameter_of_a_part(part, parameter, direction):
    """Random shape, with cells in all states."""
    structure = MIXED if part in MIXED.parts else foils()
    problem = Problem(structure)
    view, x = problem.under(), problem.to_petsc(SHAPE)
    before = problem.to_numpy(view.residual(x))
    _, step = changed(structure, part, parameter, direction, 0.0)
    exact = problem.to_numpy(view.derivative(x, part, parameter, step))
    assert np.abs(exact).max() > 1e-3
    remainders = []
    for h in STEPS:
        other = Problem(changed(structure, part, parameter, direction, h)[0])
        remainders.append(np.abs(other.to_numpy(other.under().residual(x)) - before - h * exact).max())
    np.testing.assert_allclose(rates(np.array(remainders), np.abs(before).max()), 2, rtol=0, atol=0.1)
    assert remainders[0] < 0.1 * STEPS[0] * np.abs(exact).max()


def test_random_shape_has_cells_in_all_states():
    problem = Problem(MIXED)
    state = StateEvaluator(problem)("random", problem.under(), problem.to_petsc(SHAPE), ())
    assert set(state.membrane("fabric").state) == {"taut", "wrinkled", "slack"}
    assert set(state.membrane("woven").state) == {"taut", "wrinkled"}
    problem = Problem(foils())
    state = StateEvaluator(problem)("random", problem.under(), problem.to_petsc(SHAPE), ())
    assert {"taut", "wrinkled"} <= set(state.membrane("rubber").state) | set(state.membrane("foil").state)


@pytest.mark.mpi_once
@pytest.mark.parametrize("direction", [1.0, np.linspace(-1.0, 2.0, 32)], ids=["even", "each cell"])
def test_derivative_by_a_pressure(direction):
    problem = Problem(inclined_sheet())
    at = 0.1 * np.random.default_rng(2).normal(size=problem.structure.points.shape)
    x = problem.to_petsc(at)
    view = problem.under(end(problem, Pressure(300.0, "fabric")))
    before, exact = (
        problem.to_numpy(b) for b in (view.residual(x), view.derivative(x, "fabric", "pressure", direction))
    )
    for h in (1.0, 100.0):
        pressures = {"fabric": 300.0 + h * np.broadcast_to(direction, 32)}
        other = problem.under(replace(view.actions, pressures=pressures))
        difference = problem.to_numpy(other.residual(x)) - before
        assert np.abs(difference - h * exact).max() < 1e-12 * np.abs(before).max()
    assert np.abs(exact).max() > 1e-3
    assert np.array_equal(problem.to_numpy(view.residual(x)), before)


@pytest.mark.mpi
def test_derivative_by_the_load_factor():
    """Of a stage with loads of fixed direction and pressure, and of all loads."""
    problem = Problem(inclined_sheet())
    x = problem.to_petsc(0.1 * np.random.default_rng(2).normal(size=problem.structure.points.shape))
    start = end(problem, Pressure(300.0, "fabric"))
    final = end(problem, Pressure(-100.0, "fabric", range(9)), PointLoad(CENTRE, (1.0, 2, -30)), start=start)
    view = problem.under(between(start, final, 0.7))
    exact = problem.to_numpy(problem.under(final).load_derivative(x, start))
    before = problem.to_numpy(view.residual(x))
    for h in (0.1, 1.0):
        other = problem.under(between(start, final, 0.7 + h))
        difference = problem.to_numpy(other.residual(x)) - before
        assert np.abs(difference - h * exact).max() < 1e-12 * np.abs(before).max()
    whole = problem.to_numpy(problem.under(final).load_derivative(x))
    none = problem.to_numpy(problem.under().residual(x))
    all_of_them = problem.to_numpy(problem.under(final).residual(x))
    assert np.abs(all_of_them - none - whole).max() < 1e-12 * np.abs(none).max()


@pytest.mark.mpi
def test_nothing_is_compiled_twice(monkeypatch):
    problem = Problem(MIXED)
    view, x = problem.under(), problem.create_vector()
    compiled = []
    form = _dolfinx.form
    monkeypatch.setattr(_dolfinx, "form", lambda *args: compiled.append(1) or form(*args))
    for _ in range(3):
        for part, parameter, direction in PARAMETERS:
            view.derivative(x, part, parameter, direction)
        problem.mass()
        count = len(compiled)
        compiled.clear()
    assert count == 0


def test_derivative_by_a_modulus_is_zero_without_elasticity():
    problem = Problem(MIXED, elastic=False)
    x = problem.to_petsc(0.1 * np.random.default_rng(2).normal(size=MIXED.points.shape))
    assert not problem.to_numpy(problem.under().derivative(x, "fabric", "Et")).any()
    assert problem.to_numpy(problem.under().derivative(x, "fabric", "prestress")).any()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("sail", "Et"), r"^No part.*'sail'.*structure.*\['fabric', 'woven', 'edge', 'mast'\]"),
        ((3, "Et"), r"^No part is named 3"),
        (
            ("woven", "Et"),
            r"^Part 'woven' has no parameter 'Et'; .*\['prestress', 'natural_stretch', 'Et_warp', .*, 'Gt', 'pre",
        ),
        (("edge", "pressure"), r"^Part 'edge' has no parameter 'pressure'"),
        (("edge", "mass"), r"^Part 'edge' has no parameter 'mass'"),
        (("fabric", "Et", [1.0, 2.0]), r"direction of 'Et'"),
        (("fabric", "pressure", [1.0, 2.0]), r"direction of 'pressure' has shape \(2,\); .* 4 cells"),
        (("fabric", "pressure", "much"), r"direction of 'pressure'"),
        (("edge", "prestress", [1.0, 2.0, 3.0]), r"direction of 'prestress' has shape \(3,\)"),
        (("woven", "prestress", [[0.0, 1.0], [2.0, 0.0]]), r"'prestress'.*not symmetric"),
        (("edge", "natural_stretch", (1.0, 2.0, 3.0)), r"'natural_stretch' has shape \(3,\)"),
        (("edge", "prestress", np.nan), r"not finite"),
    ],
)
def test_bad_parameters_are_refused(arguments, message):
    problem = Problem(MIXED)
    with pytest.raises(ValueError, match=message):
        problem.under().derivative(problem.create_vector(), *arguments)
