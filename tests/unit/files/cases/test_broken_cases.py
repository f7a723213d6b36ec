"""Case files with wrong places, made by a generator: each is told in sentences with line and key."""

import copy
import json
import random
import re
import tomllib

import pytest

import roof_case
import tent_case

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError

pytestmark = pytest.mark.filterwarnings("ignore:overflow")  # of places beyond all sizes

VALUES = [None, -1, 0, 1e300, "", "text", "1,5 kN", "9**9**9 m", [], [[]], {}, {"a": 1}, True, [1, 2, 3], "nan", "5 kg"]


def leaves(data, path=()):
    """Paths of all keys and rows."""
    items = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from leaves(value, (*path, key))


def toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def broken(seed, text, count=1):
    """Case with wrong places: removed, renamed, or with another value."""
    draw = random.Random(seed)
    data = copy.deepcopy(tomllib.loads(text))
    for _ in range(count):
        spoil(draw, data)
    return "".join(f"{json.dumps(key)} = {toml(entry)}\n" for key, entry in data.items())


def spoil(draw, data):
    """Make one place wrong."""
    path = draw.choice(list(leaves(data)))
    table = data
    for key in path[:-1]:
        table = table[key]
    act = draw.randrange(3)
    value = draw.choice(VALUES)
    if act == 0 or value is None:
        del table[path[-1]]
    elif act == 1 and isinstance(table, dict):
        table[f"{path[-1]}x"] = table.pop(path[-1])
    else:
        table[path[-1]] = value


def test_the_case_with_all_tables_has_no_fault(tmp_path):
    (tmp_path / "a.toml").write_text(tent_case.TENT, encoding="utf-8")
    case = read_case(tmp_path / "a.toml")
    assert case.methods == ["force density", "projected stress", "masts and stays", "new mesh"]


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("text", [roof_case.ROOF, tent_case.TENT], ids=["roof", "tent"])
def test_broken_files_are_told_in_sentences(text, count, tmp_path):
    told, lines = 0, list[str]()
    for seed in range(300 if count == 1 else 100):
        (tmp_path / "a.toml").write_text(broken(seed, text, count), encoding="utf-8")
        try:
            read_case(tmp_path / "a.toml")
        except CaseError as error:
            told += 1
            lines += error.lines
    assert told > (150 if count == 1 else 70)  # the others lack what may be left out
    assert [line for line in lines if not re.fullmatch(r".*a\.toml:\d+: [^:]+: .{8,}", line, re.DOTALL)] == []
    assert [
        line
        for line in lines
        if re.search(r"pydantic|Traceback|object at 0x|\bbool\(|NoneType|shape \(|WorkLimit|\bA [A-Z][a-z]+\b", line)
    ] == []


def test_torn_files_are_told_in_sentences(tmp_path):
    """Files cut at any place, with a letter changed, or with two lines exchanged."""
    draw, lines = random.Random(7), list[str]()
    for text in (roof_case.ROOF, tent_case.TENT):
        for number in range(60):
            place = draw.randrange(len(text))
            rows = text.splitlines()
            row = draw.randrange(len(rows) - 1)
            rows[row : row + 2] = rows[row + 1], rows[row]
            torn = [text[:place], text[:place] + draw.choice('[]{}="#,x\0') + text[place + 1 :], "\n".join(rows)]
            (tmp_path / "a.toml").write_text(torn[number % 3], encoding="utf-8")
            try:
                read_case(tmp_path / "a.toml")
            except CaseError as error:
                lines += error.lines
    assert len(lines) > 60
    assert [line for line in lines if not re.fullmatch(r".*a\.toml:\d+: [^:]+: .{8,}", line, re.DOTALL)] == []
