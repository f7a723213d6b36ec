"""Progress on a terminal, silence without one, and a closed pipe."""

import contextlib
import fcntl
import itertools
import os
import pty
import re
import struct
import subprocess
import sys
import termios
from threading import Thread
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest
from mpi4py import MPI
from tqdm import tqdm

from fx_membrane import (
    Analysis,
    ConjugateGradient,
    Iteration,
    Newton,
    Stage,
    equilibrium_path,
    report,
    updated_reference,
)
from fx_membrane.solvers import progress
from fx_membrane.solvers.progress import Report
from models import (
    SNOW,
    sheet,
)


def test_lines_are_written_where_there_is_no_terminal(capfd):
    Analysis(sheet()).run([Stage("snow", [SNOW], increments=3)])
    out, err = capfd.readouterr()
    pattern = r"snow: load factor {} after {} iterations, residual \d\.\de[+-]\d\d, \d+\.\d s\n"
    lines = "".join(pattern.format(factor, r"\d+") for factor in (r"0\.333333", r"0\.666667", "1"))
    assert out == ""
    assert re.fullmatch(lines if MPI.COMM_WORLD.rank == 0 else "", err)


@pytest.mark.mpi
def test_iterations_are_those_of_the_report(capfd):
    """The start of an increment is none of them."""
    state = Analysis(sheet()).run([Stage("snow", [SNOW], increments=3)])["snow"]
    shown = [int(count) for count in re.findall(r"after (\d+) iterations?,", capfd.readouterr().err)]
    counts = [len(increment.iterations) - 1 for increment in state.increments]
    assert f"iterations per increment: {counts};" in report(state)
    assert all(increment.extra_iterations == 0 for increment in state.increments)
    assert shown == (np.cumsum(counts).tolist() if MPI.COMM_WORLD.rank == 0 else [])


@pytest.mark.mpi_once
@pytest.mark.parametrize("solver", [Newton(), ConjugateGradient()])
def test_nothing_is_written_where_it_is_not_wanted(capfd, solver):
    Analysis(sheet(), solver, progress=False).run([Stage("snow", [SNOW], increments=3)])
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("seconds", [0.5, 4.0, 60.0])
def test_silence_is_never_longer_than_ten_seconds_or_one_iteration(capfd, monkeypatch, seconds):
    clock = itertools.count(0.0, seconds)
    monkeypatch.setattr(progress, "monotonic", lambda: next(clock))
    with Report("load", 0.25, shown=True) as report:
        for number in range(100):
            report.iteration(number, Iteration(0.0, 1e3, 1.0))
    told = [float(line.split()[-2]) for line in capfd.readouterr().err.splitlines()]
    assert told
    assert np.diff([0.0, *told]).max() <= max(10.0, 3 * seconds)  # the clock is read twice for each line
    assert len(told) <= 100 * seconds / 2 + 1


class Gone:
    """Standard error whose reader is gone."""

    def isatty(self):
        return False

    def write(self, text):
        raise BrokenPipeError(text)

    def flush(self):
        pass


@pytest.mark.mpi_once
@pytest.mark.parametrize("stderr", [Gone(), None])
def test_a_reader_of_the_lines_that_is_gone_ends_no_run(monkeypatch, stderr):
    analysis = Analysis(sheet())
    monkeypatch.setattr(sys, "stderr", stderr)
    assert "snow" in analysis.run([Stage("snow", [SNOW])])


def read_all(terminal, pieces):
    """Take over what is written to a terminal, until its other end is closed."""
    # Linux then reports the terminal as gone, not as ended.
    with contextlib.suppress(OSError):
        while piece := os.read(terminal, 4096):
            pieces.append(piece)


