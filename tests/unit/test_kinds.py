"""Kinds of parts, laws and results of parts: asked for in one table of each; attributes and lists by kind elsewhere."""

import ast
from pathlib import Path
from typing import get_args

import pytest

from fx_membrane.model.loads import FormLoad
from fx_membrane.model.parts import Line

pytestmark = pytest.mark.text
ROOT = Path(__file__).parents[2] / "fx_membrane"
KINDS = {
    *("Part", "Membrane", "Bar", "Cable", "Mast", "Rope"),
    *("Law", "Fabric", "OrthotropicFabric", "NeoHooke", "MooneyRivlin", "Axial", "SHIPPED"),
    *("MembraneResult", "BarResult", "RopeResult"),
}
HOMES = {"axial_law", "bars", "fabrics", "foils", "laws", "materials", "part_results", "parts", "ropes"}
TABLES = {"assembly/relaxation.py", "model/materials.py", "model/structure.py"}  # the last for `Structure.membranes`
OTHERS = {  # of a law before there is a part, and of groups of cells in a mesh
    *("model/law_check.py", "model/laws.py", "files/dolfinx_mesh.py", "files/msh.py"),
}
WORDS = {"files/cases/parts.py", "files/cases/loads.py"}  # kinds by the words of case files


def imported(tree, home):
    """Names of kinds in a module: those that it defines or imports from their homes."""
    defined = {node.name for node in tree.body if isinstance(node, ast.ClassDef)} if home else set()
    taken = {
        alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[-1] in HOMES
        for alias in node.names
    }
    return KINDS & (defined | taken)


def questions(tree, kinds):
    """Lines that ask for a kind: by isinstance and issubclass, a comparison of types, or a pattern of a class."""

    def names(node):
        return {found.id for found in ast.walk(node) if isinstance(found, ast.Name)}

    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and names(node.func) & {"isinstance", "issubclass"}:
            asked = names(node.args[1])
        elif isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            asked = {name for side in sides if not isinstance(side, ast.Call) for name in names(side)}
        elif isinstance(node, ast.MatchClass):
            asked = names(node.cls)
        else:
            continue
        if asked & kinds:
            yield node.lineno


def dimensions(tree):
    """Lines that compare a dimension with a number, as a question for the kind of a part."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            words = [getattr(side, "attr", getattr(side, "id", "")) for side in sides]
            numbers = [side for side in sides if isinstance(side, ast.Constant) and isinstance(side.value, int)]
            if "dimension" in words and numbers:
                yield node.lineno


def test_kinds_are_asked_for_in_the_tables_only():
    found = []
    for path in sorted(ROOT.rglob("*.py")):
        tree, place = ast.parse(path.read_text()), path.relative_to(ROOT).as_posix()
        kinds = imported(tree, home=path.stem in HOMES)
        found += [f"{place}:{line}" for line in questions(tree, kinds) if place not in TABLES]
    assert not found


def test_questions_are_seen():
    text = """
from ..model.parts import Cable
isinstance(part, Cable | int)
type(part) is Cable
{type(part) for part in parts} == {Cable}
part == Cable([[0, 1]], 1.0)
"""
    tree = ast.parse(text)
    assert list(questions(tree, imported(tree, home=False))) == [3, 4, 5]


def test_dimensions_of_parts_are_not_asked_for():
    found = []
    for path in sorted(ROOT.rglob("*.py")):
        place = path.relative_to(ROOT).as_posix()
        if place not in OTHERS and not place.startswith("forms/"):
            found += [f"{place}:{line}" for line in dimensions(ast.parse(path.read_text()))]
    assert not found


def test_questions_for_dimensions_are_seen():
    text = """
part.dimension == 2
2 != part.dimension
dimension < 2
dimension == other.dimension
"""
    assert list(dimensions(ast.parse(text))) == [2, 3, 4]


def spelled(tree, members):
    """Lines that spell out all members of a union, instead of its name."""
    for node in ast.walk(tree):
        if isinstance(node, ast.BinOp | ast.Tuple | ast.Dict):
            names = {found.id for found in ast.walk(node) if isinstance(found, ast.Name)}
            if members <= names:
                yield node.lineno


@pytest.mark.parametrize(
    ("union", "home"), [(Line, "model/parts.py"), (FormLoad, "model/loads.py")], ids=["lines", "loads"]
)
def test_unions_go_by_their_names(union, home):
    """A new kind is named in its union alone."""
    members = {kind.__name__ for kind in get_args(union)}
    found = []
    for path in sorted(ROOT.rglob("*.py")):
        place = path.relative_to(ROOT).as_posix()
        if place != home and place not in WORDS:
            found += [f"{place}:{line}" for line in spelled(ast.parse(path.read_text()), members)]
    assert not found
