"""Faults of form finding and of materials in case files have their line, key and remedy."""

import pytest

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")
from sail_cases import TENT, refused

pytestmark = pytest.mark.filterwarnings("ignore:The form is in equilibrium")


def test_constraints_are_refused_where_the_method_takes_none(tmp_path):
    text = """
        [form_finding]
        method = "force density"
        net = [{ part = "edge", density = 1 }]
        constraints = [{ kind = "ring", nodes = [6, 8, 16, 18] }]
    """
    (line,) = refused(tmp_path, text)
    assert "form_finding.constraints: method 'force density' takes no constraints" in line
    assert "projected stress" in line


@pytest.mark.parametrize(
    ("text", "key", "words"),
    [
        ('method = "projected stres"', "form_finding.method", "'projected stress' may be meant"),
        ('method = "projected stress"\ntolerance = -1', "form_finding.tolerance", "tolerance"),
        ('method = "natural force density"\niterations = 0', "form_finding.iterations", "iterations"),
        ('method = "updated reference"\nsteps = 3', "form_finding.steps", "no key of that name"),
        ('method = "force density"', "form_finding.net", "missing"),
        ('method = "force density"\nnet = []', "form_finding.net", "it is empty"),
        ('method = "force density"\nnet = [{ part = "film", density = 1 }]', "form_finding.net.0.part", "no cable"),
        (
            'method = "force density"\nnet = [{ part = "edge", density = [1] }]',
            "form_finding.net.0.density",
            "16 branches",
        ),
        ('method = "masts and stays"\nbars = {}', "form_finding.method", "before them"),
        ('method = "projected stress"\nstress.film.terms = []', "form_finding.stress.film.terms", "terms is empty"),
        (
            'method = "projected stress"\nstress.edge.terms = [{ values = 1, at = 1, power = 0 }]',
            "form_finding.stress.edge",
            "no membrane",
        ),
        (
            'method = "projected stress"\nconstraints = [{ kind = "ring", nodes = [1, 2] }]',
            "form_finding.constraints.0.nodes",
            "at least three",
        ),
        (
            'method = "projected stress"\nconstraints = [{ kind = "cable sag", part = "film", sag = 1 }]',
            "form_finding.constraints.0.part",
            "no cable",
        ),
        (
            'method = "projected stress"\nconstraints = [{ kind = "cable sag", part = "egde", sag = 1 }]',
            "form_finding.constraints.0.part",
            "'edge' may be meant",
        ),
    ],
)
def test_faults_of_form_finding_have_line_and_key(text, key, words, tmp_path):
    (line,) = refused(tmp_path, f"[form_finding]\n{text}\n")
    assert f": {key}: " in line
    assert words in line


@pytest.mark.parametrize(
    ("material", "words"),
    [
        ('{ kind = "fabric", nu = 0.3 }', "give Et, or E and thickness"),
        ('{ kind = "fabric", nu = 0.3, Et = 500, E = 1e6 }', "give Et, or E and thickness, not E and Et"),
        ('{ kind = "mooney-rivlin", C10 = 1, C01 = 1 }', "or C10, C01 and thickness"),
    ],
)
def test_numbers_of_materials_are_whole(material, words, tmp_path):
    head = TENT.replace('{ kind = "fabric", Et = 500, nu = 0.3 }', material)
    (line,) = refused(tmp_path, "", head)
    assert "materials.pvc: " in line
    assert words in line
