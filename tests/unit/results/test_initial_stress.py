"""Structures as built: pictures and scenes show the stress of natural shapes, as a stage without loads has it."""

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Membrane, OrthotropicFabric, Stage, Structure, Support, rectangle
from fx_membrane.files.scene.view_data import views
from fx_membrane.plot.subjects import shown
from fx_membrane.surfaces.stress_lines import stress_of, stress_trajectories

POINTS, TRIANGLES = rectangle(3.0, 2.0, 3, 2)
WOVEN = OrthotropicFabric(900.0, 600.0, 0.2, 40.0)


@pytest.fixture(scope="module")
def held():
    """Sheet and cable held at all nodes, whose natural shapes are smaller, and its state without loads."""
    sheet = Membrane(TRIANGLES, WOVEN, (1.0, 2.0), warp=(1, 0, 0), natural_stretch=(0.99, 0.999))
    cable = Cable([(0, 1), (1, 2)], 5e3, 4.0, natural_stretch=0.998)
    structure = Structure(POINTS, {"sheet": sheet, "cable": cable}, [Support(range(len(POINTS)))])
    return structure, Analysis(structure).run([Stage("none")])


def test_scene_has_the_stress_of_natural_shapes(held):
    structure, results = held
    (_, (built,)), (_, (state,)) = views(structure, "kN", "m"), views(results, "kN", "m")
    for part, heads in (
        ("sheet", ["principal stress I [kN/m]", "stress along weft [kN/m]"]),
        ("cable", ["force [kN]"]),
    ):
        for head in heads:
            assert built.columns[part][head] == pytest.approx(state.columns[part][head], rel=1e-9), head
    assert built.columns["cable"]["force [kN]"].min() > 10  # 4 kN without its natural shape


def test_pictures_have_the_stress_of_natural_shapes(held):
    structure, results = held
    assert shown("a test", structure).forces["cable"] == pytest.approx(results["none"].cable("cable").force, rel=1e-9)
    found, wanted = stress_of(structure, "sheet"), stress_of(results["none"], "sheet")
    assert np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max()
    for line in stress_trajectories(structure, spacing=0.5):  # the prestress alone is larger along the weft
        assert np.ptp(line.points[:, 1]) < 1e-9
