"""Types that a user's checker sees: lists are taken where they work, and arrays come out."""

import runpy
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
SCRIPT = Path(__file__).with_name("typed_script.py")


WRONG = """
from fx_membrane import Cable, Fabric, Membrane, Structure
cable = Cable({0: 1}, 1e6)
membrane = Membrane([[0, 1, 2]], 'soft')
reveal_type(membrane.cells)
Structure([[0, 0, 0]], [membrane])
"""


def test_lists_pass_a_strict_check_and_wrong_values_do_not(tmp_path):
    pytest.importorskip("mypy")
    script, wrong = tmp_path / SCRIPT.name, tmp_path / "typed_wrong.py"
    script.write_text(SCRIPT.read_text())  # outside of tests/, where the settings are lenient
    wrong.write_text(WRONG)
    command = [sys.executable, "-m", "mypy", str(script), str(wrong)]  # with the cache of `make lint`
    found = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT).stdout
    assert SCRIPT.name not in found
    assert 'Argument 1 to "Cable" has incompatible type' in found
    assert 'Argument 2 to "Membrane" has incompatible type "str"' in found
    assert 'Argument 2 to "Structure" has incompatible type' in found
    assert "typed_wrong.py:5: note: Revealed type is" in found
    assert "ndarray[" in found
    assert "in 1 file (checked 2 source files)" in found


def test_script_runs():
    runpy.run_path(str(SCRIPT), run_name="__main__")
