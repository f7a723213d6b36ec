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


def check_case(name, expected, folder=CASES):
    """Check the numbers of the case file of a demo against its script, to 1e-12 of the largest of their kind.

    One process makes equal structures, bit by bit. Several add up in the order of their messages: two runs of the cone
    differ by 9e-13 of the largest force under wind, in the chords of its ring. These change by 5e-13 of it with the
    last bit of a displacement. So several have 4 such bits besides.
    """
    from fx_membrane.files.cases.case import read_case  # noqa: PLC0415  (optional packages)

    case = read_case(folder / f"{name}.toml")
    form = case.form()
    structure = form.structure if form else case.structure
    found = Analysis(structure, case.solver, limit=case.work, progress=False).run(case.stages_of(structure))
    assert list(found) == list(expected)
    exact = tuple(map(int, version("pint").split(".")[:2])) >= (0, 25)  # older ones round 30000 ksi in kip/in2
    if MPI.COMM_WORLD.size == 1 and exact:
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
                near(forces, wanted, last_bits(state) if dimension == 1 else 0.0)


def check_pattern(name, expected):
    """Check the cloth of the cutting pattern in the case file of a demo against that of a script, to 1e-12."""
    from fx_membrane.files.cases.case import read_case  # noqa: PLC0415  (optional packages)

    case = read_case(CASES / f"{name}.toml")
    found = case.patterns.pattern(case.form())
    assert list(found.cloth) == list(expected.cloth)
    for strip, cloth in expected.cloth.items():
        np.testing.assert_array_equal(found.cloth[strip].triangles, cloth.triangles)
        near(found.cloth[strip].points, cloth.points)
        near(found.compensation[strip], expected.compensation[strip])


def near(found, expected, spare=0.0):
    """Check to 1e-12 of the largest, and a spare besides."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12 * np.abs(expected).max(initial=0.0) + spare)


def last_bits(state):
    """Force of the stiffest bar with 4 last bits of the largest displacement, on several processes."""
    if MPI.COMM_WORLD.size == 1:
        return 0.0
    bits, points = 4 * np.spacing(state.largest_displacement), state.structure.points
    return max(
        float(part.axial_stiffness * bits / np.linalg.norm(np.diff(points[part.cells], axis=1), axis=2).min())
        for part in state.structure.parts.values()
        if hasattr(part, "axial_stiffness")
    )
