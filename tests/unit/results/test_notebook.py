"""Results show themselves in notebooks, names of users as text."""

import numpy as np

from fx_membrane import Analysis, Fabric, Membrane, Pressure, Stage, Structure, Support, boundary_edges, rectangle


def test_states_show_their_checks_and_extremes():
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.unique(boundary_edges(triangles))
    structure = Structure(points, {"<roof>": Membrane(triangles, Fabric(4e5, 0.3), 2e3)}, [Support(rim)])
    results = Analysis(structure).run([Stage("wind & rain", [Pressure(50.0, "<roof>")])])
    state = results["wind & rain"]
    shown = state._repr_html_()
    assert f"{state.membrane('<roof>').principal[:, 0].max():.5g}" in shown
    assert "PASS" in shown
    for html in (shown, results._repr_html_()):
        assert "<roof>" not in html
        assert "wind &amp; rain" in html
        assert html.count("<table>") == html.count("</table>") > 0
