"""Modes and stiffnesses of states: constraints, massless parts, the user's order, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    PrescribedDisplacement,
    Stage,
    Structure,
    Support,
    natural_frequencies,
    rectangle,
    stability,
)

L, T, EA, MASS = 1.5, 400.0, 9e3, 0.8


def rest(structure):
    return Analysis(structure).run([Stage("rest")])["rest"]


def guyed(mass=0.0, prestress=T):
    """Cable from node 0 to node 1, held on the other side by a guy in two pieces, massless by default."""
    points = [[0.0, 0, 0], [L, 0, 0], [2 * L, 0, 0], [3 * L, 0, 0]]
    parts = {"cable": Cable([[0, 1]], EA, T, mass=MASS), "guy": Mast([[1, 2], [2, 3]], EA, prestress, mass=mass)}
    return Structure(points, parts, [Support([0, 3])])


@pytest.mark.mpi
def test_parts_without_mass_follow():
    modes = natural_frequencies(rest(guyed()), 3)
    across, along = 1.5 * T / L, 1.5 * (EA + T) / L
    expected = np.sqrt(np.array([across, across, along]) / (MASS * L / 3)) / (2 * np.pi)
    np.testing.assert_allclose(modes.frequencies, expected, rtol=1e-12)
    np.testing.assert_allclose(modes.shapes[:, 2], modes.shapes[:, 1] / 2, rtol=0, atol=1e-12)  # half way along the guy
    assert np.linalg.norm(modes.shapes[:, 1], axis=1) == pytest.approx((MASS * L / 3) ** -0.5, rel=1e-12)


def test_results_are_shown_in_short():
    modes, stiffness = natural_frequencies(rest(guyed()), 3), stability(rest(guyed()), 2)
    first, second, third = (f"{frequency:.4g}" for frequency in modes.frequencies)
    assert repr(modes) == f"Modes({first}, {second}, {third} Hz, 0 that grow)"
    many = replace(modes, frequencies=np.arange(9.0), growth=np.arange(9) < 2)
    assert repr(many) == "Modes(0, 1, 2, 3, 4, 5, ... Hz, 2 that grow)"
    assert repr(stiffness) == f"Stability(lowest stiffness {stiffness.stiffnesses[0]:.4g}, 0 negative)"


@pytest.mark.mpi_once
@pytest.mark.parametrize("count", [4, 10])
@pytest.mark.parametrize("stiffness", [1.0, 1e6, 1e12])
def test_no_stiffness_is_no_instability(stiffness, count):
    """A string without tension has no stiffness across: a zero frequency, up to rounding."""
    nodes = np.arange(count + 1)
    line = np.linspace([0.0, 0.1, 0.3], [2.0, 0.7, 1.2], count + 1)
    string = Cable(np.column_stack([nodes[:-1], nodes[1:]]), stiffness, mass=1.0)
    state = rest(Structure(line, {"string": string}, [Support([0, count])]))
    across = 2 * (count - 1)
    modes = natural_frequencies(state, across + 1)
    assert not modes.growth.any()
    assert not modes.frequencies[:across].any()
    along = 0.5 / np.linalg.norm(line[-1] - line[0]) * stiffness**0.5
    assert modes.frequencies[across] == pytest.approx(along, rel=0.03)
    found = stability(state, across)
    assert not found.stiffnesses.any()
    assert (found.negative, found.free, found.stable) == (0, across, False)


@pytest.mark.parametrize("prestress", [1e-6, -1e-6])
def test_little_stiffness_is_not_taken_for_none(prestress):
    """Across it is a string of four linear elements with a consistent mass matrix.

    With c = cos(k pi / 4) their frequencies are omega^2 = 6 N (1 - c) / (m h^2 (2 + c)), each twice.
    """
    nodes = np.arange(5)
    bars = Mast(np.column_stack([nodes[:-1], nodes[1:]]), 1e6, prestress=prestress, mass=1.0)
    modes = natural_frequencies(rest(Structure(np.outer(nodes, [0.5, 0, 0]), {"bars": bars}, [Support([0, 4])])), 6)
    c = np.repeat(np.cos(np.pi / 4 * np.arange(1, 4)), 2)
    exact = np.sqrt(6 * abs(prestress) * (1 - c) / (0.5**2 * (2 + c)))
    frequencies, growth = (exact / (2 * np.pi), 0 * c) if prestress > 0 else (0 * c, exact)
    np.testing.assert_allclose(np.sort(modes.frequencies), frequencies, rtol=1e-6)
    np.testing.assert_allclose(np.sort(modes.growth), growth, rtol=1e-6)


def wrinkled():
    """Clamped sheet whose far end is moved in by 5 %: wrinkled and slack, and held at its ends."""
    points, triangles = rectangle(2.0, 1.0, 8, 4)
    low, high = (np.flatnonzero(np.abs(points[:, 0] - x) < 1e-9) for x in (-1.0, 1.0))
    structure = Structure(points, {"fabric": Membrane(triangles, Fabric(5e5, 0.3), 10.0)}, [Support(low)])
    moved = PrescribedDisplacement(high, (-0.05, 0.3, 0))
    return Analysis(structure).run([Stage("pull", displacements=[moved])])["pull"]


@pytest.mark.mpi
def test_wrinkles_are_no_instability_and_slack_nodes_are_left_out():
    state = wrinkled()
    assert (state.membrane("fabric").state == "slack").any()
    found = stability(state, 3)
    assert found.negative == found.free == 0
    assert found.stable
    assert (found.stiffnesses > 0).all()


@pytest.mark.mpi_once
@pytest.mark.filterwarnings("ignore:Stage 'rest'")
@pytest.mark.parametrize("kept", [1e-6, 1e-3])
def test_what_slack_cables_keep_holds_no_mast(kept):
    """A mast within guys that are too long: their compression stiffness pushes it up a little, nothing holds it."""
    feet = [[3.0, 0, 0], [-2, 2, 0], [-2, -2, 0]]
    guys = Cable([[1, 2], [1, 3], [1, 4]], 12e6, prestress=-1e4, compression_stiffness=kept)
    parts = {"mast": Mast([[0, 1]], 200e6), "guys": guys}
    state = rest(Structure([[0.0, 0, 0], [0, 0, 4], *feet], parts, [Support([0, 2, 3, 4])]))
    found = stability(state)
    assert not found.stable
    assert "mast 'mast' (cell 0, at node 1), held by slack parts alone ('guys')" in found.held_by_slack
    assert found.held_by_slack in repr(found)


def test_more_modes_than_there_are():
    state = rest(guyed())
    with pytest.raises(ValueError, match=r"count is 4.*3 components.*mass.*move"):
        natural_frequencies(state, 4)
    with pytest.raises(ValueError, match="stability count is 7, but 6 components can move"):
        stability(state, 7)
    with pytest.raises(ValueError, match=r"count is 0.*whole number"):
        natural_frequencies(state, 0)


@pytest.mark.mpi
def test_without_mass():
    structure = guyed()
    massless = replace(structure, parts={"cable": Cable([[0, 1]], EA, T), "guy": structure.parts["guy"]})
    with pytest.raises(ValueError, match=r"^No part.*mass.*mass=.*membranes \[kg/m2\]"):
        natural_frequencies(rest(massless))
    assert stability(rest(massless)).negative == 0


@pytest.mark.mpi_once
@pytest.mark.parametrize("prestress", [0.0, -T])
def test_part_without_mass_that_nothing_holds(prestress):
    """The guy can rest without tension; with a mass its state is unstable, and zero frequencies are its limit."""
    structure = guyed(prestress=prestress)
    loads = [PointLoad(1, (T - prestress, 0, 0))]
    hold = [PrescribedDisplacement([1, 2], np.zeros(3))]
    state = Analysis(structure).run([Stage("rest", loads, hold)])["rest"]
    state = replace(state, actions=replace(state.actions, held=structure.supported))
    with pytest.raises(ValueError, match=r"singular.*negative.*no mass"):
        natural_frequencies(state, 1)
    heavy = guyed(mass=0.1, prestress=prestress)
    modes = natural_frequencies(replace(state, structure=heavy), 2)
    assert modes.frequencies == pytest.approx([0, 0], abs=1e-6)
    assert (modes.growth > 1).all() == (prestress < 0)


@pytest.mark.parametrize("function", [natural_frequencies, stability])
def test_not_a_state(function):
    with pytest.raises(ValueError, match=f"^{function.__name__} state is .*; give a StageResult"):
        function({})


# Constraints of a state


def sheet(seed=None):
    """Prestressed sheet with a cable on its free edge and two nodes that no part uses; its nodes in any order."""
    points, triangles = rectangle(2.0, 1.5, 5, 4, "right")
    points = np.vstack([points, [[9.0, 9, 9], [8, 8, 8]]])
    edge = np.flatnonzero(points[:30, 0] == 1)
    held = np.flatnonzero(points[:30, 0] == -1)
    order = np.arange(32) if seed is None else np.random.default_rng(seed).permutation(32)
    number = np.argsort(order)
    parts = {
        "fabric": Membrane(number[triangles], Fabric(2e4, 0.3), (800.0, 1000.0), warp=(1, 0.2, 0), mass=1.1),
        "edge": Cable(number[np.stack([edge[:-1], edge[1:]], axis=1)], 3e5, 4e3, mass=0.3),
    }
    return Structure(points[order], parts, [Support(number[held]), Support(number[edge[[0, -1]]])]), number


def pulled(seed=None, comm=MPI.COMM_WORLD):
    structure, number = sheet(seed)
    middle = PrescribedDisplacement(number[14], (0.0, 0, 0.1), "z")
    state = Analysis(structure, comm=comm).run([Stage("pull", [PointLoad(number[16], (0, 0, 40.0))], [middle])])["pull"]
    return state, number


@pytest.mark.mpi
def test_prescribed_components_are_held():
    state, number = pulled()
    assert state.actions.held.sum() == state.structure.supported.sum() + 1
    modes = natural_frequencies(state)
    assert not modes.shapes[:, state.actions.held].any()
    assert not modes.shapes[:, ~state.structure.used].any()
    assert modes.shapes[:, number[14], :2].any()
    directions = stability(state, 4).directions
    assert not directions[:, state.actions.held].any()
    assert np.einsum("ani,bni->ab", directions, directions) == pytest.approx(np.eye(4), abs=1e-9)


@pytest.mark.mpi
def test_neither_processes_nor_numbering_matter():
    """Frequencies are distinct here, so that shapes are unique, and their sign is that of the largest component."""
    state, _ = pulled(comm=MPI.COMM_SELF)
    alone, weakest = natural_frequencies(state, comm=MPI.COMM_SELF), stability(state, 3, comm=MPI.COMM_SELF)
    assert (np.diff(alone.frequencies) > 0.01 * alone.frequencies[:-1]).all()
    for seed in (None, 1):
        state, number = pulled(seed)
        modes, stiffness = natural_frequencies(state), stability(state, 3)
        np.testing.assert_allclose(modes.frequencies, alone.frequencies, rtol=1e-9)
        np.testing.assert_allclose(stiffness.stiffnesses, weakest.stiffnesses, rtol=1e-9)
        for mine, theirs in ((modes.shapes, alone.shapes), (stiffness.directions, weakest.directions)):
            np.testing.assert_allclose(mine[:, number], theirs, rtol=0, atol=1e-7 * np.abs(theirs).max())


# Compilation


COMPILED = """
from fx_membrane import *

def state(n):
    points, triangles = rectangle(1.0, 1.0, n, n)
    edges = boundary_edges(triangles)
    parts = {"fabric": Membrane(triangles, Fabric(1e5, 0.3), 1e3, mass=n), "cable": Cable(edges, 1e6, 1e3, mass=1.0)}
    return Analysis(Structure(points, parts, [Support(edges[:, 0])])).run([Stage("rest")])["rest"]

first, other = state(2), state(3)
count()
for result in (first, first, other):
    natural_frequencies(result, 3)
    count()
"""


def test_mass_matrix_is_compiled_once_and_when_asked_for(compiled_code):
    statics, *dynamics = compiled_code(COMPILED)
    assert dynamics == [dynamics[0]] * 3
    assert dynamics[0] > statics
