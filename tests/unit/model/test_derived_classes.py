"""Classes derived from plain data are refused: nothing would use their additions or changes. Laws: `test_laws`."""

from dataclasses import dataclass

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    Cable,
    ConjugateGradient,
    DistributedLoad,
    Fabric,
    Mast,
    Membrane,
    Newton,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Problem,
    RadialDirection,
    RoundHole,
    Slide,
    Stage,
    SteepestDescent,
    Structure,
    Support,
    WorkLimit,
    equilibrium_path,
    force_density,
    prescribed_stress,
    projected_stress,
    sail_mesh,
    updated_reference,
)
from models import POINTS, SNOW, TRIANGLES, arch, sheet


def derived(kind):
    return type(f"My{kind.__name__}", (kind,), {})


MyMembrane, MyCable, MyMast, MySupport, MyLoad, MyStage, MyMove = map(
    derived, (Membrane, Cable, Mast, Support, DistributedLoad, Stage, PrescribedDisplacement)
)
MyStructure, MyLimit, MyHole, MyRadial = map(derived, (Structure, WorkLimit, RoundHole, RadialDirection))
SAIL = {"a": (0, 0, 0), "b": (6, 0, 0), "c": (6, 6, 0), "d": (0, 6, 0)}
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
        (lambda: MyStructure(POINTS, {"a": Mast(*BAR)}), "The structure is a MyStructure"),
        (lambda: Problem(arch()).actions_of(MyStage("a", [PUSH])), "actions_of stage is a MyStage"),
        (lambda: Analysis(arch(), limit=MyLimit()), "Analysis limit is a MyWorkLimit"),
        (
            lambda: equilibrium_path(arch(), Stage("a", [PUSH]), limit=MyLimit()),
            "equilibrium_path limit is a MyWorkLimit",
        ),
        (lambda: sail_mesh(SAIL, 1.0, holes={"h": MyHole((3, 3, 1), 0.5)}), "The hole 'h' is a MyRoundHole"),
        (lambda: prescribed_stress(sheet(), warp={"fabric": MyRadial((9, 9, 0))}), "warp of part 'fabric' is a My"),
        (lambda: projected_stress(sheet(), constraints=[derived(Slide)([0], (1, 0, 0))]), "constraints has a My"),
        (lambda: force_density(np.eye(3), [[0, 1], [1, 2]], 1.0, [MySupport([0, 2])]), "fixed has a MyS"),
    ],
)
def test_derived_class_is_refused(make, words):
    with pytest.raises(ValueError, match=f"^{words}.*class derived"):
        make()


@pytest.mark.parametrize("parent", [Newton, ConjugateGradient, SteepestDescent])
def test_solver_that_inherits_all_it_does_is_refused(parent):
    kind = dataclass(frozen=True)(type("Mine", (parent,), {"__annotations__": {"damping": float}, "damping": 2.0}))
    words = (
        rf"^Analysis solver is a Mine, of a class derived from {parent.__name__}, .*define prepare\(problem\) in Mine"
    )
    with pytest.raises(ValueError, match=words):
        Analysis(arch(), kind())


def test_solver_may_be_derived_with_a_prepare_of_its_own():
    class Counted(Newton):
        solves = 0

        def prepare(self, problem):
            solve = super().prepare(problem)

            def counted(*given):
                Counted.solves += 1
                return solve(*given)

            return counted

    class Again(Counted):
        pass

    Analysis(sheet(), Again()).run([Stage("snow", [SNOW])])
    assert Counted.solves == 1


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
