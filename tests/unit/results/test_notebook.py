"""Results show themselves in notebooks, names of users as text."""

import numpy as np

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    Modes,
    Pressure,
    Stability,
    Stage,
    Structure,
    Support,
    boundary_edges,
    drainage,
    polyline,
    rectangle,
)


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


def test_modes_and_stability_show_all_their_values():
    shapes = np.zeros((2, 4, 3))
    shapes[1, 3, 2] = 1.0
    modes = Modes(np.array([0.0, 3.25]), np.array([1.5, 0.0]), shapes)
    shown = modes._repr_html_()
    assert shown.startswith("<b>Modes(0, 3.25 Hz, 1 that grow)</b>")
    assert "<tr><td>1</td><td>3.25</td><td>0</td></tr>" in shown
    held = "mast '<b>' (cell 0, at node 1)"
    shown = Stability(np.array([-2.0, 7.5]), shapes, 1, 0, held)._repr_html_()
    assert "not stable" in shown
    assert "&lt;b&gt;" in shown
    assert "<tr><td>7.5</td><td>3</td></tr>" in shown


def test_parts_of_a_state_show_their_extremes_with_cells():
    """Their arrays stood there digit by digit."""
    points, triangles = rectangle(2.0, 2.0, 4, 4)
    rim = np.unique(boundary_edges(triangles))
    parts = {"roof": Membrane(triangles, Fabric(4e5, 0.3), 2e3), "ridge": Cable(polyline(np.arange(10, 15)), 1e6, 1e3)}
    state = Analysis(Structure(points, parts, [Support(rim)])).run([Stage("wind", [Pressure(50.0, "roof")])])["wind"]
    roof, ridge = state.membrane("roof"), state.parts["ridge"]
    least, largest = roof.principal.min(), roof.principal.max()
    text = "MembraneResult(32 cells: 32 taut, 0 wrinkled, 0 slack; principal stress "
    assert repr(roof) == f"{text}{least:.5g} to {largest:.5g})"
    assert f"<td>{largest:.5g}</td><td>{roof.principal[:, 0].argmax()}</td></tr>" in roof._repr_html_()
    assert repr(ridge) == f"BarResult(4 cells: 0 slack; force {ridge.force.min():.5g} to {ridge.force.max():.5g})"
    assert f"<td>{ridge.force.max():.5g}</td><td>{ridge.force.argmax()}</td></tr>" in ridge._repr_html_()


def test_drainage_shows_its_depressions():
    points, triangles = rectangle(8.0, 8.0, 8, 8)
    points[:, 2] = 0.05 * (points[:, 0] ** 2 + points[:, 1] ** 2)
    found = drainage((points, triangles))
    (pond,) = found.depressions
    shown = found._repr_html_()
    assert shown.startswith("<b>Drainage: least slope ")
    assert f"<tr><td>40</td><td>(0, 0, 0)</td><td>{pond.spill}</td><td>0.8</td><td>{pond.area:.4g}</td>" in shown
    points[:, 2] = 0.1 * points[:, 0]
    assert drainage((points, triangles))._repr_html_().startswith("<b>Drainage: water runs off everywhere; ")
