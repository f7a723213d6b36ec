"""Meshes of several plans by one process of gmsh."""

import subprocess
from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import Membrane, Structure, Support, cut_strips, planar_cut
from fx_membrane.runtime import child_process
from fx_membrane.surfaces import plan_mesh
from fx_membrane.surfaces.plan_mesh import PlanSegments, triangulated
from hypars import FABRIC, hypar

pytest.importorskip("gmsh")


CORNERS = np.array([[0, 0], [2, 0], [2, 1], [0.5, 1.4]])


def plan(scale=1.0, pieces=5, name="the plan"):
    ends = np.roll(CORNERS, -1, axis=0)
    share = np.arange(pieces)[None, :, None] / pieces
    points = scale * (CORNERS[:, None] * (1 - share) + ends[:, None] * share).reshape(-1, 2)
    rows = np.arange(len(points))
    size = 2 * scale / pieces
    segments = np.column_stack([rows, np.roll(rows, -1)])
    return PlanSegments(points, segments, 0 * rows, np.full(len(rows), size), size, name=name)


def of_field(size):
    """Plan with a field of sizes, whose options must not reach the next plan."""
    return replace(plan(), field=(CORNERS, np.array([[0, 1, 2], [0, 2, 3]]), np.full(4, size)))


def test_each_plan_is_meshed_as_if_alone():
    first, second, third = triangulated([plan(), of_field(0.1), plan()])
    assert len(second[0]) > 2 * len(first[0])
    for one, together in ((plan(), (first, third)), (of_field(0.1), (second,))):
        ((alone, cells),) = triangulated([one])
        for points, triangles in together:
            assert np.array_equal(points, alone)
            assert np.array_equal(triangles, cells)


def test_strips_start_gmsh_once_and_tell_the_progress(monkeypatch):
    points, _, roof = hypar()
    structure = Structure(points, {"roof": replace(roof, material=FABRIC)}, [Support([0])])
    seams = [planar_cut(structure, (x, 0, 0), (1, 0, 0))[0] for x in (-0.7, 0.1, 0.9)]
    starts, told = [], []

    class Counted(subprocess.Popen):
        def __init__(self, command, **given):
            starts.append(command)
            super().__init__(command, **given)

    def run(script, arguments, folder, seconds, work):
        told.append(work())
        ended = child_process.run_script(script, arguments, folder, seconds, work)
        told.append(work())
        return ended

    monkeypatch.setattr(subprocess, "Popen", Counted)
    monkeypatch.setattr(plan_mesh, "run_script", run)
    strips = cut_strips(structure, seams, size=0.5)
    assert len(strips.structure.parts_of(Membrane)) == 4
    assert len(starts) == 1
    assert told == [f"gmsh has meshed {done} of 4 plans" for done in (0, 4)]


def test_the_plan_that_fails_is_named():
    one = plan(pieces=1, name="the plan of part 'strip 2'")
    opened = replace(one, segments=np.array([[0, 1], [1, 2], [2, 3], [3, 1]]))
    with pytest.raises(ValueError, match=r"gmsh (cannot mesh|loses a segment of) the plan of part 'strip 2'"):
        triangulated([plan(), opened, plan()])


def test_lines_that_cross_are_refused_with_their_place():
    """gmsh 4.15 never ends with them."""
    one = plan(pieces=1, name="the plan of part 'strip 2'")
    crossed = replace(one, segments=np.array([[0, 2], [2, 1], [1, 3], [3, 0]]))
    with pytest.raises(ValueError, match=r"^Lines of the plan of part 'strip 2' cross at \(1\.\d+, 0\.\d+\); move"):
        triangulated([plan(), crossed, plan()])
