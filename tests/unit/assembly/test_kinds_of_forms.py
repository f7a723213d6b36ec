"""Compiled code is found by the kind of a part where its formula is known: the code that FFCx finds by reading."""

from collections import OrderedDict

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, PointLoad, Rope, Stage, Structure, Support
from fx_membrane.assembly.discretization import Discretization
from fx_membrane.assembly.forms_of_parts import part_forms
from fx_membrane.assembly.kinds_of_forms import NO_KIND
from fx_membrane.assembly.matrix_forms import mass_form, tension_form
from fx_membrane.assembly.problem import Problem
from fx_membrane.results.evaluation import _expression
from fx_membrane.runtime import jit_cache
from kinds_of_structures import KINDS, run, structure


@pytest.fixture
def nothing_kept(monkeypatch):
    """Forget the code of this process, when called."""
    return lambda: monkeypatch.setattr(jit_cache, "_loaded", OrderedDict())


SHIPPED = [kind for kind in KINDS if kind not in ("own law", "terms")]


@pytest.mark.parametrize("kind", SHIPPED)
@pytest.mark.parametrize(("elastic", "natural"), [(True, False), (True, True), (False, False)])
def test_forms_of_a_kind_have_the_formula_that_ffcx_reads(kind, elastic, natural, searches, nothing_kept):
    """FFCx names code by a signature of the whole formula: it is the same for other numbers and meshes."""
    kinds, names = [], []
    for n in (2, 3):
        made = structure(n, **KINDS[kind])
        meshes = Discretization(made).parts
        nothing_kept()
        searches.clear()
        parts = {name: part_forms(mesh, made, elastic, natural) for name, mesh in meshes.items()}
        for part in parts.values():
            part.compiled("results", _expression), tension_form(part), mass_form(part)
        kinds.append({name: part.kind for name, part in parts.items()})
        names.append(list(dict.fromkeys(searches)))  # code that is compiled now is looked for twice
    assert kinds[0] == kinds[1]
    assert all(kinds[0].values())
    assert names[0] == names[1] != []


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.filterwarnings("ignore::fx_membrane.UnstableStateWarning")
def test_code_of_a_kind_gives_the_results_of_code_that_was_read(kind, nothing_kept):
    run(2, **KINDS[kind])
    kept = run(3, **KINDS[kind])
    nothing_kept()
    read = run(3, **KINDS[kind])
    for name, state in read.items():
        assert np.array_equal(kept[name].displacement, state.displacement)
        for part, found in state.parts.items():
            assert np.array_equal(kept[name].parts[part].principal, found.principal)


def test_own_laws_have_no_kind():
    kinds = {name: part.kind for name, part in Problem(structure(2, **KINDS["own law"])).parts.items()}
    assert kinds.pop("sheet") == NO_KIND
    assert len(set(kinds.values())) == 2  # a cable goes slack, and a mast does not


def test_code_of_ropes_gives_the_results_of_code_that_was_read(nothing_kept):
    def tension(weight):
        points = [(0, 0, 0), (4, 0, -3), (10, 0, 2)]
        parts = {"rope": Rope([0, 1, 2], 1e6, unstressed_length=12.0), "stay": Cable([[1, 3]], 1e3, 10.0)}
        held = Structure([*points, (4, 1, -3)], parts, [Support([0, 2, 3])])
        state = Analysis(held).run([Stage("weight", [PointLoad(1, (0, 0, -weight))])])["weight"]
        return state.rope("rope").tension, *state.displacement.ravel()

    tension(1e4)
    kept = tension(2e4)
    nothing_kept()
    assert tension(2e4) == kept
