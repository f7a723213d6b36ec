"""gmsh in scripts that `run_script` starts: its begin, its errors, and their exit codes."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any, TypeVar

NO_GMSH, FAILED = 3, 4  # exit codes

Found = TypeVar("Found")


def started_gmsh() -> Any:
    """Start gmsh without output; where it does not start, end the process with `NO_GMSH` and the reason."""
    try:
        import gmsh  # noqa: PLC0415  (its absence has an exit code)

        gmsh.initialize(readConfigFiles=False)
    except Exception as error:
        print(error, file=sys.stderr)
        sys.exit(NO_GMSH)
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.logger.start()
    return gmsh


def without_errors(gmsh: Any, work: Callable[[], Found]) -> Found:
    """Return the result of a function; where gmsh tells errors, end the process with `FAILED` and the first."""
    failure = ""
    try:
        found = work()
    except Exception as error:  # gmsh raises nothing more precise
        failure = str(error) or type(error).__name__
    errors = [line.removeprefix("Error: ") for line in gmsh.logger.get() if line.startswith("Error")]
    if failure or errors:
        print((errors or [failure])[0], file=sys.stderr)
        sys.exit(FAILED)
    return found


def not_started(words: str) -> ImportError:
    """Error of a process that ended with `NO_GMSH`, with its reason and the remedy."""
    return ImportError(f"gmsh does not start ({words}); install it: apt install python3-gmsh, or pip install gmsh.")
