"""Standard streams that were closed, as by `2>&-` or in a service, are opened on the null device."""

import os
import sys


def _open_closed() -> None:
    """Before other files are opened: they would get the numbers 1 and 2, and C libraries would write errors into them.

    UFL, tqdm and others take it for granted that `sys.stdout` and `sys.stderr` are there.
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
