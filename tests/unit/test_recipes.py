"""Recipes of README and of docstrings, as a reader types them: in a process of their own; and the places they name."""

import ast
import doctest
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import fx_membrane

ROOT = Path(__file__).parents[2]
RECIPES = dict(
    re.findall(
        r"### (A[^\n]*)\n(.*?)(?=\n###? )", (ROOT / "README.md").read_text().split("## How to add")[1], re.DOTALL
    )
)
SHEET = """
import numpy as np
from fx_membrane import *
points, triangles = rectangle(2.0, 2.0, 4, 4)
edges = boundary_edges(triangles)
def solve(material=Fabric(1e5, 0.3), loads=(), terms=()):
    parts = {"fabric": Membrane(triangles, material, 1e3), "edge": Cable(edges, 1e6)}
    structure = Structure(points, parts, [Support(np.unique(edges))], terms=terms)
    snow = DistributedLoad((0, 0, -50.0), "fabric")
    return Analysis(structure, progress=False).run([Stage("bed", [*loads, snow])])["bed"].largest_displacement
"""


def code(text):
    """First block of indented lines of a text that begins with an import."""
    lines = text.split("\n")
    first = next(number for number, line in enumerate(lines) if re.match(r" +from \S+ import", line))
    depth = len(lines[first]) - len(lines[first].lstrip())
    block = []
    for line in lines[first:]:
        if line.strip() and len(line) - len(line.lstrip()) < depth:
            break
        block.append(line)
    return textwrap.dedent("\n".join(block))


def defined(public):
    """Return imports and class of an example in a docstring, without the last line, which uses them."""
    examples = doctest.DocTestParser().get_examples(public.__doc__)
    return "".join(example.source for example in examples[:-1])


def test_names_of_the_recipes():
    assert list(RECIPES) == ["A law", "A load", "An element", "A result", "A file format"]


def test_code_runs_as_typed():
    """In one process, whose names each recipe finds as a reader does: none of those before it."""
    uses = [
        (code(RECIPES["A law"]), "Membrane(triangles, Foil(4e5))\nassert 0 < solve(Foil(4e5)) < 0.1"),
        (
            code(RECIPES["A load"]),
            'bed = ElasticBed("fabric", 2e3)\nassert solve(loads=[bed]) < 0.99 * free > solve(terms=[bed])',
        ),
        (defined(fx_membrane.Law), "Cable(edges, material=Stiffening(1e6, 1e8))"),
        (defined(fx_membrane.EnergyTerm), 'assert solve(terms=[ElasticBed("fabric", 2e3)]) < 0.99 * free'),
        (defined(fx_membrane.ForceTerm), 'assert solve(terms=[Water("fabric", 2e3, 0.2)]) != free'),
    ]
    scripts = [f"{typed}\n{SHEET}\n{use}" for typed, use in uses]
    in_turn = f"{SHEET}free = solve()\nfor script in {scripts!r}: exec(script, {{'free': free}})"
    done = subprocess.run([sys.executable, "-W", "error", "-c", in_turn], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_places_exist():
    """Files, and names that a recipe puts beside a file."""
    package = ROOT / "fx_membrane"
    for recipe in RECIPES.values():
        places = re.findall(r"`((?:[\w.]+/)+[\w.]*|[\w]+\.pyi?)`", recipe)
        assert places
        for place in places:
            assert any((base / place).exists() for base in (package, ROOT)), place


@pytest.mark.parametrize(
    "file", ["model/foils.py", "model/loads.py", "model/bars.py", "results/part_results.py", "results/evaluation.py"]
)
def test_files_that_take_a_class_have_room(file):
    """A class of thirty lines, below the limit of `test_sizes`."""
    assert any(file in recipe for recipe in RECIPES.values())
    assert len((ROOT / "fx_membrane" / file).read_text().splitlines()) < 260


def test_right_arguments_have_room():
    intro = (ROOT / "README.md").read_text().split("## How to add")[1].split("###")[0]
    (file,) = re.findall(r"`(tests/\S+[.]py)`", intro)
    assert len((ROOT / file).read_text().splitlines()) < 260


def assigned(file):
    tree = ast.parse((ROOT / "fx_membrane" / file).read_text())
    names = {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    for node in tree.body:
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
        names |= {target.id for target in targets if isinstance(target, ast.Name)}
    return names


@pytest.mark.parametrize(
    ("recipe", "name", "file"),
    [
        ("A law", "SHIPPED", "model/materials.py"),
        ("A load", "FormLoad", "model/loads.py"),
        ("A load", "OwnLoad", "model/loads.py"),
        ("A load", "SpreadLoad", "model/loads.py"),
        ("A load", "per_size", "model/loads.py"),
        ("A load", "check_load", "model/loads.py"),
        ("An element", "Part", "model/parts.py"),
        ("An element", "AxialPart", "model/bars.py"),
        ("An element", "Line", "model/parts.py"),
        ("An element", "part_forms", "assembly/forms_of_parts.py"),
        ("An element", "CELL", "_dolfinx.py"),
        ("A result", "MEMBRANE", "results/evaluation.py"),
        ("A result", "_of_membrane", "results/evaluation.py"),
        ("A result", "MembraneResult", "results/part_results.py"),
        ("A result", "quantities", "results/part_results.py"),
        ("A result", "FORMAT", "files/archive.py"),
        ("A result", "_remarks", "results/remarks.py"),
        ("A file format", "READERS", "files/mesh_files.py"),
        ("A file format", "Drawing", "files/drawing.py"),
        ("A file format", "check", "files/drawing.py"),
        ("A file format", "writing", "files/whole_file.py"),
        ("A file format", "by_the_first", "runtime/processes.py"),
    ],
)
def test_names_exist(recipe, name, file):
    assert re.search(rf"`[@\w.]*\b{name}\b`", RECIPES[recipe])
    assert name in assigned(file)
