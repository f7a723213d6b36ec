"""Kinds of parts: selection from a structure, and the properties that stand for a kind elsewhere."""

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Fabric, Mast, Membrane, Stage, Structure, Support, rectangle
from fx_membrane.model.parts import Bar, Part

POINTS, TRIANGLES = rectangle(1.0, 1.0, 1, 1)
PARTS: dict[str, Part] = {
    "fabric": Membrane(TRIANGLES, Fabric(1e5, 0.3), 10.0),
    "edge": Cable([[0, 1]], 1e6, prestress=5.0),
    "mast": Mast([[2, 3]], 1e6, prestress=-3.0),
    "stay": Cable([[0, 2]], 1e6, compression_stiffness=1),
}
STRUCTURE = Structure(POINTS, PARTS, [Support(range(4))])


@pytest.mark.parametrize(
    ("kind", "names"),
    [(Membrane, ["fabric"]), (Cable, ["edge", "stay"]), (Mast, ["mast"]), (Bar, ["edge", "mast", "stay"])],
)
def test_parts_of_a_kind(kind, names):
    found = STRUCTURE.parts_of(kind)
    assert list(found) == names
    assert all(found[name] is STRUCTURE.parts[name] for name in names)


@pytest.mark.parametrize("kind", ["cable", Structure, None, PARTS["edge"]])
def test_kinds_that_are_none(kind):
    with pytest.raises(ValueError, match=r"^The kind of a part is .*give Membrane, Cable, Mast or Rope"):
        STRUCTURE.parts_of(kind)


def test_properties_of_parts():
    assert {name: part.dimension for name, part in PARTS.items()} == {"fabric": 2, "edge": 1, "mast": 1, "stay": 1}
    assert [name for name, part in PARTS.items() if part.is_strut] == ["mast"]
    assert [name for name, part in PARTS.items() if part.carries_compression] == ["mast", "stay"]
    assert PARTS["mast"].compression_stiffness == 1


def test_results_of_all_kinds_answer_alike():
    parts = Analysis(STRUCTURE).run([Stage("rest")])["rest"].parts
    assert {name: (part.dimension, part.principal.shape) for name, part in parts.items()} == {
        "fabric": (2, (2, 2)), "edge": (1, (1, 1)), "mast": (1, (1, 1)), "stay": (1, (1, 1)),
    }  # fmt: skip
    assert parts["mast"].principal[0, 0] == pytest.approx(-3.0, rel=1e-12)
    for part in parts.values():
        assert part.taut.all()
        assert not part.slack.any()
        assert part.taut.dtype == part.slack.dtype == bool


def test_states_of_membrane_cells():
    """Wrinkled cells are neither taut nor slack."""
    result = Analysis(STRUCTURE).run([Stage("rest")])["rest"].membrane("fabric")
    object.__setattr__(result, "state", np.array(["wrinkled", "slack"]))
    assert result.taut.tolist() == [False, False]
    assert result.slack.tolist() == [False, True]
