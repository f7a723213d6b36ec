"""Data that were checked cannot be changed in place: dictionaries and arrays of structures, actions and results."""

import copy
import pickle

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Chamber, PointLoad, Stage, Structure, Support, polyline
from fx_membrane.checks.read_only_data import ReadOnlyDict, read_only

ENTRIES = ReadOnlyDict(a=1, b=2)


@pytest.mark.parametrize(
    "change",
    [
        lambda entries: entries.__setitem__("a", 3),
        lambda entries: entries.__delitem__("a"),
        lambda entries: entries.update(a=3),
        lambda entries: entries.setdefault("c", 3),
        lambda entries: entries.__ior__({"a": 3}),
        lambda entries: entries.pop("a"),
        lambda entries: entries.popitem(),
        lambda entries: entries.clear(),
    ],
)
def test_entries_stay_and_the_remedy_is_named(change):
    with pytest.raises(TypeError, match=r"\['a', 'b'\].*read-only.*dataclasses.replace"):
        change(ENTRIES)
    assert ENTRIES == {"a": 1, "b": 2}


def test_copies_and_unions():
    assert pickle.loads(pickle.dumps(ENTRIES)) == copy.deepcopy(ENTRIES) == ENTRIES
    more = ENTRIES | {"c": 3}
    more["d"] = 4
    assert list(more) == ["a", "b", "c", "d"]


def test_array_is_a_view_and_the_one_given_stays_writable():
    given = np.zeros(2)
    with pytest.raises(ValueError, match="read-only"):
        read_only(given)[0] = 1
    given[0] = 1
    assert read_only(None) is None


def test_structure_actions_and_state():
    rope = Structure(
        [[0, 0, 0], [1, 0, 0], [2, 0, 0]], {"rope": Cable(polyline([0, 1, 2]), 1e6, 1e3)}, [Support([0, 2])]
    )
    state = Analysis(rope, progress=False).run([Stage("pull", [PointLoad(1, (0, 0, -10.0))])])["pull"]
    for entries in (rope.parts, rope.chambers, Chamber({"top": 1}).parts, state.actions.pressures):
        with pytest.raises(TypeError, match="read-only"):
            entries["rope"] = Cable([[0, 99]], 1e6)
    assert isinstance(rope.separate, tuple)
    arrays = (state.displacement, state.loads, state.reactions, state.actions.loads, state.actions.held)
    assert not any(array.flags.writeable for array in arrays)
