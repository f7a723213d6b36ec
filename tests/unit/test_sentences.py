"""Sentences of the sources: at most 20 words, a noun or a verb first, no 'such' for a thing that has a name."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

import pytest

pytestmark = pytest.mark.text
ROOT = Path(__file__).parents[2]
SOURCES = [
    path
    for folder in ("forms", "fx_membrane", "demos", "tests")
    for path in sorted((ROOT / folder).rglob("*.py"))
    if "fx_membrane/forms" not in path.as_posix() and path.parent.name != "verification"  # forms/ again; formulas
]
TEXTS = [ROOT / "README.md", *sorted((ROOT / ".ci/site").rglob("*.md"))]
MOST = 20
WORD = re.compile(r"""["'(\[]*(a|I|[A-Za-z][A-Za-z'-]+)["')\]]*[.,;:!?]*["')\]]*""")
END = re.compile(r"(?<=[.!?:;])[\"')\]]*\s+")
REFERENCE = re.compile(r"\b(1[89]|20)\d\d\b")
SECTION = re.compile(r"(Args|Returns|Raises|Attributes|Yields|Warns):$")
TOKEN = re.compile(r"""(\"{3}|'{3})(?:\\.|.)*?\1|"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|#[^\n]*""", re.DOTALL)
ENTRY = re.compile(r"[*\w., ]+: (?=[A-Z])")


def sentences(text: str) -> Iterator[str]:
    """Sentences of a text; colons and semicolons end them, too. References, with a year, are none."""
    for found in END.split(re.sub(r"\b(e\.g|i\.e|ch|vol|no|al)\.", r"\1", text)):
        if found and not REFERENCE.search(found):
            yield found


def words(sentence: str) -> int:
    """Count words; code, symbols and numbers are none."""
    plain = re.sub(r"`[^`]*`", "7", sentence)
    return sum(WORD.fullmatch(word) is not None for word in plain.split())


def paragraphs(doc: str) -> Iterator[str]:
    """Paragraphs and entries of a docstring, without code, tables and sources."""
    lines: list[str] = []
    skipped: int | None = None
    first = 0
    for line in [*doc.split("\n"), ""]:
        text, indent = line.strip(), len(line) - len(line.lstrip())
        if skipped is not None and (not text or indent > skipped):
            continue
        skipped = indent if re.match(r"(Examples?|Sources?):", text) else None
        starts = (bool(ENTRY.match(text)) and 4 <= indent <= first) or text.startswith("- ") or indent < first
        if not text or starts or skipped is not None or SECTION.match(text) or re.search(r"\S {3,}\S", text):
            yield " ".join(lines)
            lines = []
        if text and skipped is None and not SECTION.match(text) and not re.search(r"\S {3,}\S", text):
            first = first if lines else indent
            lines.append(text)


def documented(tree: ast.AST) -> Iterator[ast.Constant]:
    """Docstrings of a module, its classes and functions."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and ast.get_docstring(node) is not None:
            assert isinstance(node.body[0], ast.Expr)
            assert isinstance(node.body[0].value, ast.Constant)
            yield node.body[0].value


def comments(source: str) -> Iterator[str]:
    """Comments, those on consecutive lines as one."""
    text, end = "", -1  # end of the last comment that has a line of its own
    for found in TOKEN.finditer(source):
        if not found[0].startswith("#"):
            continue
        body, begin = found[0].lstrip("# %"), source.rfind("\n", 0, found.start()) + 1
        alone = not source[begin : found.start()].strip()
        if alone and begin == end + 1 and body and not body.startswith(("- ", "[markdown]")):
            text += f" {body}"
        else:
            yield text
            text = body
        end = found.end() if alone else -1
    yield text


def messages(tree: ast.AST) -> Iterator[str]:
    """Texts in code that are no docstrings, with 7 for the values in them."""
    inner = {id(value) for node in ast.walk(tree) if isinstance(node, ast.JoinedStr) for value in node.values}
    inner |= {id(doc) for doc in documented(tree)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(value.value) if isinstance(value, ast.Constant) else "7" for value in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inner:
            yield "" if "\n" in node.value else node.value  # files, as templates, are none


def prose(path: Path) -> Iterator[str]:
    """Paragraphs and entries of a text in Markdown, without code and tables."""
    is_code, lines = False, list[str]()
    for line in [*path.read_text().split("\n"), ""]:
        text = line.strip()
        is_code ^= text.startswith("```")
        ends = not text or text.startswith(("```", "|", "#")) or (line.startswith("    ") and not lines)
        if ends or is_code or re.match(r"- |\d+\. ", text):
            yield " ".join(lines)
            lines = []
        if not ends and not is_code:
            lines.append(text)


class Source(NamedTuple):
    """Comments, docstrings and messages of a module."""

    comments: list[str]
    docs: list[ast.Constant]
    messages: list[str]


@cache
def source(path: Path) -> Source:
    """Read a module once: several tests ask about it."""
    text = path.read_text()
    tree = ast.parse(text)
    told = [] if "tests" in path.relative_to(ROOT).parts else list(messages(tree))
    return Source(list(comments(text)), list(documented(tree)), told)


def texts(path: Path) -> Iterator[str]:
    """Texts of a file that a reader reads."""
    if path.suffix == ".md":
        yield from prose(path)
        return
    found = source(path)
    yield from found.comments
    for doc in found.docs:
        yield from paragraphs(ast.get_docstring(ast.Module([ast.Expr(doc)], [])) or "")
    yield from found.messages


@pytest.mark.parametrize("paths", [SOURCES, TEXTS], ids=["sources", "texts"])
def test_sentences_have_20_words_at_most(paths):
    long = [
        f"{path.relative_to(ROOT)}: {sentence}"
        for path in paths
        for text in texts(path)
        for sentence in sentences(text)
        if words(sentence) > MOST
    ]
    assert not long


def test_texts_begin_with_a_noun_or_a_verb():
    riddles = [
        f"{path.relative_to(ROOT)}: {text}"
        for path in SOURCES
        for text in [*source(path).comments, *(str(doc.value) for doc in source(path).docs)]
        if re.match(r"\s*(What|Whether|Which|Why)\b(?!.*\?)", text)
    ]
    assert not riddles


def test_things_have_their_names():
    vague = [
        f"{path.relative_to(ROOT)}: {text}"
        for path in [*SOURCES, *TEXTS]
        if "tests" not in path.relative_to(ROOT).parts
        for text in texts(path)
        if re.search(r"\b[Ss]uch\b(?! as)|\ball the same\b", text)
    ]
    assert not vague


def test_long_sentences_are_seen():
    long = "one two three four five six seven eight nine ten " * 2
    assert words(f"{long}more.") == MOST + 1
    assert [words(found) for found in sentences(f"{long}: more. And `code that is long` 3e-4 x + y.")] == [20, 1, 1]
    doc = f"First.\n\nArgs:\n    x: {long}\n        and more.\n    y: Other.\n\nSource:\n    {long} {long}\n"
    assert [words(text) for text in paragraphs(doc) if text] == [1, 22, 1]
