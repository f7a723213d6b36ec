"""Case files of the demos beside their scripts."""

import importlib.util
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np

import fx_membrane
from fx_membrane import Analysis

CASES = Path(fx_membrane.__file__).parent / "files" / "demos"


def has_cases():
    """Tell whether the packages that read case files are there; the pydantic of Debian 12 is too old."""
    try:
        return int(version("pydantic").split(".")[0]) > 1 and importlib.util.find_spec("pint") is not None
    except PackageNotFoundError:
        return False


def check_case(name, expected):
    """Check that the case file of a demo gives the numbers of its script, to 1e-12 of the largest of their kind.

    Forces to 1e-10: places are rounded by 1e-16 of 12 m; over chords of 0.08 m of a ring, with EA 2e5 kN beside 40 kN,
    that is 1e-10.
    """
    from fx_membrane.files.cases.case import read_case  # noqa: PLC0415  (optional packages)

    case = read_case(CASES / f"{name}.toml")
    form = case.form()
    structure = form.structure if form else case.structure
    found = Analysis(structure, case.solver, limit=case.work, progress=False).run(case.stages_of(structure))
    assert list(found) == list(expected)
    for stage, state in expected.items():
        near(found[stage].structure.points, state.structure.points)
        near(found[stage].displacement, state.displacement)
        near(found[stage].reactions, state.reactions)
        for dimension in (1, 2):
            parts = [part for part, entry in state.parts.items() if entry.dimension == dimension]
            if parts:
                forces, wanted = (
                    np.concatenate([side.parts[part].principal for part in parts]) for side in (found[stage], state)
                )
                near(forces, wanted, 1e-10)


def near(found, expected, share=1e-12):
    """Check to a share of the largest; what is all but zero, as displacements at rest, by its own size."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=share * np.abs(expected).max(initial=0.0))
