"""Programs with a decimal comma, such as those with Qt: same numbers, and the comma stays."""

import locale
import os
import shutil
import subprocess
import sys

import pytest

from fx_membrane.runtime.number_locale import decimal_point

SCRIPT = """
import locale

import numpy as np

from fx_membrane import *

points, triangles = rectangle(1.0, 1.0, 4, 4)
edges = edges_where(points, triangles, lambda x: np.isclose(x[0], 0.0))
parts = {"fabric": Membrane(triangles, Fabric(1e5, 0.3), 1e3, mass=1.5), "cable": Cable(edges, 1e6, 1e3)}
structure = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
for name in ("C", "de_DE.UTF-8"):
    locale.setlocale(locale.LC_ALL, name)
    snow = Analysis(structure).run([Stage("snow", [DistributedLoad((0, 0, -10.5), "fabric")])])["snow"]
    print(*snow.displacement.ravel(), *natural_frequencies(snow, 2).frequencies, stability(snow).negative)
    print(locale.localeconv()["decimal_point"])
"""


@pytest.fixture(scope="module")
def german(tmp_path_factory):
    """Environment with the German locale, installed or not."""
    folder = tmp_path_factory.mktemp("locales")
    if shutil.which("localedef"):
        make = ["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")]
        subprocess.run(make, capture_output=True, check=False)
    if not any(folder.iterdir()):
        pytest.skip("needs localedef and its sources, of Debian's package locales")
    environment = {**os.environ, "LOCPATH": str(folder)}
    ask = [sys.executable, "-c", 'import locale; locale.setlocale(locale.LC_ALL, "de_DE.UTF-8")']
    if subprocess.run(ask, env=environment, capture_output=True, check=False).returncode:
        pytest.skip("needs the sources of the German locale, of Debian's package locales")
    return environment


def test_same_numbers_with_a_decimal_comma(german):
    done = subprocess.run([sys.executable, "-c", SCRIPT], env=german, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    expected, point, found, comma = done.stdout.splitlines()
    assert (point, comma) == (".", ",")
    assert len(expected.split()) == 3 * 25 + 3
    assert found == expected


def test_locale_is_restored_after_an_error():
    before = locale.setlocale(locale.LC_NUMERIC)
    with pytest.raises(ZeroDivisionError), decimal_point():
        _ = 1 / 0
    assert locale.setlocale(locale.LC_NUMERIC) == before
