"""Replacement of closed standard streams, as by `2>&-` or in a service, by the null device."""

from __future__ import annotations

import os
import sys


def _open_closed() -> None:
    """Open closed standard streams before other files get their numbers 1 and 2, where C libraries write errors.

    UFL, tqdm and others rely on `sys.stdout` and `sys.stderr`.
    """
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            null = os.open(os.devnull, os.O_RDWR)
            os.dup2(null, number)
            if null != number:
                os.close(null)
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115  (open until Python ends)
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115


_open_closed()  # as soon as the package is imported
