"""Wire frames: visible content, and refused input."""

import numpy as np
import pytest

from fx_membrane import plot
from pictures import POINTS, TRIANGLES, assert_drawn, picture


def test_wireframe_in_plan(result, tmp_path):
    path = tmp_path / "plan.png"
    plot.wireframe(result.structure.points, result.structure.parts, path, labels=[0, 12, 24], first=1)
    assert assert_drawn(path) == pytest.approx(1, rel=0.1)


def test_wireframe_from_a_side(result, tmp_path):
    plan, side = tmp_path / "plan.png", str(tmp_path / "side.png")
    parts = {name: part.cells for name, part in result.structure.parts.items()}
    plot.wireframe(result.position, parts, plan)
    plot.wireframe(result.position.tolist(), parts, side, view=(1, -2, 0.5))
    assert_drawn(tmp_path / "side.png")
    assert not np.array_equal(picture(plan), picture(tmp_path / "side.png"))


def test_wireframe_from_above(result, tmp_path):
    path = tmp_path / "above.png"
    plot.wireframe(result.structure.points, {"south": result.structure.parts["south"].cells}, path, view=(0, 0, 1))
    assert_drawn(path, colours=3)


@pytest.mark.parametrize(
    ("points", "parts", "options", "message"),
    [
        (POINTS[:, :2], {"roof": TRIANGLES}, {}, r"^points has shape \(26, 2\)"),
        (POINTS, TRIANGLES, {}, "^parts.*array.*dictionary"),
        (POINTS, {"roof": TRIANGLES + 9}, {}, "^Part 'roof' names node 26.*not exist"),
        (POINTS, {"roof": TRIANGLES}, {"labels": [26]}, "^labels names node 26.*not exist"),
        (POINTS, {"roof": TRIANGLES}, {"view": (0, 0, 0)}, "^view is .*give a direction"),
    ],
)
def test_wrong_wireframes_are_refused(tmp_path, points, parts, options, message):
    with pytest.raises(ValueError, match=message):
        plot.wireframe(points, parts, tmp_path / "never.png", **options)
