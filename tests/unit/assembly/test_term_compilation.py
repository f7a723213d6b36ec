"""Forms of energy terms are compiled once for a kind of part: not by another stage, number or process."""

from collections.abc import Callable

import pytest

COMPILED = """
from dataclasses import dataclass
from fx_membrane import *

@dataclass(frozen=True)
class Bed:
    part: str
    k: object
    cells: object = None

    def energy(self, state, parameters):
        return parameters.k * state.u[2] ** 2 / 2

@dataclass(frozen=True)
class Other(Bed):
    '''Another class with the same formula.'''

    energy = Bed.energy

@dataclass(frozen=True)
class Push:
    part: str
    p: float

    def virtual_work(self, state, v, parameters):
        return parameters.p * sum(state.n[i] * v[i] for i in range(3))

def analyse(n):
    points, triangles = rectangle(1.0, 1.0, n, n)
    edges, half = boundary_edges(triangles), len(triangles) // 2
    parts = {
        f"one {n}": Membrane(triangles[:half], Fabric(Et=1e5 * n, nu=0.3), prestress=1e3 * n),
        f"two {n}": Membrane(triangles[half:], Fabric(Et=1e5 * n, nu=0.3), prestress=1e3 * n),
        f"cable {n}": Cable(edges, 1e6 * n, 1e3),
    }
    supports = [Support(edges[edges[:, 0] > 0, 0])]
    standing = [Bed(f"one {n}", 10.0 * n), Bed(f"cable {n}", 3.0 * n)]
    analysis = Analysis(Structure(points, parts, supports, terms=standing))
    count()
    stages = [
        Stage("first", [Push(f"one {n}", 2.0 * n)], increments=2),
        Stage("again", [Push(f"two {n}", 3.0), Bed(f"two {n}", 4.0, [0])], after="first", increments=2),
        Stage("other", [Other(f"one {n}", 5.0 + n, range(n)), Push(f"one {n}", 7.0)], after="again"),
    ]
    for number in range(3):
        analysis.run(stages[:number + 1])
        count()

for n in (2, 3):
    analyse(n)
"""


def test_forms_of_terms_are_compiled_once(compiled_code: Callable[[str], list[int]]) -> None:
    counts = compiled_code(COMPILED)  # nor by another process
    assert counts[0] < counts[1]  # when a solver first asks for them
    assert counts[1:] == [counts[1]] * 7  # not by a stage, a second part or structure, other numbers, cells or a class


SHARED = """
from dataclasses import dataclass
from fx_membrane import *
from fx_membrane.assembly.problem import Problem

@dataclass(frozen=True)
class Bed:
    part: str
    a: float
    b: float
    own: float = 1.0

    def energy(self, state, parameters):
        return self.own * parameters.a * state.u[2] ** 2 / 2 + parameters.b * state.u[0] ** 2

@dataclass(frozen=True)
class Exchanged(Bed):
    def energy(self, state, parameters):
        return self.own * parameters.b * state.u[2] ** 2 / 2 + parameters.a * state.u[0] ** 2

points, triangles = rectangle(1.0, 1.0, 2, 2)
structure = Structure(points, {"a": Membrane(triangles, Fabric(1e5, 0.3), 1e3)}, [Support(0)])
problem = Problem(structure)
stage = Stage("a", [Bed("a", 1.0, 2.0), Bed("a", 5.0, 6.0), Exchanged("a", 1.0, 2.0), Bed("a", 1.0, 2.0, 3.0)])
terms = problem.under(problem.actions_of(stage)).terms
first, same, exchanged, other = (terms.pool.forms(acting) for acting in terms.all)
print(first is same, first is exchanged, first is other)
"""


def test_equal_formulas_share_their_forms_and_others_do_not(capsys: pytest.CaptureFixture[str]) -> None:
    """A number from `self` is another formula; so are exchanged parameters."""
    exec(SHARED, {"__name__": "script"})
    assert capsys.readouterr().out.split() == ["True", "False", "False"]
