"""Pictures of cables alone, coloured by their forces."""

import pytest

from fx_membrane import Analysis, Cable, PointLoad, Stage, Structure, Support, plot
from fx_membrane.plot import colour_scale, panels, windows
from pictures import picture


@pytest.fixture
def titles(monkeypatch):
    """Names of the colour bars, in small windows, which are drawn fast."""
    pytest.importorskip("pyvista")
    monkeypatch.setattr(windows, "LONGER", 300)
    found, draw = [], colour_scale.colour_bar
    monkeypatch.setattr(panels, "colour_bar", lambda *given: found.append(given[4]) or draw(*given))
    return found


@pytest.fixture
def net():
    points = [[-2, 0, 0], [0, 0, 0.2], [2, 0, 0], [0, -2, 0.4], [0, 2, 0.4]]
    cables = {"a": Cable([[0, 1], [1, 2]], 1e6, 2e3), "b": Cable([[3, 1], [1, 4]], 1e6, 3e3)}
    return Structure(points, cables, [Support([0, 2, 3, 4])])


def test_field_that_no_cable_shows_beside_forces_has_no_colour_bar(net, tmp_path, titles):
    """A bar of a field of nodes stood below cables coloured by their forces."""
    fields = {"height [m]": net.points[:, 2], "slackness": {"a": [0, 1]}}
    with pytest.warns(UserWarning, match="'height .m.', 'slackness': only cables"):
        plot.contours(net, fields, tmp_path / "net.png", forces=True)
    assert titles == ["Force of cables [N]"]
    wide = picture(tmp_path / "net.png").shape[1]
    plot.contours(net, {"height [m]": net.points[:, 2]}, tmp_path / "height.png")
    assert picture(tmp_path / "height.png").shape[1] == wide  # one picture, not two
    assert titles[1:] == [""]


def test_animation_of_cables_alone_by_forces_has_one_colour_bar(net, tmp_path, titles, recwarn):
    states = list(Analysis(net).run([Stage("prestress"), Stage("snow", [PointLoad([1], (0, 0, -500.0))])]).values())
    plot.animation(states, tmp_path / "net.gif", forces=True)
    assert titles == ["Force of cables [N]"] * 2
    assert not [entry for entry in recwarn if "only cables" in str(entry.message)]
