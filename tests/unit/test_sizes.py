"""Sizes of the sources: a file is one subject, and a function one thought."""

import ast
from pathlib import Path

import pytest

pytestmark = pytest.mark.text
ROOT = Path(__file__).parents[2]
PATHS = [
    path
    for folder in ("forms", "fx_membrane", "demos", "tests")
    for path in sorted((ROOT / folder).rglob("*.py"))
    if "fx_membrane/forms" not in path.as_posix()  # forms/ again
]


def length(function):
    """Lines of a function, without its docstring."""
    lines = function.end_lineno - function.lineno + 1
    if ast.get_docstring(function) is not None:
        lines -= function.body[0].end_lineno - function.body[0].lineno + 1
    return lines


def test_files_are_below_300_lines():
    lines = {path.relative_to(ROOT).as_posix(): len(path.read_text().splitlines()) for path in PATHS}
    assert {name: count for name, count in lines.items() if count >= 300} == {}


def test_functions_are_below_50_lines():
    functions = [
        (f"{path.relative_to(ROOT)}:{node.lineno} {node.name}", length(node))
        for path in PATHS
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.FunctionDef)
    ]
    assert [(name, count) for name, count in functions if count >= 50] == []
