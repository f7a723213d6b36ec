"""Sentences on results speak to readers who have only files: none asks for a call of Python."""

import ast
import re
from pathlib import Path

import pytest

import fx_membrane
from fx_membrane.results.reader_words import for_readers

PACKAGE = Path(fx_membrane.__file__).parent
TOLD = ["results/remarks.py", "results/balance.py", "results/state_checks.py", "results/strain_limits.py"]
TOLD += ["results/limits.py", "solvers/diagnosis.py", "analysis/reasons.py"]
PYTHON = re.compile(r"\bplot\.|\w\((?:\w+(?:=\.\.\.)?)?\)|`|equilibrium_path|\bWorkLimit\b|updated_reference")


def sentences(file):
    """Texts of a module that users may read, with a word in the place of what is filled in."""
    for statement in ast.walk(ast.parse((PACKAGE / file).read_text())):
        if isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant):
            statement.value.value = ""  # a docstring
        if isinstance(statement, ast.JoinedStr):
            pieces = [part.value if isinstance(part, ast.Constant) else "Newton" for part in statement.values]
            yield "".join(pieces)
        elif isinstance(statement, ast.Constant) and isinstance(statement.value, str) and " " in statement.value:
            yield statement.value


@pytest.mark.parametrize("file", TOLD)
def test_no_sentence_asks_for_a_call(file):
    found = list(sentences(file))
    assert found
    told = {sentence: for_readers(sentence) for sentence in found}
    assert not {given: words for given, words in told.items() if PYTHON.search(words)}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("not stable; stability(state) shows how it gives way. Add", "not stable. Add"),
        (
            "allow more iterations (Newton(max_iterations=...)), or",
            "allow more iterations (max_iterations of the solver), or",
        ),
        ("a smaller tolerance, as Newton(rtol=...); check", "a smaller tolerance (rtol of the solver); check"),
        ("Newton() may get closer.", "the solver Newton may get closer."),
        ("node 5 at (1, 0, 2) of 'roof (old)'", "node 5 at (1, 0, 2) of 'roof (old)'"),
    ],
)
def test_words_for_readers(given, words):
    assert for_readers(given) == words