@pytest.mark.parametrize("columns", [120, 80, 0], ids=["wide", "usual", "no size told"])
def test_terminal_shows_stage_and_load_factor(columns, capfd, monkeypatch):
    terminal, process_end = pty.openpty()
    fcntl.ioctl(process_end, termios.TIOCSWINSZ, struct.pack("HHHH", 24 if columns else 0, columns, 0, 0))
    pieces = []
    reader = Thread(target=read_all, args=(terminal, pieces))
    reader.start()
    with open(process_end, "w", encoding="utf-8") as stderr, monkeypatch.context() as context:
        context.setattr(sys, "stderr", stderr)
        snow = Stage("snow on the roof", [SNOW], increments=4, after="prestress")
        Analysis(sheet()).run([Stage("prestress"), snow])
    reader.join()
    os.close(terminal)
    assert capfd.readouterr() == ("", "")
    text = b"".join(pieces).decode()
    assert re.search(r"\rprestress: [^\r]* load factor 1\.0000", text)
    for factor in ("0.0000", "0.2500", "0.5000", "0.7500", "1.0000"):
        assert re.search(rf"\rsnow on the roof: [^\r]* load factor {re.escape(factor)}", text), factor
    assert re.search(r"iteration \d+, residual \d\.\de[+-]\d\d", text)
    assert text.count("\n") == 2  # one line for each stage
    more = re.search(r"increment 4, iteration \d+, [^\r]*, stage 2 of 2, 00:0\d<", text)
    assert bool(more) == (columns == 120)


def test_notebook_has_a_bar_of_its_own(capfd, monkeypatch):
    """A stand-in for the bar of notebooks shows the words that it is given; ipywidgets are not needed here."""
    shown = []

    class Bar(tqdm):
        def display(self, *_, **__):
            shown.append(str(self))

    monkeypatch.setitem(sys.modules, "ipykernel", ModuleType("ipykernel"))
    monkeypatch.setitem(sys.modules, "tqdm.notebook", SimpleNamespace(tqdm=Bar))
    monkeypatch.setattr(progress, "find_spec", lambda _: True)
    Analysis(sheet()).run([Stage("snow", [SNOW], increments=3)])
    out, err = capfd.readouterr()
    assert out == ""
    assert err.strip() == ""
    if MPI.COMM_WORLD.rank == 0:
        assert any("load factor 1.0000" in text and "stage 1 of 1" in text for text in shown)


def test_closed_pipe_is_an_exception_and_no_crash():
    script = "import fx_membrane\nwhile True:\n    print('table')"
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert process.stdout.readline() == b"table\n"
    process.stdout.close()
    with process:
        errors = process.stderr.read()
    assert b"BrokenPipeError" in errors
    assert b"PETSC" not in errors


def test_form_finding_and_paths_are_not_silent_for_long(capfd, monkeypatch):
    monkeypatch.setattr(progress, "monotonic", itertools.count(0.0, 6.0).__next__)
    updated_reference(sheet())
    equilibrium_path(sheet(), Stage("snow", [SNOW], increments=3))
    lines = capfd.readouterr().err.splitlines()
    assert re.match(r"form finding: step \d+, iteration \d+, residual \d\.\de[+-]\d\d, \d+\.\d s$", lines[0])
    step = r"equilibrium path: load factor \S+, iteration \d+, residual \d\.\de[+-]\d\d, \d+\.\d s$"
    assert any(re.match(step, line) for line in lines)
    assert re.match(r"equilibrium path: looking for slack parts at point \d+ of \d+, \d+\.\d s$", lines[-1])


def test_iterations_of_halved_increments_are_told_apart(capfd):
    with Report("load", 0.0, shown=True) as report:
        for number in range(4):
            report.iteration(number, Iteration(0.0, 1e3, 1.0 + number))
        report.increment(0.5, 1e-9, 2)
        report.iteration(1, Iteration(0.0, 1e3, 9.0))
        report.increment(1.0, 1e-9, 3)
    first, second = capfd.readouterr().err.splitlines()
    assert "after 2 iterations and 1 in larger increments without success, residual" in first
    assert "load factor 1 after 3 iterations and 1 in larger" in second
