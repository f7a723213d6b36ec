"""Fixtures of several unit tests."""

import os
import subprocess
import sys
from collections import OrderedDict

import ffcx.codegeneration.jit
import pytest
from mpi4py import MPI

from fx_membrane import Analysis
from fx_membrane.runtime import jit_cache
from fx_membrane.solvers.newton_loop import NewtonLoop
from models import sheet


@pytest.fixture(scope="module")
def analysis():
    """Analysis of the square sheet."""
    return Analysis(sheet())


@pytest.fixture
def steps(monkeypatch):
    """List with the number of steps of each solve."""
    counts = []
    begin, step = NewtonLoop.begin, NewtonLoop.step
    monkeypatch.setattr(NewtonLoop, "begin", lambda *args: counts.append(0) or begin(*args))

    def counted(*args):
        counts[-1] += 1
        step(*args)

    monkeypatch.setattr(NewtonLoop, "step", counted)
    return counts


@pytest.fixture
def compiled_code(monkeypatch):
    """Run a script with no code in memory; return the number of forms, by name, that each call of `count()` has seen.

    A second process without a compiler then runs the script, too: it finds all code on the disk.
    """

    def run(script):
        names, counts, find = set(), [], ffcx.codegeneration.jit.get_cached_module
        monkeypatch.setattr(jit_cache, "_loaded", OrderedDict())
        monkeypatch.setattr(
            ffcx.codegeneration.jit, "get_cached_module", lambda name, *args: names.add(name) or find(name, *args)
        )
        exec(script, {"__name__": "script", "count": lambda: counts.append(len(names))})
        again = [sys.executable, "-c", "count = bool\n" + script]
        done = subprocess.run(again, env=os.environ | {"CC": "nocc"}, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return counts

    return run


@pytest.fixture
def path(tmp_path):
    """Path of one file for all processes."""
    return MPI.COMM_WORLD.bcast(tmp_path / "results" / "state.npz")
