"""Loads, prescribed displacements and stages: refused input, alone and together with a structure."""

import numpy as np
import pytest

from fx_membrane import (
    Cable,
    DistributedLoad,
    Fabric,
    LengthChange,
    Membrane,
    PlanLoad,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
)
from fx_membrane.model.stages import check_stages

POINTS = [[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]]  # no part uses the last one
STRUCTURE = Structure(
    POINTS,
    {"fabric": Membrane([[0, 1, 2], [0, 2, 3]], Fabric(Et=1e5, nu=0.3)), "ridge": Cable([[0, 2]], 1e6)},
)
NOWHERE = (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: PointLoad(0, (0, np.nan, 1)), r"^PointLoad force has .* not finite \(nan\) at index \(1,\)"),
        (lambda: PointLoad(0, (0, 0, np.inf)), r"^PointLoad force has .* not finite \(inf\) at index \(2,\)"),
        (lambda: PointLoad(0, 5.0), r"^PointLoad force is 5\.0; give three components"),
        (lambda: PointLoad([0, 1], np.ones((2, 3))), r"^PointLoad force is \[\[1\.0, .* give three components"),
        (lambda: PointLoad([True, False], NOWHERE), r"^PointLoad nodes .* not \[True, False\]; .*numpy.flatnonzero"),
        (lambda: PointLoad(3.5, NOWHERE), r"^PointLoad nodes.*list.*whole numbers.*3\.5\."),
        (lambda: PointLoad([2, 1, 2], NOWHERE), "^PointLoad nodes names node 2 twice"),
        (lambda: DistributedLoad(NOWHERE, "fabric", [0, 1, 1]), "^DistributedLoad cells names cell 1 twice"),
        (lambda: PlanLoad(NOWHERE, "fabric", [7, 7]), "^PlanLoad cells names cell 7 twice"),
        (lambda: Pressure(1.0, "fabric", [0, 0]), "^Pressure cells names cell 0 twice"),
        (
            lambda: DistributedLoad("fabric", NOWHERE),
            "^DistributedLoad load.*array.*numbers.*'fabric'",
        ),
        (lambda: DistributedLoad(NOWHERE, 5), "^DistributedLoad part is 5; give a text"),
        (lambda: PlanLoad(NOWHERE, None), "^PlanLoad part is None; give a text"),
        (lambda: Pressure(1.0, 3), "^Pressure part is 3; give a text"),
        (lambda: Pressure(NOWHERE, "fabric"), r"^Pressure pressure.*\(0\.0, 0\.0, 0\.0\).*number"),
        (
            lambda: DistributedLoad((np.nan, 0, 0), "fabric"),
            r"^DistributedLoad load has .* not finite \(nan\) at index \(0,\)",
        ),
        (lambda: DistributedLoad((0, 0), "fabric"), r"^DistributedLoad load is \(0, 0\); give three components"),
        (
            lambda: DistributedLoad(NOWHERE, "fabric", [True, False]),
            r"^DistributedLoad cells .* not \[True, False\]; .*numpy.flatnonzero",
        ),
        (lambda: DistributedLoad(NOWHERE, "fabric", [[0]]), r"^DistributedLoad cells must be .* not \[\[0\]\]"),
        (lambda: PrescribedDisplacement(0, (0, 0, -np.inf)), r"^PrescribedDisplacement displacement has .*\(-inf\) at"),
        (
            lambda: PrescribedDisplacement(0, 0.1),
            r"^PrescribedDisplacement displacement is 0\.1; .* of the 1 nodes",
        ),
        (
            lambda: PrescribedDisplacement([0, 1], np.ones((3, 3))),
            r"^PrescribedDisplacement displacement.*array.*float64, shape \(3, 3\)",
        ),
        (lambda: PrescribedDisplacement([False], NOWHERE), r"^PrescribedDisplacement nodes .* not \[False\]"),
        (lambda: PrescribedDisplacement(0, NOWHERE, "u"), "^PrescribedDisplacement components is 'u'"),
    ],
)
def test_bad_values(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize("steps", [0, -3, 2.0, np.nan, "2", None, True])
def test_steps_must_be_a_whole_number_above_zero(steps):
    with pytest.raises(ValueError, match=f"^Stage 'snow': increments is {steps!r}.*whole number"):
        Stage("snow", increments=steps)


def test_steps_may_be_a_number_of_numpy():
    assert Stage("snow", increments=np.int32(4)).increments == 4


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"loads": [5.0]}, r"^Stage 'snow': loads.*5\.0.*list.*PointLoad"),
        ({"loads": [PrescribedDisplacement(0, NOWHERE)]}, "^Stage 'snow': loads has a Prescribed.*displacements"),
        ({"loads": [LengthChange(0.1, "edge")]}, "^Stage 'snow': loads has .*LengthChange.* changes"),
        ({"displacements": [5.0]}, r"^Stage 'snow': displacements.*5\.0.*list.*PrescribedDisplacement"),
        ({"displacements": [PointLoad(0, NOWHERE)]}, "^Stage 'snow': displacements has a PointLoad; give"),
    ],
)
def test_entries_of_another_kind(data, message):
    with pytest.raises(ValueError, match=message):
        Stage("snow", **data)


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        (PointLoad(5, NOWHERE), "^Stage 'snow'.*point load names node 5.*not exist"),
        (PointLoad([0, -1], NOWHERE), "^Stage 'snow'.*point load names node -1.*not exist"),
        (PointLoad(4, NOWHERE), "^Stage 'snow'.*point load.*node 4.*no part uses"),
        (
            DistributedLoad(NOWHERE, "roof"),
            r"^Stage 'snow'.*load.*part 'roof'.*parts.*\['fabric', 'ridge'\]",
        ),
        (DistributedLoad(NOWHERE, "fabric", [0, 2]), "^Stage 'snow'.*load.*part 'fabric' names cell 2.*0 to 1"),
        (DistributedLoad(NOWHERE, "ridge", -1), "^Stage 'snow'.*load.*part 'ridge' names cell -1.*0 to 0"),
    ],
)
def test_load_that_does_not_fit_the_structure(entry, message):
    with pytest.raises(ValueError, match=message):
        check_stages(STRUCTURE, [Stage("rest"), Stage("snow", [entry])])


