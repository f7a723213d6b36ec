"""Seams and strips that are refused, with the place and the remedy in one sentence."""

import itertools

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    Structure,
    SurfaceLine,
    boundary_edges,
    cut_strips,
    geodesic,
    planar_cut,
    rectangle,
    seams_between,
    stress_trajectories,
    with_copies,
)

pytest.importorskip("potpourri3d")


def sheet(**parts):
    points, triangles = rectangle(4.0, 3.0, 8, 6)
    return Structure(points, {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3), **parts})


def line(*points):
    return SurfaceLine(np.array(points, dtype=float), np.zeros(len(points) - 1, dtype=np.int64))


ROOF = sheet()
ACROSS = geodesic(ROOF, (-2, 0, 0), (2, 0, 0))


@pytest.mark.parametrize(
    ("seams", "words"),
    [
        ([line((-2, 0, 0.5), (2, 0, 0.5))], r"entry 0, is 0\.5 off the surface at \(0, 0, 0\.5\); make it on this"),
        ([ACROSS, ACROSS], r"entries 0 and 1, coincide at \(.*\); leave one out"),
        ([geodesic(ROOF, (-2, 0, 0), (1, 0.3, 0))], r"entry 0, ends within the surface, at \(1, 0\.3, 0\); lead it on"),
        ([geodesic(ROOF, 0, 8)], r"entry 0, runs along the border around \(.*\); leave it out"),
        ([line((0, 0, 0), (0, 0, 0))], r"entry 0, at \(0, 0, 0\), has no length; leave it out"),
        (["ridge"], r"entry 0, is 'ridge', which is no cable"),
        ([7], "entry 0, is 7; give lines"),
        ("ridge", "seams must be a list"),
        (ACROSS, "put it in brackets"),
    ],
)
def test_seams(seams, words):
    with pytest.raises(ValueError, match=words):
        cut_strips(ROOF, seams)


def test_seam_that_crosses_itself():
    points = [(-2, 0.2, 0), (1, 0.2, 0), (1, 1, 0), (0, 1, 0), (0, -1.5, 0)]
    steps = [np.linspace(a, b, 61)[:-1] for a, b in itertools.pairwise(points)]
    with pytest.raises(ValueError, match=r"entry 0, crosses itself at \(0, 0.2, 0\); make it of two"):
        cut_strips(ROOF, [line(*np.concatenate([*steps, [points[-1]]]))])


def test_cable_that_branches_is_no_seam():
    roof = sheet(web=Cable([[4, 13], [13, 22], [13, 14]], 1e6))
    with pytest.raises(ValueError, match=r"entry 0, is 'web': the cells branch at node 13"):
        cut_strips(roof, ["web"])


def test_wide_strip():
    words = r"Strip 'strip 1' around \(0, .*\) is 1\.5 wide across its axis, more than the roll, 1\.4; set seams closer"
    with pytest.raises(ValueError, match=words):
        cut_strips(ROOF, [ACROSS], roll_width=1.4)
    with pytest.raises(ValueError, match="cut_strips roll_width is -1; it must be positive"):
        cut_strips(ROOF, [ACROSS], roll_width=-1)
    assert cut_strips(ROOF, [ACROSS], roll_width=1.5001).names == ("strip 1", "strip 2")


def test_hole_and_fold_and_closed_surface():
    points, triangles = rectangle(4.0, 3.0, 8, 6)
    centre = np.abs(points[triangles].mean(axis=1)[:, :2]).max(axis=1)
    ring = triangles[centre > 0.5]
    with pytest.raises(ValueError, match=r"no disc, but a tube or with 1 hole, one around \(0, 0, 0\); lead a seam"):
        cut_strips(Structure(points, {"roof": Membrane(ring, Fabric(4e5, 0.3), 2e3)}), [])
    angle = np.linspace(0, 2.6 * np.pi, 60)  # a helical surface about an axis, flat nearly, and more than once around
    spiral = np.concatenate([np.stack([r * np.cos(angle), r * np.sin(angle), 0.1 * angle], axis=1) for r in (2, 3)])
    low = np.arange(59)
    cells = np.concatenate([np.stack([low, low + 60, low + 61], axis=1), np.stack([low, low + 61, low + 1], axis=1)])
    with pytest.raises(ValueError, match=r"Strip 'ramp' folds over itself when laid flat, around .*; part it by one"):
        cut_strips(Structure(spiral, {"ramp": Membrane(cells, Fabric(4e5, 0.3), 2e3)}), [])
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]
    with pytest.raises(
        ValueError, match=r"Strip 'skin' around .* is closed, and cannot be laid flat; part it by seams"
    ):
        cut_strips(Structure(corners, {"skin": Membrane(faces, Fabric(4e5, 0.3), 2e3)}), [])


