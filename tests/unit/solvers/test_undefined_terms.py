"""Energy terms that are not a number at the start are named by every solver and by a path."""

from dataclasses import dataclass, replace

import pytest
import ufl

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    ConvergenceError,
    Newton,
    Outcome,
    PathError,
    Stage,
    equilibrium_path,
)
from models import SNOW, sheet
from own_terms import ElasticBed


@dataclass(frozen=True)
class Logarithm:
    part: str
    k: float

    def energy(self, state, parameters):
        return parameters.k * ufl.ln(state.u[2])


@dataclass(frozen=True)
class Root:
    part: str
    k: float

    def virtual_work(self, state, v, parameters):
        return parameters.k * ufl.sqrt(state.u[2] - 1) * v[2]


@dataclass(frozen=True)
class Offset:
    """Energy alone is not a number: a constant has no force."""

    part: str
    k: float

    def energy(self, state, parameters):
        return parameters.k * state.u[2] ** 2 + ufl.ln(parameters.k - 2)


TERMS = {
    "Logarithm": (Logarithm("fabric", 1.0), r"its force on node \d+ along z is -inf"),
    "Root": (Root("fabric", 1.0), r"its force on node \d+ along z is -?nan"),
    "Offset": (Offset("fabric", 1.0), "its energy is -?nan"),
}


def cases(term):
    """Structure and stage with the term of a stage, and with the same of the structure."""
    fine = ElasticBed("fabric", 10.0)
    yield sheet(), Stage("load", [SNOW, fine, term], increments=2, after="rest")
    yield replace(sheet(), terms=[fine, term]), Stage("load", [SNOW], increments=2, after="rest")


@pytest.mark.mpi_once
@pytest.mark.parametrize("solver", [Newton(), Newton(line_search=False), ConjugateGradient()])
@pytest.mark.parametrize("name", TERMS)
def test_term_is_named(name, solver):
    term, words = TERMS[name]
    for structure, stage in cases(term):
        stages = [Stage("rest"), stage]
        with pytest.raises(ConvergenceError, match=rf"{name} on 'fabric' is not finite at the start: {words}") as error:
            Analysis(structure, solver).run(stages)
        assert error.value.failed.outcome is Outcome.UNDEFINED
        assert error.value.failed.load_factor in (0.5, 1.0)  # it is not halved
        assert list(error.value.results) == ([] if structure.terms else ["rest"])


@pytest.mark.mpi_once
@pytest.mark.parametrize("name", TERMS)
def test_term_is_named_by_a_path(name):
    term, words = TERMS[name]
    for structure, stage in cases(term):
        with pytest.raises(PathError, match=rf"no start: .*{name} on 'fabric' is not finite.*{words}") as error:
            equilibrium_path(structure, replace(stage, after=None))
        assert error.value.path.points == ()


@pytest.mark.mpi
def test_term_that_a_step_leaves_is_no_fault_of_the_start():
    """Defined at the start, and beyond a point no more: the line search steps back."""

    @dataclass(frozen=True)
    class Barrier:
        part: str
        k: float

        def energy(self, state, parameters):
            return -parameters.k * ufl.ln(0.02 + state.u[2])

    state = Analysis(sheet()).run([Stage("load", [SNOW, Barrier("fabric", 5.0)])])["load"]
    assert state.displacement[:, 2].min() > -0.02
