"""Energy terms as a user writes them: an elastic bed, ground, water above a membrane."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from ufl import conditional, dot, gt, inner, lt

from fx_membrane import Problem, Stage


@dataclass(frozen=True)
class ElasticBed:
    """Winkler's bed under a part: k u_z^2 / 2 per reference area or length."""

    part: str
    k: Any  # [N/m3], of cables [N/m2]
    cells: Any = None

    def energy(self, state, parameters):
        return parameters.k * state.u[2] ** 2 / 2


@dataclass(frozen=True)
class Ground:
    """Contact with the half-space below a plane, by a penalty."""

    part: str
    k: float
    level: float
    normal: Any = (0.0, 0.0, 1.0)
    quadrature_degree: int = 10  # the energy has a kink where the contact ends

    def energy(self, state, parameters):
        depth = parameters.level - dot(parameters.normal, state.x)
        return parameters.k * conditional(gt(depth, 0), depth**2, 0) / 2


@dataclass(frozen=True)
class Water:
    """Water above a membrane whose normals point up: the pressure of the depth, by the divergence theorem.

    The rim must be held, or above the water.
    """

    part: str
    weight: float  # [N/m3]
    level: float  # [m]

    def energy(self, state, parameters):
        depth = parameters.level - state.x[2]
        return -parameters.weight * conditional(gt(depth, 0), depth**2, 0) / 2 * state.n[2]


@dataclass(frozen=True)
class WaterWork:
    """The same by its virtual work, on any rim."""

    part: str
    weight: float
    level: float

    def virtual_work(self, state, v, parameters):
        depth = parameters.level - state.x[2]
        return -parameters.weight * conditional(gt(depth, 0), depth, 0) * dot(state.n, v)


@dataclass(frozen=True)
class Follower:
    """A force per length that turns with a bar, without a potential; and friction of a kind, linear in x."""

    part: str
    q: Any

    def virtual_work(self, state, v, parameters):
        along = state.F[:, 0]
        return parameters.q[0] * (along[0] * v[1] - along[1] * v[0]) + parameters.q[2] * state.x[0] * v[2]


@dataclass(frozen=True)
class Everything:
    """All symbols and all kinds of parameters of a membrane."""

    part: str
    k: Any
    direction: Any
    force: Any
    stiff: Any
    cells: Any = None
    quadrature_degree: ClassVar[int] = 3

    def energy(self, state, parameters):
        depth = dot(parameters.direction, state.x)
        stretch = inner(state.F, state.F)
        return (
            parameters.k * conditional(lt(depth, 0.05), (depth - 0.05) ** 2, 0)
            - dot(parameters.force, state.u)
            + parameters.stiff * stretch**2 * (1 + state.X[0] ** 2)
            + parameters.k * dot(state.n, state.x) ** 2
        )


def term(method=None, fields=("k",), frozen=True, **members):
    """Instance of a class with a part and other fields, all of the value 2."""
    annotations = {"part": str} | dict.fromkeys(fields, Any)
    members = {name: value for name, value in {"energy": method, **members}.items() if value is not None}
    kind = dataclass(frozen=frozen)(type("Mine", (), {"__annotations__": annotations, **members}))
    return kind("fabric", *[2.0] * len(fields))


def bed(self, state, parameters):
    return parameters.k * state.u[2] ** 2 / 2


def under(structure, *loads):
    """Problem of a structure under loads, among them energy terms."""
    problem = Problem(structure)
    return problem.under(problem.actions_of(Stage("loads", loads)))


def random(problem, seed, size=0.1):
    """Random displacement of a size."""
    shape = problem.structure.points.shape
    return problem.discretization.to_petsc(size * np.random.default_rng(seed).normal(size=shape))