def test_names():
    with pytest.raises(ValueError, match="names has 1 entries, for 2 strips; give one for each"):
        cut_strips(ROOF, [ACROSS], names=["north"])
    with pytest.raises(ValueError, match="Two parts would have the name 'north'"):
        cut_strips(ROOF, [ACROSS], names=["north", "north"])
    rim = boundary_edges(ROOF.parts["roof"].cells)
    with pytest.raises(ValueError, match="Two parts would have the name 'strip 1'"):
        cut_strips(sheet(**{"strip 1": Cable(rim, 1e6)}), [ACROSS])
    assert cut_strips(ROOF, [ACROSS], names=["south", "north"]).names == ("south", "north")


def test_part_and_shape():
    with pytest.raises(ValueError, match=r"No Membrane is named 'wall'"):
        cut_strips(ROOF, [ACROSS], "wall")
    with pytest.raises(ValueError, match="shape"):
        cut_strips(3, [ACROSS])


@pytest.mark.parametrize(
    ("first", "last", "more", "words"),
    [
        ("edge", [8, 17], {"strips": 2}, "first is 'edge', which is no cable"),
        ([0, 9, 20], [8, 17], {"strips": 2}, r"first has node 20 at .*, which no edge of the rim joins"),
        ([0, 9, 8, 17], [54], {"strips": 2}, "first is no line: the cells are in several pieces"),
        ([0, 9], [8, 17], {"strips": 0}, "strips"),
        ([0, 9], [8, 17], {}, "both strips and roll_width, or neither"),
        ([0, 9], [8, 17], {"strips": 2, "roll_width": 1.0}, "both strips and roll_width, or neither"),
        (
            range(0, 63, 9),
            range(0, 63, 9),
            {"strips": 3},
            r"first and last are the same border at .*; give two borders",
        ),
        ([0], [0], {"strips": 3}, "first and last are the same border"),
        ([0], [8], {"strips": 3}, "first and last are single nodes, with one geodesic between them; give a border"),
        (range(0, 63, 9), range(8, 63, 9), {"roll_width": 1e-3}, r"roll_width is 0\.001, too little for 500 strips"),
    ],
)
def test_families(first, last, more, words):
    with pytest.raises(ValueError, match=words):
        seams_between(ROOF, first, last, **more)


def test_closed_and_open_borders():
    points, triangles = rectangle(4.0, 3.0, 8, 6)
    centre = np.abs(points[triangles].mean(axis=1)[:, :2]).max(axis=1)
    roof = Structure(points, {"roof": Membrane(triangles[centre > 0.5], Fabric(4e5, 0.3), 2e3)})
    hole = np.flatnonzero(np.isclose(np.abs(points[:, :2]).max(axis=1), 0.5))
    with pytest.raises(ValueError, match="The first border is closed and the last one open; give two of a kind"):
        seams_between(roof, hole, range(9), 4)


def test_planes_and_starts():
    with pytest.raises(ValueError, match=r"does not cut the surface; the nearest node is at \(2, "):
        planar_cut(ROOF, (5, 0, 0), (1, 0, 0))
    with pytest.raises(ValueError, match=r"The plane has cell 0 in it, at .*; move or turn it"):
        planar_cut(ROOF, (0, 0, 0), (0, 0, 1))
    with pytest.raises(ValueError, match="spacing is given with starts"):
        stress_trajectories(ROOF, starts=[0], spacing=1.0)
    with pytest.raises(ValueError, match=r"The stress at \(0\.1, 0, 0\) has no direction"):
        stress_trajectories(ROOF, starts=[(0.1, 0, 0)])


def test_copies():
    with pytest.raises(ValueError, match="tolerance"):
        with_copies(cut_strips(ROOF, [ACROSS]), tolerance=-1)
    with pytest.raises(ValueError, match="strips"):
        with_copies(ROOF)
