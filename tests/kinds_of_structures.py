"""Structures of each kind of law and term, with other numbers and meshes for each n."""

from dataclasses import dataclass

import numpy as np
import ufl

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Mast,
    Membrane,
    MooneyRivlin,
    NeoHooke,
    OrthotropicFabric,
    PlanLoad,
    Pressure,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)


@dataclass(frozen=True)
class Linear:
    """Law with a variable of its own, and products of a scalar and a tensor, for which UFL numbers indices."""

    k: float

    def energy(self, E, sigma0, parameters):
        e = ufl.variable(E)
        S = ufl.diff(parameters.k * ufl.inner(e, e) / 2, e)
        return ufl.inner(sigma0, E) + ufl.inner(0.5 * (S + S.T), E) / 2

    @property
    def stiffness(self):
        return self.k


@dataclass(frozen=True)
class Bed:
    part: str
    k: float

    def energy(self, state, parameters):
        return parameters.k * ufl.inner(state.u, 2.0 * state.u) / 4


@dataclass(frozen=True)
class Wind:
    part: str
    p: float

    def virtual_work(self, state, v, parameters):
        return parameters.p * ufl.dot(0.5 * state.n, v)


def structure(n, law=None, terms=(), compression=1e-6):
    points, triangles = rectangle(1.0 + n, 1.0, n, n)
    points[:, 2] = 0.1 * points[:, 0] * points[:, 1]
    edges, top = boundary_edges(triangles), len(points)
    law = Fabric(1e5 * n, 0.3) if law is None else law(n)
    parts = {
        "sheet": Membrane(triangles, law, prestress=1e3 * n, warp=(1, 0.1 * n, 0), compression_stiffness=compression),
        "edge": Cable(edges, 1e6 * n, 1e3),
        "mast": Mast([[top, 0]], 1e7),
    }
    held = Support([top, *np.unique(edges)[1:]])
    return Structure(np.vstack([points, [-0.5, -0.5, -1.0]]), parts, [held], terms=[make(n) for make in terms])


def run(n, *args, **kwargs):
    stages = [
        Stage("snow", [PlanLoad((0, 0, -100.0 * n), "sheet")]),
        Stage("wind", [Pressure(50.0 * n, "sheet")], after="snow"),
    ]
    return Analysis(structure(n, *args, **kwargs)).run(stages)


KINDS = {
    "isotropic": {},
    "part of the compression stiffness": {"compression": 0.1},
    "all of the compression stiffness": {"compression": 1.0},
    "woven": {"law": lambda n: OrthotropicFabric(1e5 * n, 8e4, 0.2, 2e4)},
    "rubber": {"law": lambda n: NeoHooke(1e5 * n)},
    "foil": {"law": lambda n: MooneyRivlin(1e5 * n, 1e4)},
    "own law": {"law": lambda n: Linear(1e5 * n)},
    "terms": {"terms": [lambda n: Bed("sheet", 1e3 * n), lambda n: Bed("edge", 1e2 * n), lambda n: Wind("sheet", n)]},
}