@pytest.mark.parametrize(
    ("node", "message"),
    [(5, "names node 5.*not exist"), (-1, "names node -1, which"), (4, "node 4.*no part uses")],
)
def test_prescribed_displacement_that_does_not_fit_the_structure(node, message):
    stage = Stage("lift", displacements=[PrescribedDisplacement(node, NOWHERE)])
    with pytest.raises(ValueError, match=f"^Stage 'lift'.*prescribed displacement.*{message}"):
        check_stages(STRUCTURE, [stage])


def test_two_stages_of_one_name():
    with pytest.raises(ValueError, match=r"^Stage 'snow' is given twice"):
        check_stages(STRUCTURE, [Stage("snow"), Stage("wind"), Stage("snow", after="wind")])


@pytest.mark.parametrize(
    ("after", "remedy"),
    [
        ("prestres", "correct.*name.*leave `after`"),
        ("", "correct.*name.*leave `after`"),
        ("wind", "'wind'.*list.*before"),
        ("snow", "name.*leave `after`"),
    ],
    ids=["unknown", "no name", "later", "itself"],
)
def test_after_a_stage_that_is_not_before(after, remedy):
    stages = [Stage("prestress"), Stage("snow", after=after), Stage("wind")]
    message = rf"^Stage 'snow' is to follow '{after}', but.*\['prestress'\].*{remedy}"
    with pytest.raises(ValueError, match=message):
        check_stages(STRUCTURE, stages)
    with pytest.raises(ValueError, match=f"^Stage 'snow'.*follow '{after}'.*no stage.*before.*{remedy}"):
        check_stages(STRUCTURE, stages[1:])


def test_stages_that_fit():
    stages = [
        Stage("prestress", displacements=[PrescribedDisplacement([0, 3], (0, 0, 1), "z")]),
        Stage("snow", [DistributedLoad((0, 0, -1), "fabric", [0, 1]), PointLoad([2, 3], (0, 0, 1))], after="prestress"),
        Stage("wind", [DistributedLoad((0, 0, -1), "ridge")], after="prestress"),
    ]
    check_stages(STRUCTURE, stages)


def test_pressure_of_several_cells_names_the_remedy():
    with pytest.raises(ValueError, match=r"Pressure pressure.*cells.*EnergyTerm"):
        Pressure(np.ones(3), "fabric")
