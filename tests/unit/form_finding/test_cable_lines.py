"""Lines of a cable: their ends, and sag and angle of an arc."""

import numpy as np
import pytest

from fx_membrane import (
    polyline,
)
from fx_membrane.form_finding.constraints.cable_lines import lines_of
from models import rotation


def test_lines_end_at_ends_branches_and_held_nodes():
    cells = np.array([[3, 4], [0, 1], [2, 1], [2, 3], [5, 4], [4, 6], [7, 8], [8, 9], [9, 7]])
    held = np.arange(10) == 2
    found = {tuple(sorted(line.cells.tolist())) for line in lines_of(cells, np.arange(9), held)}
    assert found == {(1, 2), (0, 3), (4,), (5,), (6, 7, 8)}
    (ring,) = (line for line in lines_of(cells, np.arange(9), held) if line.is_closed)
    assert ring.nodes[0] == ring.nodes[-1]
    assert len(ring.nodes) == 4


@pytest.mark.parametrize("angle", [0.01, 0.7, 1.5])
def test_angle_and_sag_of_an_arc_are_exact_at_any_nodes(angle):
    t = np.array([-angle, -0.8 * angle, -0.1 * angle, 0.0, 0.5 * angle, angle])
    points = np.stack([np.sin(t), np.cos(t), 0 * t], axis=1) @ rotation(4).T
    (line,) = lines_of(polyline(range(6)), np.arange(5), np.zeros(6, dtype=bool))
    assert line.angle(points) == pytest.approx(angle, rel=1e-9)
    assert line.sag(points, None) == pytest.approx(1 - np.cos(angle), rel=1e-9)
