"""Programs without standard streams: closed by the shell or a service, or absent without a console."""

import os
import subprocess
import sys

import numpy as np
import pytest

from fx_membrane import Analysis, Mast, Stage, Structure, Support

SCRIPT = """
import os, sys
import fx_membrane
fx_membrane.Analysis  # all of it is loaded
numbers = [os.stat(number).st_rdev == os.stat(os.devnull).st_rdev for number in closed]
with open("after", "w") as file:
    print(numbers, file.fileno(), sys.stdout is None, sys.stderr is None, file=file)
os.write(2, b"as a C library does")
"""


@pytest.mark.parametrize("closed", [(2,), (1,), (0, 1, 2)])
def test_closed_streams(closed, tmp_path):
    shell = 'exec "$@" ' + " ".join(f"{number}>&-" for number in closed)
    command = ["sh", "-c", shell, "sh", sys.executable, "-c", f"closed = {closed}\n{SCRIPT}"]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(os.path.abspath, sys.path))}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    numbers, rest = (tmp_path / "after").read_text().split("] ")
    assert numbers == str([True] * len(closed))[:-1]
    number, *absent = rest.split()
    assert int(number) > 2  # a user's file must not receive errors of C libraries
    assert absent == ["False", "False"]


def test_stderr_that_is_taken_away(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    structure = Structure(np.eye(3)[:2], {"mast": Mast([[0, 1]], 1e6, prestress=-10.0)}, [Support([0, 1])])
    result = Analysis(structure).run([Stage("prestress")])["prestress"]
    np.testing.assert_allclose(result.mast("mast").force, -10.0)
