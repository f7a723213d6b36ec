"""Digests of energy terms: they tell parameters and formulas apart, in any process."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
import ufl
from ufl import inner

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    Problem,
    Stage,
    Structure,
    Support,
)
from fx_membrane.model.digests import fingerprint, fingerprints
from models import EDGE, POINTS, TRIANGLES
from own_terms import ElasticBed, Water, bed, term

STRUCTURE = Structure(
    POINTS, {"fabric": Membrane(TRIANGLES, Fabric(1e5, 0.3), 1e3), "edge": Cable([[0, 1]], 1e6)}, [Support(EDGE)]
)


def digests(own):
    return fingerprints(Stage("a", [own]))["loads"], fingerprints(replace(STRUCTURE, terms=[own]))["terms"]


def test_parameters_and_formula_are_in_the_digest():
    assert digests(term(bed)) == digests(term(lambda self, state, parameters: parameters.k * state.u[2] ** 2 / 2))
    others = [
        replace(term(bed), k=2.5),
        term(lambda self, state, parameters: parameters.k * state.u[1] ** 2 / 2),
        term(lambda self, state, parameters: parameters.k * state.u[2] ** 2),
        term(lambda self, state, parameters: self.k * state.u[2] ** 2 / 2),
        term(virtual_work=lambda self, state, v, parameters: parameters.k * state.u[2] * v[2]),
    ]
    found = {digests(own) for own in [term(bed), *others]}
    assert len(found) == len(others) + 1


def test_term_without_parameters_has_a_digest():
    own, other = (term(lambda self, state, parameters, k=k: k * state.u[2], fields=()) for k in (50.0, 60.0))
    assert digests(own) != digests(other)


@pytest.mark.mpi
def test_term_without_parameters_is_taken_on_several_processes():
    """They compare what they are given by its digest."""
    own = term(lambda self, state, parameters: 50.0 * state.u[2], fields=())
    problem = Problem(replace(STRUCTURE, terms=[own]))
    forces = problem.to_numpy(problem.under().residual(problem.create_vector()))
    assert abs(forces[:, 2].sum() - 50.0 * 4.0) < 1e-9


def test_digest_tells_parameters_apart():
    def use(name):
        return lambda self, state, parameters: getattr(parameters, name) * inner(state.u, state.u)

    first, second = (term(use(name), fields=("a", "b")) for name in "ab")
    assert fingerprint(first) != fingerprint(second)


SCRIPT = """
import sys
sys.path.insert(0, {tests!r})
from fx_membrane.model.digests import fingerprint
from own_terms import ElasticBed, Water
print(fingerprint([ElasticBed("fabric", [1.0, 2.0], [0, 1]), Water("fabric", 2.0, 3.0)]))
"""


def test_digest_is_the_same_in_another_process():
    """Symbols are numbered by a global count of UFL: other symbols made before do not matter."""
    ufl.variable(ufl.as_ufl(1.0))
    fingerprint([Water("fabric", 1.0, 1.0)])
    here = fingerprint([ElasticBed("fabric", [1.0, 2.0], [0, 1]), Water("fabric", 2.0, 3.0)])
    script = SCRIPT.format(tests=str(Path(__file__).parents[2]))
    there = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert there == f"{here}\n"
