"""Progress on a terminal, and silence where there is none."""

import contextlib
import fcntl
import os
import pty
import re
import struct
import subprocess
import sys
import termios

import pytest

from fx_membrane import (
    Analysis,
    Stage,
)
from models import (
    SNOW,
    sheet,
)


def test_nothing_is_written_where_there_is_no_terminal(capfd):
    Analysis(sheet()).run([Stage("snow", [SNOW], steps=3)])
    assert capfd.readouterr() == ("", "")


WATCHED = """
from fx_membrane import *
points, triangles = rectangle(1.0, 1.0, 2, 2)
fabric = Membrane(triangles, Fabric(Et=1e5, nu=0.3), prestress=1e3)
analysis = Analysis(Structure(points, {"fabric": fabric}, [Support([0, 1, 2, 3, 5, 6, 7, 8])]))
snow = DeadLoad((0, 0, -100.0), "fabric")
analysis.run([Stage("prestress"), Stage("snow on the roof", [snow], steps=4, after="prestress")])
"""


@pytest.mark.serial
@pytest.mark.parametrize("columns", [120, 80, 0], ids=["wide", "usual", "no size told"])
def test_terminal_shows_stage_and_load_factor(columns):
    terminal, process_end = pty.openpty()
    fcntl.ioctl(process_end, termios.TIOCSWINSZ, struct.pack("HHHH", 24 if columns else 0, columns, 0, 0))
    process = subprocess.Popen([sys.executable, "-c", WATCHED], stderr=process_end, stdout=subprocess.PIPE)
    os.close(process_end)
    shown = b""
    # At the end of the process Linux reports the terminal as gone, not as ended.
    with contextlib.suppress(OSError):
        while piece := os.read(terminal, 4096):
            shown += piece
    os.close(terminal)
    with process:
        assert process.stdout.read() == b""
    assert process.returncode == 0
    text = shown.decode()
    assert re.search(r"\rprestress: [^\r]* load factor 1\.0000", text)
    for factor in ("0.0000", "0.2500", "0.5000", "0.7500", "1.0000"):
        assert re.search(rf"\rsnow on the roof: [^\r]* load factor {re.escape(factor)}", text), factor
    assert re.search(r"iteration \d+, residual \d\.\de[+-]\d\d", text)
    assert text.count("\n") == 2  # one line for each stage
