"""Picture of a cutting pattern: visible, in several colours, and refused for bad input."""

import matplotlib.image
import numpy as np
import pytest

from cone_gores import cone_gores
from fx_membrane import (
    Fabric,
    Membrane,
    Structure,
    boundary_edges,
    cut_strips,
    cutting_pattern,
    planar_cut,
    plot,
    prove_pattern,
    rectangle,
)
from fx_membrane.plot import proof_pictures
from fx_membrane.plot.cutting_patterns import strip_colours
from fx_membrane.plot.proof_pictures import PICTURES, left_out
from fx_membrane.plot.strips_in_view import in_view
from gores import catenoid
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


def test_pictures_of_a_proof(tmp_path, monkeypatch):
    """All that a proof has is drawn; what it has not is told in words."""
    pytest.importorskip("pyvista")
    strips = catenoid(6, 2, 4)
    proof = prove_pattern(cutting_pattern(strips), strength=8e3, roll_width=20.0, progress=False)
    plot.pattern_proof(proof, tmp_path / "all")
    assert {file.name for file in (tmp_path / "all").iterdir()} == set(PICTURES)
    for name in PICTURES:
        assert count_colours(matplotlib.image.imread(tmp_path / "all" / name)[..., :3], 17) > 8, name
    assert left_out(proof.to_dict()) == []
    bare = prove_pattern(cutting_pattern(strips), progress=False)
    drawn = []
    monkeypatch.setattr(proof_pictures, "draw_pattern", lambda pattern, path, *_: drawn.append(path.name))
    monkeypatch.setattr(proof_pictures, "small_picture", lambda structure, fields, path, *_: drawn.append(path.name))
    plot.pattern_proof(bare, tmp_path / "bare")
    assert drawn == [name for name in PICTURES if name not in {"utilisation.png", "widths.png"}]
    first, second = left_out(bare.to_dict())
    assert "no strip has a strength" in first
    assert "none is given" in second


def test_films_of_a_cushion_are_drawn_apart():
    """One below the other, where they share their rim; strips of one roof stay."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.unique(boundary_edges(triangles))
    below = np.where(np.isin(np.arange(25), rim), np.arange(25), np.arange(25) + 25)
    dome = points.copy()
    dome[:, 2] = (1 - points[:, 0] ** 2) * (1 - points[:, 1] ** 2) / 4
    parts = {"top": Membrane(triangles, Fabric(1e5, 0.3)), "bottom": Membrane(below[triangles], Fabric(1e5, 0.3))}
    cushion = Structure(np.vstack([dome, dome * (1, 1, -1)]), parts)
    strips = cut_strips(cushion, planar_cut(cushion, (0, 0, 0), (0, 1, 0)))
    seen = in_view(strips, strips.structure.points)
    assert seen.films == 2
    height = {name: seen.structure.points[seen.structure.parts[name].cells, 2] for name in strips.names}
    assert min(height["top 1"].min(), height["top 2"].min()) > max(height["bottom 1"].max(), height["bottom 2"].max())
    roof = cone_gores(6).strips
    assert in_view(roof, roof.structure.points).films == 1


def test_pictures_of_what_is_no_proof_are_refused(tmp_path):
    with pytest.raises(ValueError, match=r"pattern_proof proof .* PatternProof"):
        plot.pattern_proof(cone_gores(4), tmp_path / "a")
