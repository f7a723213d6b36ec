"""Script of a user with types: lists wherever lists work. Run and checked by `tests/test_types.py`."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from ufl import inner

from fx_membrane import (
    Analysis,
    Cable,
    CableForce,
    DistributedLoad,
    Fabric,
    Iteration,
    LengthChange,
    LoadedProblem,
    Mast,
    Membrane,
    Newton,
    Outcome,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    PrestressFactor,
    Problem,
    RoundHole,
    Slide,
    Solution,
    Solve,
    Stage,
    Structure,
    Support,
    boundary_edges,
    edges_where,
    force_density,
    polyline,
    projected_stress,
    sail_mesh,
)


@dataclass(frozen=True)
class Foil:
    k: float

    def energy(self, E: Any, sigma0: Any, parameters: Any) -> Any:
        return inner(sigma0, E) + parameters.k * inner(E, E) / 2

    @property
    def stiffness(self) -> float:
        return self.k


@dataclass(frozen=True)
class Bed:
    part: str
    k: float

    def energy(self, state: Any, parameters: Any) -> Any:
        return parameters.k * state.u[2] ** 2 / 2


class Resting:
    """Solver that takes every state for an equilibrium."""

    def prepare(self, problem: Problem) -> Solve:
        def solve(loaded: LoadedProblem, x: Any, monitor: Any, thorough: bool) -> Solution:
            loaded.constraints.impose(x)
            return Solution(Outcome.CONVERGED, "", [Iteration(0.0, 0.0, 0.0)])

        return solve


points = [[0.0, 0, 0.5], [2.0, 0, 0], [2, 2, 0.5], [0.0, 2, 0], [1, 1, 0.25]]
triangles = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
rim = [[0, 1], [1, 2], [2, 3], [3, 0]]
roof = Membrane(triangles, Fabric(4e5, 0.3), prestress=[2e3, 1e3], warp=[1, 0, 0])
foil = Membrane(triangles, Foil(4e5), prestress=[[1e3, 0], [0, 1e3]], warp=(1, 0, 0))
edge = Cable(rim, 1e7, prestress=[2e4, 2e4, 2e4, 2e4])
mast = Mast([[0, 1]], 1e7)
Mast.from_modulus([[0, 1]], 2e11, 1e-3)
structure = Structure(points, {"roof": roof, "edge": edge}, [Support([0, 1, 2, 3])], terms=[Bed("roof", 10.0)])
parts = {"roof": roof, "edge": edge}
loads = [Pressure(10.0, "roof"), PointLoad(4, [0, 0, -1])]
changes = [LengthChange(-0.01, "edge"), PrestressFactor(1.1, "roof")]
Structure(points, parts, [Support([0, 1, 2, 3])])
Stage("all", loads, changes=changes)
again = replace(structure, points=np.array(points), parts={"roof": replace(roof, prestress=1e3), "edge": edge})
stages = [
    Stage("rest", [Pressure(10.0, "roof", cells=[0, 1])]),
    Stage("snow", [PlanLoad([0, 0, -50], "roof"), PointLoad([4], [0, 0, -1]), Bed("roof", 1.0)], after="rest"),
    Stage("move", displacements=[PrescribedDisplacement([4], [0, 0, 0.01], "z")]),
    Stage("line", [DistributedLoad((0, 0, -5.0), "edge", cells=[0])]),
]
results = Analysis(structure, Newton(), progress=False).run(stages[:2])
lowest: float = results["snow"].position[:, 2].min() + structure.points[:, 2].min()
first: int = int(roof.cells[0, 0]) + int(stages[0].loads[0] == stages[1].loads[0])
down = np.asarray(PointLoad(4, [0, 0, -1]).force).tolist()

boundary_edges(triangles)
edges_where(points, triangles, lambda x: x[0] < 0.1)
polyline([0, 1, 2])
net = force_density(points, rim, [1e3, 1e3, 1e3, 1e3], [Support([0, 1, 2])])
Analysis(structure, Resting())
hole = RoundHole([3, 3, 1], 0.5)
corners = {"a": [0, 0, 0], "b": [6, 0, 0], "c": [6, 6, 2], "d": [0, 6, 0]}
mesh = sail_mesh(corners, 2.0)
found = projected_stress(replace(structure, terms=()), constraints=[CableForce("edge", 2e4)])
Slide([4], [0, 0, 1])
