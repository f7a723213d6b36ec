"""Names of modules: none is that of a function or class in it, so that a path and a call read differently."""

import ast
from pathlib import Path

import pytest

pytestmark = pytest.mark.text
ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("folder", ["forms", "fx_membrane"])
def test_no_module_has_the_name_of_its_own_function(folder):
    defined = (ast.FunctionDef, ast.ClassDef)
    alike = [
        str(path.relative_to(ROOT))
        for path in sorted((ROOT / folder).rglob("*.py"))
        if any(isinstance(node, defined) and node.name == path.stem for node in ast.parse(path.read_text()).body)
    ]
    assert not alike
