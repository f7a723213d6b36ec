"""Laws of a user's own through the package: any number of processes, compiled once, in a process of their own."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import ufl
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Law,
    Mast,
    Membrane,
    MooneyRivlin,
    NeoHooke,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    report,
)
from fx_membrane.assembly.problem import Problem
from models import FABRIC, POINTS, SNOW, TRIANGLES, inclined_sheet, same_state
from own_laws import Stiffening


@dataclass(frozen=True)
class Same(Fabric):
    """The energy of a fabric, without its formula for the relaxed one."""

    energy = Fabric.energy


@dataclass(frozen=True)
class Stiff(Same):
    """Carries compression, by its own word."""

    energy = Fabric.energy
    relaxed_energy = None  # type: ignore[assignment]


def mixed(foil, rope):
    """Foil with an edge cable, a mast under the middle, and points of no symmetry."""
    points, triangles = rectangle(2.0, 1.0, 6, 4)
    points[:, 2] = 0.1 * points[:, 0] * points[:, 1]
    foot = len(points)
    edges = boundary_edges(triangles)
    parts = {
        "foil": Membrane(triangles, foil, prestress=[[40.0, 5.0], [5.0, 25.0]], warp=(1, 0, 0)),
        "rope": Cable(edges, prestress=60.0, material=rope),
        "mast": Mast([[foot, len(points) // 2]], prestress=-5.0, material=rope),
    }
    corners = [0, 6, foot - 7, foot - 1]
    return Structure(np.vstack([points, [[0, 0, -1.0]]]), parts, [Support([*corners, foot])])


LOADS = [
    Stage("rest"),
    Stage("snow", [DistributedLoad((3.0, 0, -40.0), "foil", range(30))], after="rest"),
    Stage("pull", [PointLoad(10, (60.0, 10, -30))], after="rest"),
]


@pytest.mark.mpi
@pytest.mark.parametrize("foil", [NeoHooke(400.0), MooneyRivlin(150.0, 40.0)], ids=["neo-Hooke", "Mooney-Rivlin"])
def test_same_on_any_number_of_processes(foil):
    structure = mixed(foil, Stiffening(5e3, 2e5))
    states, alone = Analysis(structure).run(LOADS), Analysis(structure, comm=MPI.COMM_SELF).run(LOADS)
    for name, state in states.items():
        assert same_state(state, alone[name])
        np.testing.assert_array_equal(state.membrane("foil").state, alone[name].membrane("foil").state)
        assert state.equilibrium.residual < 1e-7
        assert "reference shape" in report(state)
    assert {"taut", "wrinkled"} <= set(states["snow"].membrane("foil").state) | set(
        states["pull"].membrane("foil").state
    )


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="compares processes")
def test_another_energy_on_another_process_is_refused():
    rank = MPI.COMM_WORLD.rank

    @dataclass(frozen=True)
    class Mine(Stiffening):
        def energy(self, E, sigma0, parameters):
            return Stiffening.energy(self, E, sigma0, parameters) + (1e-3 * parameters.k * E[0, 0] ** 4 if rank else 0)

    with pytest.raises(ValueError, match=r"differs.*process 0.*energy.*part 'rope'"):
        Analysis(mixed(NeoHooke(400.0), Mine(5e3, 2e5)))


@pytest.mark.mpi
def test_fabric_by_its_energy_alone():
    """Equal to the formulas: a whole analysis with wrinkles and slack cells."""
    structure = inclined_sheet()
    fabric = structure.parts["fabric"]
    loads = [Stage("snow", [SNOW]), Stage("crush", displacements=[PrescribedDisplacement(12, (0.3, 0, 0.05))])]
    loads = [Stage("rest"), *(replace(stage, after="rest") for stage in loads)]
    other = replace(structure, parts={"fabric": replace(fabric, material=Same(FABRIC.Et, FABRIC.nu))})
    expected, found = Analysis(structure).run(loads), Analysis(other).run(loads)
    assert "wrinkled" in expected["crush"].membrane("fabric").state
    for name in expected:
        assert same_state(found[name], expected[name])
        assert found[name].energy == pytest.approx(expected[name].energy, rel=1e-9)


def test_law_without_relaxed_energy_carries_compression():
    """As with compression_stiffness=1: every cell is called taut."""
    points = np.array(POINTS)
    squeeze = PrescribedDisplacement(range(len(points)), points * [-0.05, 0.02, 0])
    states = []
    for law, share in ((Stiff(1e5, 0.3), 1e-4), (FABRIC, 1.0)):
        part = Membrane(TRIANGLES, law, compression_stiffness=share)
        states.append(Analysis(Structure(points, {"a": part})).run([Stage("s", displacements=[squeeze])])["s"])
    stiff, full = (state.membrane("a") for state in states)
    assert set(stiff.state) == {"taut"}
    np.testing.assert_allclose(stiff.cauchy, full.cauchy, rtol=0, atol=1e-9)
    assert stiff.principal[:, 1].max() < -100


def test_shear_of_an_energy_in_one_place():
    """The stress is symmetric though the energy names E12 alone."""

    @dataclass(frozen=True)
    class OneSided(Law):
        D: float

        def energy(self, E, sigma0, parameters):
            strain = E[0, 0] ** 2 + E[1, 1] ** 2 + 2 * E[0, 1] ** 2
            return ufl.inner(sigma0, E) + parameters.D * strain / 2

        @property
        def stiffness(self):
            return self.D

    shear = PrescribedDisplacement(range(len(POINTS)), POINTS[:, [1, 0, 2]] * [0.02, 0.03, 0])
    part = Membrane(TRIANGLES, OneSided(100.0), 20.0)
    stage = Stage("shear", displacements=[shear])
    foil = Analysis(Structure(POINTS, {"a": part})).run([stage])["shear"].membrane("a")
    expected = 20.0 * np.eye(2) + 100.0 * foil.strain
    np.testing.assert_allclose(foil.second_piola_kirchhoff, expected, rtol=0, atol=1e-12 * 100)


PARAMETERS = [("foil", "C10t"), ("foil", "C01t"), ("rope", "k"), ("mast", "EA"), ("foil", "prestress")]


@pytest.mark.mpi_once
@pytest.mark.parametrize(("part", "parameter"), PARAMETERS)
def test_derivative_by_a_parameter(part, parameter):
    """Differences of the residual, wrinkles and slack cells included: second order in the step."""
    structure = mixed(MooneyRivlin(150.0, 40.0), Stiffening(5e3, 2e5))
    rng = np.random.default_rng(3)
    u = 0.05 * rng.normal(size=structure.points.shape)

    def changed(h):
        owner = structure.parts[part]
        if parameter == "prestress":
            other = replace(owner, prestress=owner.prestress_tensors() * (1 + h))
        else:
            law = replace(owner.material, **{parameter: getattr(owner.material, parameter) * (1 + h)})
            other = replace(owner, material=law, **({} if part == "foil" else {"axial_stiffness": None}))
        problem = Problem(replace(structure, parts={**structure.parts, part: other}))
        return problem.to_numpy(problem.under().residual(problem.to_petsc(u)))

    problem = Problem(structure)
    owner = structure.parts[part]
    direction = owner.prestress_tensors() if parameter == "prestress" else getattr(owner.material, parameter)
    found = problem.to_numpy(problem.under().derivative(problem.to_petsc(u), part, parameter, direction))
    h = 1e-5
    expected = (changed(h) - changed(-h)) / (2 * h)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


SCRIPT = """
from dataclasses import dataclass
import ufl
from fx_membrane import *

