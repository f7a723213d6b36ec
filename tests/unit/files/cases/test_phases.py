"""Faults of all phases of a check come together: syntax, schema, units, names, and the model itself."""

import re

import pytest

from roof_case import ROOF, changed

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from fx_membrane.files.cases.case import read_case
from fx_membrane.files.cases.faults import CaseError


def faults(folder, *changes, text=ROOF):
    """Faults of a changed case as (line, key, words)."""
    (folder / "roof.toml").write_text(changed(text, *changes, count=1), encoding="utf-8")
    with pytest.raises(CaseError) as caught:
        read_case(folder / "roof.toml")
    found = [re.fullmatch(r".*roof\.toml:(\d+): ([^:]+): (.*)", line, re.DOTALL) for line in caught.value.lines]
    assert all(found)
    return [(int(line[1]), line[2], line[3]) for line in found]


def test_faults_of_schema_units_names_and_model_come_together(tmp_path):
    found = faults(
        tmp_path,
        ("increments = 2", "increments = 2.5"),  # schema
        ('pressure = "-100 Pa"', 'pressure = "-100 N"'),  # unit
        ('\n  part = "roof"\n  load = [0, 0, "-0.6', '\n  part = "rof"\n  load = [0, 0, "-0.6'),  # name
        ("nodes = [20, 24]", "nodes = [20, 99]"),  # model
        ("rtol = 1e-11", "rtol = -1"),  # solver
        ('components = "z"', 'components = "q"'),
    )
    assert [key for _, key, _ in found] == [
        "supports.0.components", "supports.2.nodes.1", "solver.rtol", "stages.1.increments", "stages.1.loads.0.part",
        "stages.1.loads.1.pressure",
    ]  # fmt: skip
    assert [line for line, *_ in found] == sorted(line for line, *_ in found)


def test_what_depends_on_a_fault_is_not_told(tmp_path):
    """A part of a faulty material, the loads on it, its edges and its rim are not called unknown."""
    found = faults(tmp_path, ("nu = 0.3", "nu = 3"))
    assert [key for _, key, _ in found] == ["materials.pvc.nu"]
    found = faults(tmp_path, ('Et = "500 kN/m"', 'Et = "500 kN"'))
    assert [key for _, key, _ in found] == ["materials.pvc.Et"]
    found = faults(tmp_path, ('group = "grid"', 'group = "grit"'))
    assert [key for _, key, _ in found] == ["parts.roof.group"]
    found = faults(tmp_path, ("columns = 4", "columns = 0"))
    assert [key for _, key, _ in found] == ["geometry.columns"]
    found = faults(tmp_path, ('kind = "cable"', 'kind = "cabel"'))
    assert [key for _, key, _ in found] == ['parts."edge, left".kind']


def test_names_are_checked_without_a_geometry(tmp_path):
    found = faults(
        tmp_path,
        ("columns = 4", "columns = 0"),
        ('material = "pvc"', 'material = "pcv"'),
        ('after = "lift"', 'after = "lif"'),
        ('part = "roof"\n  pressure', 'part = "rof"\n  pressure'),
        ("rtol = 1e-11", "rtol = -1"),
    )
    assert [key for _, key, _ in found] == [
        "geometry.columns",
        "parts.roof.material",
        "solver.rtol",
        "stages.1.after",
        "stages.1.loads.1.part",
    ]


def test_lines_that_are_no_toml_are_told_with_the_faults_of_the_others(tmp_path):
    found = faults(tmp_path, ("nu = 0.3", "nu 0.3"), ('width = "4 m"', 'width = "4 kg"'), ("rows = 4", "rows = four"))
    assert [(line, key) for line, key, _ in found] == [(10, "file"), (15, "file"), (7, "geometry.width")]


def test_texts_with_units_have_no_fault_where_the_line_of_the_units_cannot_be_read(tmp_path):
    found = faults(tmp_path, ('units = { force = "kN", length = "m" }', 'units = { force = "kN", length = "m"'))
    assert [(line, key) for line, key, _ in found] == [(3, "file")]


def test_a_line_in_the_middle_of_a_list_is_one_fault(tmp_path):
    text = "format = 1\nx = [\n 1,\n two,\n 3,\n]\n"
    assert [(line, key) for line, key, _ in faults(tmp_path, text=text)][:1] == [(4, "file")]
    lost = faults(tmp_path, ("[parts.roof]", "[parts.roof"))
    assert [key for _, key, _ in lost] == ["file"]


def test_inline_table_over_several_lines_is_one_fault(tmp_path):
    """Its lines looked like keys of the table around, and its bracket like a fault of its own."""
    wrapped = 'where = {\n  x = [-2, "200 cm"],  # }\n  y = "-2 m"\n}'
    found = faults(
        tmp_path, ('where = { x = [-2, "200 cm"], y = "-2 m" }', wrapped), ("increments = 2", "increments = 2.5")
    )
    assert [(line, key) for line, key, _ in found] == [(36, "file"), (55, "stages.1.increments")]


def test_form_finding_may_be_a_table_or_a_list(tmp_path):
    for head in ("[form_finding]", "[[form_finding]]"):
        wrong = f'{head}\nmethod = "projected stress"\ntolerance = "1 m"\n\n[solver]'
        ((_, key, words),) = faults(tmp_path, ("[solver]", wrong))
        assert key == ("form_finding.tolerance" if head == "[form_finding]" else "form_finding.0.tolerance")
        assert "no unit" in words


def test_head_of_a_table_without_its_bracket_is_told_beside_the_faults_below_it(tmp_path):
    heads = [("[materials.pvc]", "[materials.pvc"), ("[[supports]]", "[[supports")]
    found = faults(tmp_path, *heads, ("500 kN/m", "500 kN"))
    assert [key for _, key, _ in found] == ["file", "file", "materials.pvc.Et"]


def test_lists_of_a_wrong_length_are_told_by_their_key(tmp_path):
    short = ('load = [0, 0, "-0.6 kN/m2"]', "load = [0, 0]")
    found = faults(tmp_path, short, ("load = [0.01, 0, 0]", "load = [1, 2, 3, 4]"))
    assert [entry[1:] for entry in found] == [
        ("stages.1.loads.0.load", "the list has 2 values; give 3"),
        ("stages.1.loads.3.load", "[1, 2, 3, 4]: give 3 values, not 4"),
    ]
    told = {key: words for _, key, words in faults(tmp_path, ('group = "grid"', "cells = [[0]]"))}
    assert told["parts.roof.cells"].endswith(" in rows of 3, one row at least, not lists in lists, of lengths 1, 1.")
