"""Case files of the demos beside their scripts."""

import importlib.util
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import numpy as np
from mpi4py import MPI

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

    The structures are equal bit by bit where one process makes them; several add up in the order of their messages.
    """
    from fx_membrane.files.cases.case import read_case  # noqa: PLC0415  (optional packages)

    case = read_case(CASES / f"{name}.toml")
    form = case.form()
    structure = form.structure if form else case.structure
    found = Analysis(structure, case.solver, limit=case.work, progress=False).run(case.stages_of(structure))
    assert list(found) == list(expected)
    if MPI.COMM_WORLD.size == 1:
        assert structure == next(iter(expected.values())).structure
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
                near(forces, wanted)


def near(found, expected):
    """Check to 1e-12 of the largest."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max(initial=0.0))