@dataclass(frozen=True)
class Foil:
    D: float

    def energy(self, E, sigma0, parameters):
        return ufl.inner(sigma0, E) + parameters.D * (ufl.inner(E, E) + ufl.tr(E) ** 2) / 2

    @property
    def stiffness(self):
        return self.D

@dataclass(frozen=True)
class Rope:
    EA: float
    k: float

    def energy(self, E, sigma0, parameters):
        e = E[0, 0]
        return sigma0[0, 0] * e + parameters.EA * e**2 / 2 + parameters.k * e**4 / 4

    @property
    def stiffness(self):
        return self.EA

points, triangles = rectangle(1.0, 1.0, 4, 4)
edges = boundary_edges(triangles)
for n in (1, 2, 3):
    foil = Membrane(triangles, Foil(100.0 * n), 3.0 * n)
    parts = {"foil": foil, "rope": Cable(edges, material=Rope(50.0 * n, 2.0))}
    structure = Structure(points, parts, [Support([0, 4, 20, 24])])
    load = Stage("load", [DistributedLoad((0, 0, -n), "foil")])
    state = Analysis(structure, progress=False).run([load])["load"]
    assert state.equilibrium.residual < 1e-6, state.equilibrium
    count()
"""


def test_compiled_once_in_a_script(compiled_code):
    """The same forms for any numbers, and none more in a second process."""
    counts = compiled_code(SCRIPT)
    assert len(set(counts)) == 1
    assert counts[0] > 0
