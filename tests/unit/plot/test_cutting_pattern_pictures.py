"""Picture of a cutting pattern: visible, in several colours, and refused for bad input."""

import matplotlib.image
import pytest

from cone_gores import cone_gores
from fx_membrane import plot
from fx_membrane.plot.cutting_patterns import strip_colours
from pictures import count_colours


def test_neighbours_have_different_colours():
    strips = cone_gores(9).strips  # one more than there are colours
    chosen = strip_colours(strips)
    for edge in strips.edges:
        assert len({chosen[name] for name in edge.strips}) == len(edge.strips)


def test_picture_shows_the_strips(tmp_path):
    pytest.importorskip("pyvista")
    plot.cutting_pattern(cone_gores(6, names="g$ {}"), tmp_path / "new" / "strips.png")
    image = matplotlib.image.imread(tmp_path / "new" / "strips.png")[..., :3]
    white = (image > 0.99).all(axis=2).mean()
    assert 0.2 < white < 0.95
    assert count_colours(image, 17) > 20


@pytest.mark.parametrize(("path", "view", "words"), [("a.doc", (1, 1, 1), "a.doc"), ("a.png", (0, 0, 0), "view")])
def test_wrong_input_is_refused(tmp_path, path, view, words):
    with pytest.raises(ValueError, match=words):
        plot.cutting_pattern(cone_gores(4), tmp_path / path, view=view)
