"""Case files of a tent and of a sail in plan, and the lines of their faults."""

import pytest

from fx_membrane import (
    Cable,
    Fabric,
    Membrane,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    write_mesh,
)
from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError

TENT = """
format = 1
geometry = { kind = "file", file = "tent.obj" }
materials.pvc = { kind = "fabric", Et = 500, nu = 0.3 }
parts.film = { kind = "membrane", material = "pvc", prestress = 2 }
parts.edge = { kind = "cable", axial_stiffness = 1e4, prestress = 40 }
supports = [{ nodes = [0, 4, 20, 24] }]
"""


def tent():
    points, triangles = rectangle(4.0, 4.0, 4, 4)
    points[:, 2] = points[:, 0] * points[:, 1] / 4
    parts = {
        "film": Membrane(triangles, Fabric(500.0, 0.3), 2.0),
        "edge": Cable(boundary_edges(triangles), 1e4, prestress=40.0),
    }
    return Structure(points, parts, [Support([0, 4, 20, 24])])


def case_of(folder, text, head=TENT):
    write_mesh(tent(), folder / "tent.obj")
    (folder / "tent.toml").write_text(head + text, encoding="utf-8")
    return read_case(folder / "tent.toml")


def refused(folder, text, head=TENT):
    """Lines of the faults of a case."""
    with pytest.raises(CaseError) as caught:
        case_of(folder, text, head)
    return [line.split("tent.toml:", 1)[1] for line in caught.value.lines]


SAIL = """
format = 1
materials.pvc = { kind = "neo-hooke", E = 5e5, thickness = 1e-3 }
parts.sail = { kind = "membrane", material = "pvc", prestress = 2, warp = { origin = [3, 3, 0] } }
parts.edge = { kind = "cable", group = ["A-B", "B-C", "C-D", "D-A"], axial_stiffness = 1e4, prestress = 20 }
supports = [{ group = "A" }, { group = "B" }, { group = "C" }, { group = "D" }, { group = "ring" }]
[geometry]
kind = "sail"
corners = { A = [0, 0], B = [6, 0], C = [6, 6], D = [0, 6] }
size = 1.5
sag = 0.05
holes.ring = { centre = [3, 3, 2], radius = 0.5 }
lines.valley = ["A", ["ring", 0.625]]
"""
