"""The contract of energy terms: what is taken, and what is refused in one sentence."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from ufl import dx

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    EnergyTerm,
    Fabric,
    ForceTerm,
    Membrane,
    Stage,
    Structure,
    Support,
    equilibrium_path,
    updated_reference,
)
from fx_membrane.model.stages import check_stages
from models import EDGE, POINTS, TRIANGLES, sheet
from own_terms import ElasticBed, Ground, Water, WaterWork, bed, term

COUNT = len(TRIANGLES)
STRUCTURE = Structure(
    POINTS, {"fabric": Membrane(TRIANGLES, Fabric(1e5, 0.3), 1e3), "edge": Cable([[0, 1]], 1e6)}, [Support(EDGE)]
)


# Taken


@pytest.mark.parametrize(
    ("k", "kept"),
    [
        (3, 3.0),
        (np.float32(2), 2.0),
        ([1] * COUNT, np.ones(COUNT)),
        (np.ones((COUNT, 1), dtype=int), np.ones((COUNT, 1))),
    ],
)
def test_parameters_are_kept_as_numbers(k, kept):
    own = ElasticBed("fabric", k)
    check_stages(STRUCTURE, [Stage("bed", [own])])
    assert np.shape(own.k) == np.shape(kept)
    assert np.array_equal(own.k, kept)
    assert isinstance(own.k, float) or not own.k.flags.writeable


def test_terms_need_no_base_class_and_may_have_methods_of_a_parent():
    @dataclass(frozen=True)
    class Softer(ElasticBed):
        share: float = 0.5

        def energy(self, state, parameters):
            return parameters.share * super().energy(state, parameters)

    for own in (term(bed), Softer("fabric", 3.0)):
        assert Stage("bed", [own, DistributedLoad((0, 0, 1), "fabric")]).loads[0] is own
        assert replace(STRUCTURE, terms=[own]).terms == (own,)


def test_terms_may_be_derived_from_the_protocols():
    @dataclass(frozen=True)
    class Bed(EnergyTerm):
        part: str
        k: float

        def energy(self, state, parameters):
            return parameters.k * state.u[2] ** 2 / 2

    @dataclass(frozen=True)
    class Push(ForceTerm):
        part: str
        k: float

        def virtual_work(self, state, v, parameters):
            return parameters.k * v[2]

    for own in (Bed("fabric", 2.0), Push("fabric", k=3.0)):
        assert replace(STRUCTURE, terms=[own]).terms == (own,)
        assert own.part == "fabric"


def test_value_of_cells_outside_those_of_the_term():
    """A parameter by which the energy divides is not zero there."""

    def energy(self, state, parameters):
        return state.u[2] ** 2 / parameters.k

    own = replace(term(energy, fields=("k", "cells")), cells=[3, 5], k=[2.0, 4.0])
    bed = ElasticBed("fabric", [1.0, 0.5], [3, 5])  # u^2 / 2 times twice the inverse
    load = DistributedLoad((0, 0, -900.0), "fabric")
    state, other = (Analysis(sheet()).run([Stage("a", [made, load])])["a"] for made in (own, bed))
    assert np.abs(state.terms[0].forces).max() > 1e-3
    np.testing.assert_allclose(state.terms[0].forces, other.terms[0].forces, rtol=1e-9, atol=1e-12)
    assert state.energy == pytest.approx(other.energy, rel=1e-9)


# Refused: alone, in a stage


class NotFrozen:
    part, k, energy = "fabric", 2.0, bed


@dataclass(frozen=True)
class Nothing:
    part: str
    k: float = 1.0


@dataclass(frozen=True)
class Nowhere:
    k: float

    def energy(self, state, parameters):
        return parameters.k * state.u[2]


@dataclass(frozen=True)
class Heavier(ElasticBed):
    factor: float = 2.0


class Renamed(ElasticBed):
    pass


@dataclass(frozen=True)
class Deeper(WaterWork):
    def depth(self):
        return 2.0


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (NotFrozen, r"NotFrozen.*class.*no frozen dataclass; write @dataclass\(frozen=True\)"),
        (lambda: term(bed, frozen=False), "Mine.*class.*no frozen dataclass"),
        (lambda: Nothing("fabric"), r"Nothing\(.*with.*method energy\(state, parameters\).*virtual_work"),
        (
            lambda: Heavier("fabric", 1.0),
            r"Heavier.*derived from ElasticBed, .*\(energy = ElasticBed\.energy if.*meant\)",
        ),
        (lambda: Renamed("fabric", 1.0), "Renamed.*derived from ElasticBed, whose energy would be used"),
        (lambda: Deeper("fabric", 1.0, 1.0), "Deeper.*derived from WaterWork, whose virtual_work would be used"),
        (lambda: Nowhere(1.0), "Nowhere without.*part; add.*field part"),
        (lambda: ElasticBed, "class ElasticBed.*object.*brackets behind"),
        (lambda: term(bed, virtual_work=bed), "Mine.*energy.*virtual_work; define one.*two"),
        (lambda: ElasticBed(3, 1.0), "ElasticBed part is 3; give a text"),
        (lambda: ElasticBed("fabric", "soft"), "ElasticBed k.*text 'soft'.*number"),
        (lambda: ElasticBed("fabric", None), "ElasticBed k.*number.*None"),
        (lambda: ElasticBed("fabric", True), "ElasticBed k.*number.*True"),
        (lambda: ElasticBed("fabric", np.nan), "ElasticBed k is nan.*finite number"),
        (lambda: ElasticBed("fabric", [1.0, np.inf]), r"ElasticBed k has .* not finite \(inf\) at index \(1,\)"),
        (lambda: ElasticBed("fabric", ["a", "b"]), "ElasticBed k.*array.*numbers"),
        (lambda: ElasticBed("fabric", {"k": 1}), "ElasticBed k.*number"),
        (lambda: ElasticBed("fabric", 1.0, cells=[1, 1]), "ElasticBed cells names cell 1 twice"),
        (lambda: ElasticBed("fabric", 1.0, cells=[]), "ElasticBed cells is empty"),
        (lambda: ElasticBed("fabric", 1.0, cells=0.5), "ElasticBed cells.*list.*whole numbers"),
        (lambda: Ground("fabric", 1.0, 0.0, quadrature_degree=99), "Ground quadrature_degree is 99; give a whole"),
        (lambda: Ground("fabric", 1.0, 0.0, quadrature_degree="high"), "Ground quadrature_degree is 'high'"),
        (lambda: term(bed, fields=("_k",)), "Mine.*parameter _k.*name without.*underscore"),
    ],
)
@pytest.mark.parametrize("where", ["stage", "structure"])
def test_refused_alone(make, words, where):
    given = make()
    with pytest.raises(ValueError, match=f"^{'Stage .a.: loads' if where == 'stage' else 'terms'}.*{words}") as refusal:
        _ = Stage("a", [given]) if where == "stage" else replace(STRUCTURE, terms=[given])
    assert str(refusal.value).endswith(".")


# Refused: with a structure


def raising(self, state, parameters):
    return parameters.missing


def missing_argument(self, state):
    return state.u[2]


def works(self, state, v, parameters):
    return {"no v": parameters.k * state.u[2], "square": v[2] ** 2, "rest": v[2] + 1.0}


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ElasticBed("roof", 1.0), r"ElasticBed.*part 'roof'.*not exist.*parts.*\["),
        (
            lambda: ElasticBed("fabric", 1.0, cells=[3, 99]),
            "ElasticBed.*'fabric' names cell 99.*not exist",
        ),
        (lambda: ElasticBed("fabric", [1.0] * 7), rf"parameter k.*shape \(7,\).*{COUNT} cells"),
        (lambda: ElasticBed("fabric", np.ones((COUNT, 2))), r"parameter k.*shape \(32, 2\)"),
        (lambda: ElasticBed("fabric", [1.0, 2.0], cells=[4]), r"parameter k.*shape \(2,\).*1 cells"),
        (lambda: term(raising), "raises AttributeError: .*missing.*; mend it"),
        (lambda: term(missing_argument), r"energy that takes \(state\); let it take \(state, parameters\)"),
        (lambda: term(lambda self, s, p: float(p.k) * s.u[2] ** 2), "raises TypeError.*ufl.sqrt.*float"),
        (lambda: term(lambda self, s, p: float(s.u[2]) ** 2), "raises TypeError.*ufl.sqrt.*float"),
        (lambda: term(lambda self, s, p: np.sqrt(p.k) * s.u[2]), "raises TypeError.*ufl.sqrt.*NumPy"),
        (lambda: term(virtual_work=lambda self, s, v, p: float(v[2])), "raises TypeError.*ufl.sqrt.*float"),
        (lambda: term(lambda self, s, p: p.K * s.u[2]), "raises AttributeError.*K.*u, X, x, F and n.*fields k"),
        (lambda: term(lambda self, state, parameters: None), "returns None; return.*scalar.*UFL"),
        (lambda: term(lambda self, state, parameters: 3.0), r"returns 3\.0; return.*scalar.*UFL"),
        (lambda: term(lambda self, state, parameters: state.u), r"returns a vector of shape \(3,\); return.*scalar"),
        (
            lambda: term(lambda self, state, parameters: state.u[2] * dx),
            "returns an integral; return.*scalar.*UFL without dx",
        ),
        (
            lambda: term(lambda self, state, parameters: parameters.k * state.X[0]),
            "not depend.*displacement",
        ),
        (lambda: term(virtual_work=lambda *a: works(*a)["no v"]), "virtual work.*not linear.*v"),
        (lambda: term(virtual_work=lambda *a: works(*a)["square"]), "virtual work.*not linear.*v"),
        (lambda: term(virtual_work=lambda *a: works(*a)["rest"]), "virtual work.*not linear.*v"),
        (lambda: replace(Water("fabric", 1.0, 1.0), part="edge"), "ValueError: state.n.*normal.*membrane"),
    ],
)
@pytest.mark.parametrize("where", ["stage", "structure", "path"])
def test_refused_with_a_structure(make, words, where):
    given = make()
    place = {
        "structure": lambda: replace(STRUCTURE, terms=[given]),
        "stage": lambda: check_stages(STRUCTURE, [Stage("a"), Stage("b", [given])]),
        "path": lambda: equilibrium_path(STRUCTURE, Stage("b", [given])),
    }[where]
    with pytest.raises(ValueError, match=f"^{'terms' if where == 'structure' else 'Stage .b.'}.*{words}") as refusal:
        place()
    assert str(refusal.value).endswith(".")


def test_normal_of_a_surface_without_sides():
    sheets = [[0, 1, 2], [0, 1, 3], [0, 1, 4]]
    points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]]
    structure = Structure(points, {"fabric": Membrane(sheets, Fabric(1e5, 0.3))})
    for own in (Water("fabric", 1.0, 0.0), WaterWork("fabric", 1.0, 0.0)):
        with pytest.raises(ValueError, match=r"^Part 'fabric' branches"):
            replace(structure, terms=[own])
    assert replace(structure, terms=[ElasticBed("fabric", 1.0)])


def test_terms_that_are_no_list():
    with pytest.raises(ValueError, match=r"^terms.*list.*energy terms.*ElasticBed.*put.*brackets"):
        replace(STRUCTURE, terms=ElasticBed("fabric", 1.0))
    with pytest.raises(ValueError, match=r"^terms has a DistributedLoad; give energy terms"):
        replace(STRUCTURE, terms=[DistributedLoad((0, 0, 1), "fabric")])


def test_form_finding_takes_no_terms():
    with pytest.raises(ValueError, match=r"^The structure.*energy terms .ElasticBed.*'fabric'..*terms="):
        updated_reference(replace(sheet(), terms=[ElasticBed("fabric", 1.0)]))
    with pytest.raises(ValueError, match=r"^loads has ElasticBed"):
        updated_reference(sheet(), [ElasticBed("fabric", 1.0)])


def test_three_numbers_for_three_cells_are_one_vector():
    points, cells = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]], [[0, 1, 4], [1, 2, 4], [2, 3, 4]]
    structure = Structure(points, {"fabric": Membrane(cells, Fabric(1e5, 0.3))})
    with pytest.raises(ValueError, match=r"vector of shape \(3,\).*k: shape \(3,\) is one vector.*\(cells, 1\)"):
        replace(structure, terms=[ElasticBed("fabric", [1.0, 2.0, 3.0])])
    assert replace(structure, terms=[ElasticBed("fabric", [[1.0], [2.0], [3.0]])]).terms
    with pytest.raises(ValueError, match=r"shape \(2,\).*\(3, 1\) or \(3, 3\)\. Shape \(3,\) is always one vector\.$"):
        replace(structure, terms=[ElasticBed("fabric", [1.0, 2.0])])


# README


def test_recipe_of_the_readme():
    readme = (Path(__file__).parents[3] / "README.md").read_text()
    recipe = readme.split("### A load\n")[1].split("\n### ")[0]
    script = "\n".join(line[4:] for line in recipe.splitlines() if line.startswith("    "))
    names = {"dataclass": dataclass}
    exec(script, names)
    uses = [use.split("`")[0] for use in (recipe.split("`Stage(")[1], recipe.split("`Structure(")[1])]
    own = eval(uses[0].split("[")[1].split("]")[0], names)
    assert uses[1] == f'..., terms=[ElasticBed("{own.part}", 2e3)])'
    state = Analysis(sheet()).run([Stage("bed", [own, DistributedLoad((0, 0, -50.0), "fabric")])])["bed"]
    assert state.terms[0].forces[:, 2].sum() > 1
