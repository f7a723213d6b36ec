"""Scripts of the cookbook: short, and each runs as it stands, in a folder of its own, and in a fresh process."""

import os
import subprocess
import sys
from pathlib import Path

SCRIPTS = sorted((Path(__file__).parent.parent / "demos" / "cookbook").glob("*.py"))
IN_TURN = """\
import os, runpy, sys
for script in sys.argv[1:]:
    folder = os.path.splitext(os.path.basename(script))[0]
    os.mkdir(folder)
    os.chdir(folder)
    print("begins", folder, flush=True)
    runpy.run_path(script, run_name="__main__")
    os.chdir("..")
"""


def test_scripts(tmp_path):
    """One process for all: a start takes longer than most scripts."""
    assert all(len(script.read_text().splitlines()) <= 40 for script in SCRIPTS)
    source = str(Path(__file__).parent.parent)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [source, os.environ.get("PYTHONPATH")]))}
    command = [sys.executable, "-c", IN_TURN, *map(str, SCRIPTS)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    begun = [said.split("\n", 1) for said in ("\n" + done.stdout).split("\nbegins ")[1:]]
    assert [name for name, _ in begun] == [script.stem for script in SCRIPTS]
    assert all(said.strip() for _, said in begun)
