"""Changes of natural shape and prestress as data: refused input."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    Analysis,
    LengthChange,
    NaturalStretch,
    Pressure,
    PrestressFactor,
    Stage,
    TemperatureChange,
)
from fx_membrane.model.changes import natural_after
from models import masted_roof, sheet

ROOF = masted_roof()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: NaturalStretch((1, 1, 1), "roof"), r"^NaturalStretch stretch has shape \(3,\); give a number, a pair"),
        (lambda: NaturalStretch(0.4, "roof"), r"^NaturalStretch stretch: cell 0 is 0\.4 times as long"),
        (lambda: NaturalStretch(-1.0, "edge"), r"^NaturalStretch stretch: cell 0 is"),
        (lambda: NaturalStretch("long", "edge"), r"^NaturalStretch stretch"),
        (lambda: NaturalStretch(0.99, 7), r"^NaturalStretch part"),
        (lambda: NaturalStretch(0.99, "edge", [0, 0]), r"^NaturalStretch cells .*cell 0"),
        (lambda: NaturalStretch(0.99, "edge", [0.5]), r"^NaturalStretch cells"),
        (lambda: TemperatureChange("warm", "roof", 1e-5), r"^TemperatureChange difference"),
        (lambda: TemperatureChange(30.0, "roof", (1e-5,) * 3), r"^TemperatureChange expansion has shape \(3,\)"),
        (lambda: TemperatureChange(30.0, "roof", 12.0), r"^TemperatureChange strains part 'roof' by 3\.6e\+04 %; give"),
        (lambda: TemperatureChange(np.inf, "roof", 1e-5), r"^TemperatureChange difference"),
        (lambda: LengthChange("3 cm", "edge"), r"^LengthChange change"),
        (lambda: LengthChange([0.1, 0.2], "edge"), r"^LengthChange change"),
        (lambda: PrestressFactor(-0.1, "roof"), r"^PrestressFactor factor is -0\.1.*negative"),
        (lambda: PrestressFactor(np.nan, "roof"), r"^PrestressFactor factor is nan"),
        (lambda: Stage("s", changes=[Pressure(1.0, "roof")]), r"^Stage 's': changes .*Pressure"),
        (lambda: Stage("s", loads=[PrestressFactor(0.8, "roof")]), r"^Stage 's': loads .*PrestressFactor"),
        (lambda: Stage("s", changes=LengthChange(0.1, "edge")), r"^Stage 's': changes"),
    ],
)
def test_bad_changes(make, message):
    with pytest.raises(ValueError, match=message):
        make()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            PrestressFactor(0.8, "sail"),
            r"^Stage 's' has a PrestressFactor of part 'sail', which does not exist.*'roof'",
        ),
        (LengthChange(0.1, "roof"), r"^Stage 's' has a LengthChange of 'roof', a Membrane; .*NaturalStretch"),
        (LengthChange(0.1, "edge", [99]), r"LengthChange of part 'edge' names cell 99"),
        (LengthChange(-9.0, "edge"), r"^Part 'edge' after a LengthChange: cell 0 is"),
        (NaturalStretch((0.99, 0.98), "edge"), r"NaturalStretch of 'edge' along warp and weft.*give one number"),
        (TemperatureChange(9.0, "mast", (1e-5, 2e-5)), r"TemperatureChange of 'mast' along warp and weft"),
    ],
)
def test_changes_that_do_not_fit_the_structure(change, message):
    with pytest.raises(ValueError, match=message):
        Analysis(ROOF).run([Stage("s", changes=[change])])


def test_change_along_warp_and_weft_needs_a_warp():
    with pytest.raises(ValueError, match=r"'fabric' along warp and weft.*give one number, or the membrane a warp"):
        Analysis(sheet()).run([Stage("s", changes=[NaturalStretch((0.99, 0.98), "fabric")])])


def test_natural_shape_that_grows_beyond_all_bounds_is_refused():
    changes = [NaturalStretch(1.9, "edge"), NaturalStretch(1.9, "edge")]
    with pytest.raises(ValueError, match=r"^Part 'edge' after a NaturalStretch: cell 0 is 3\.61 times as long"):
        Analysis(ROOF).run([Stage("s", changes=changes)])


def test_temperatures_add_up():
    """Strains of warming add up, whatever the order; up and down is the identity to rounding."""
    start = np.tile([[1.01, 0.02], [0.0, 0.97]], (len(ROOF.parts["roof"].cells), 1, 1))
    warm = TemperatureChange(40.0, "roof", (2e-5, 5e-5))
    further = TemperatureChange(-90.0, "roof", (2e-5, 5e-5))
    back = TemperatureChange(50.0, "roof", (2e-5, 5e-5))
    end = start
    for change in (warm, further, back):
        end = natural_after(ROOF, change, end)
    assert np.allclose(end, start, rtol=0, atol=1e-15)
    other = natural_after(ROOF, further, natural_after(ROOF, warm, start))
    assert np.allclose(other, natural_after(ROOF, warm, natural_after(ROOF, further, start)), rtol=0, atol=1e-15)


def test_temperature_beyond_the_natural_size_is_refused():
    with pytest.raises(ValueError, match=r"^TemperatureChange leaves cell 3 of part 'edge' without a stress-free"):
        natural_after(ROOF, TemperatureChange(1.0, "edge", 0.3, [3]), np.full((16, 1, 1), 1.9))


def test_changes_are_compared_by_value():
    assert LengthChange(0.1, "edge", [0, 1]) == LengthChange(0.1, "edge", np.array([0, 1]))
    assert LengthChange(0.1, "edge") != LengthChange(0.2, "edge")
    stage = Stage("s", changes=[PrestressFactor(0.8, "roof")])
    assert stage == Stage("s", changes=[PrestressFactor(0.8, "roof")])
    assert stage != replace(stage, changes=[PrestressFactor(0.7, "roof")])
