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
    """Paths of all keys, and of two rows of each list, whose others are alike."""
    items = data.items() if isinstance(data, dict) else enumerate(data[:2]) if isinstance(data, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from leaves(value, (*path, key))


def toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)} = {toml(entry)}" for key, entry in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def broken(draw, data, places):
    """Case with wrong places: removed, renamed, or with another value."""
    data = copy.deepcopy(data)
    for path in places:
        spoil(draw, data, path or draw.choice(list(leaves(data))))
    return "".join(f"{json.dumps(key)} = {toml(entry)}\n" for key, entry in data.items())


def spoil(draw, data, path):
    """Make one place wrong."""
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


@pytest.mark.study
@pytest.mark.parametrize("several", [False, True], ids=["each place", "five places"])
@pytest.mark.parametrize("text", [roof_case.ROOF, tent_case.TENT], ids=["roof", "tent"])
def test_broken_files_are_told_in_sentences(text, several, tmp_path):
    data, draw = tomllib.loads(text), random.Random(1)
    told, lines = 0, list[str]()
    cases = [[None] * 5] * 60 if several else [[path] for path in leaves(data)]
    for places in cases:
        (tmp_path / "a.toml").write_text(broken(draw, data, places), encoding="utf-8")
        try:
            read_case(tmp_path / "a.toml")
        except CaseError as error:
            told += 1
            lines += error.lines
    assert told > (0.7 if several else 0.5) * len(cases)  # the others lack what may be left out
    assert [line for line in lines if not re.fullmatch(r".*a\.toml:\d+: [^:]+: .{8,}", line, re.DOTALL)] == []
    assert [
        line
        for line in lines
        if re.search(r"pydantic|Traceback|object at 0x|\bbool\(|NoneType|shape \(|WorkLimit|\bA [A-Z][a-z]+\b", line)
    ] == []


WORDS = (  # of TOML, in the place of a value
    *("nan", "-inf", "1e999", "9" * 40, "-0.0", "0x1F", "1979-05-27", "07:32:00", "true", '"nan kN/m"', '"1e999 m"'),
    *(
        '"3 mm/m"',
        '"\u22123 kN"',
        '"½ m"',
        '"\uff11\uff12 kN"',
        '"3\u00a0m"',
        '"3 kN\u200b"',
        '"12 kN/m kN"',
        '"5 m + 2 ft"',
        '"3°"',
    ),
    *(
        '"../../etc/passwd"',
        '"/dev/zero.obj"',
        '"~/a.obj"',
        '"a/\\u0000.obj"',
        '"' + "a" * 5000 + '.obj"',
        '"."',
        '"/"',
    ),
    *("[[[[1]]]]", "{ a = { b = { c = 1 } } }", "[1, [2], 3]", '["a", 1, 0.5, true]', "[nan, nan, nan]", '"""\n\n"""'),
    *("'\\U0001F600'", '"\\u001b[31m"', '"\u202e"', "[]", "{}", "1_000_000_000", "1e300", "5e-324"),
)


KEYS = ("größe", "''", '"a.b"', '"\\u0007"', "_", "\uff11", "x y", ".")


def spoiled_texts(draw, text):
    """Cases with each of the words and keys, and with lines that are doubled, moved, or under another table."""
    valued = [number for number, row in enumerate(text.splitlines()) if re.match(r"\s*\w+ = ", row)]
    for word in [*WORDS, *KEYS, *["moved", "deeper"] * 10]:
        rows = text.splitlines()
        number = draw.choice(valued)
        head, value = rows[number].split(" = ", 1)
        if word == "moved":
            rows.insert(draw.randrange(len(rows)), rows[number])
        elif word == "deeper":
            rows[number] = f"{head}.{draw.choice(['x', head.strip(), 'kind'])} = {value}"
        elif word in KEYS:
            rows[number] = f"{word} = {value}"
        else:
            rows[number] = f"{head} = {word}"
        ends = draw.choice(["\n", "\r\n"])
        yield draw.choice(["", "\ufeff"]) + ends.join(rows) + ends


@pytest.mark.study
@pytest.mark.parametrize("text", [roof_case.ROOF, tent_case.TENT], ids=["roof", "tent"])
def test_strange_values_keys_and_lines_are_told_in_sentences(text, tmp_path):
    told, lines = 0, list[str]()
    contents = list(spoiled_texts(random.Random(0), text))
    for content in contents:
        (tmp_path / "a.toml").write_bytes(content.encode())
        try:
            read_case(tmp_path / "a.toml")
        except CaseError as error:
            told += 1
            lines += error.lines
    assert told > 2 / 3 * len(contents)
    assert [line for line in lines if not re.fullmatch(r".*a\.toml:\d+: [^:]+: .{8,}", line, re.DOTALL)] == []
    shown = r"pydantic|Traceback|object at 0x|\bbool\(|NoneType|shape \(|datetime\.|tomllib|numpy|\ba (str|dict)\b"
    assert [line for line in lines if re.search(shown, line)] == []


@pytest.mark.parametrize("text", [roof_case.ROOF, tent_case.TENT], ids=["roof", "tent"])
def test_ends_of_lines_and_a_mark_of_their_order_change_nothing(text, tmp_path):
    lines = list[tuple[str, ...]]()
    for start, end in (("", "\n"), ("\ufeff", "\r\n")):
        content = start + text.replace("nu = 0.3", "nu = 3").replace("\n", end)
        (tmp_path / "a.toml").write_bytes(content.encode())
        with pytest.raises(CaseError) as caught:
            read_case(tmp_path / "a.toml")
        lines.append(caught.value.lines)
    assert lines[0] == lines[1]


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
