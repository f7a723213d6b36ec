"""Classes derived from plain data are refused: nothing would use their additions or changes. Laws: `test_laws`."""

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
    equilibrium_path,
    force_density,
    updated_reference,
)
from models import POINTS, TRIANGLES, arch, sheet


def derived(kind):
    return type(f"My{kind.__name__}", (kind,), {})


MyMembrane, MyCable, MyMast, MySupport, MyLoad, MyStage, MyMove = map(
    derived, (Membrane, Cable, Mast, Support, DistributedLoad, Stage, PrescribedDisplacement)
)
BAR = ([[0, 1]], 1e6)
PUSH = PointLoad(1, (0, 0, -1.0))


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Structure(POINTS, {"a": MyMembrane(TRIANGLES, Fabric(1e5, 0.3))}), "Part 'a' is a MyMembrane"),
        (lambda: Structure(POINTS, {"a": MyCable(*BAR)}), "Part 'a' is a MyCable"),
        (lambda: Structure(POINTS, {"a": MyMast(*BAR)}), "Part 'a' is a MyMast"),
        (lambda: Structure(POINTS, {"a": Mast(*BAR)}, [MySupport([0])]), "supports has a MySupport"),
        (lambda: Stage("a", [MyLoad((0, 0, 1), "a")]), "Stage 'a': loads has a MyDistributedLoad"),
        (lambda: Stage("a", [], [MyMove(0, (0, 0, 1))]), "Stage 'a': displacements has a MyPrescribedDisplacement"),
        (lambda: Analysis(arch()).run([MyStage("a", [PUSH])]), "stages has a MyStage"),
        (lambda: equilibrium_path(arch(), MyStage("a", [PUSH])), "equilibrium_path stage is a MyStage"),
        (lambda: updated_reference(sheet(), [derived(Pressure)(1.0, "fabric")]), "loads has a My"),
        (lambda: force_density(np.eye(3), [[0, 1], [1, 2]], 1.0, [MySupport([0, 2])]), "fixed has a MyS"),
    ],
)
def test_derived_class_is_refused(make, words):
    with pytest.raises(ValueError, match=f"^{words}.*class derived"):
        make()


def test_text_of_a_derived_class_is_kept_as_text():
    class Name(str):
        def __str__(self):
            return "another"

    stage = Stage(Name("snow"), [DistributedLoad((0, 0, -1), Name("fabric"))], after=Name("wind"))
    assert [(type(text), text) for text in (stage.name, stage.after, stage.loads[0].part)] == [
        (str, "snow"),
        (str, "wind"),
        (str, "fabric"),
    ]
    structure = Structure(POINTS, {Name("fabric"): Membrane(TRIANGLES, Fabric(1e5, 0.3))})
    assert [(type(name), name) for name in structure.parts] == [(str, "fabric")]
