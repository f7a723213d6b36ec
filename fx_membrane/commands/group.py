"""Group of commands: exit codes, and messages that one process prints."""

from __future__ import annotations

import os
import shlex
import signal
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import click

from ..runtime.package_versions import reason_of_import
from ..runtime.printable_text import printable

FILE = click.Path(dir_okay=False, path_type=Path)
CASE = click.Path(path_type=Path)  # a folder is told of by the reader


class Ended(KeyboardInterrupt):
    """SIGTERM, as batch systems send it: the run ends as by Ctrl-C."""


_received: list[signal.Signals] = []


class Group(click.Group):
    """Commands that end with 2 for errors of input, 1 for those of a solution, 130 by Ctrl-C, 143 by SIGTERM."""

    def main(self, *arguments: Any, **settings: Any) -> Any:
        """Run the command line; an output that cannot be written, as on a full disk, is one sentence."""
        try:
            return super().main(*arguments, **settings)
        except OSError as error:
            with suppress(OSError, ValueError):  # Python writes again what is left when it ends
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            with suppress(OSError):
                say(f"The output cannot be written ({error.strerror}); make room, or send it elsewhere.", err=True)
            sys.exit(2)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a command, and turn its warnings and exceptions into lines, the latter with exit codes."""
        try:
            with _heeding_signals(), warnings.catch_warnings():
                warnings.showwarning = _warn  # type: ignore[assignment]  # of the same arguments
                return _unless_ended(super().invoke, ctx)
        except KeyboardInterrupt as stop:
            later = " Saved increments stay: `fx-membrane run CASE --resume` goes on, `show` tells of them."
            code, words = (143, "Ended by SIGTERM.") if isinstance(stop, Ended) else (130, "Stopped.")
            words += later * (ctx.invoked_subcommand == "run")
        except ImportError as error:
            code, words = 2, reason_of_import(error)
        except ValueError as error:
            code, words = 2, str(error)
        except OSError as error:
            if error.filename is None:  # the output itself
                raise
            code, words = 2, f"{error.filename}: {error.strerror}; give another place."
        except click.exceptions.Exit:  # after the help of a command; a RuntimeError, too
            raise
        except RuntimeError as error:
            code, words = 1, str(error)
        say(in_words(words), err=True)
        sys.exit(code)


def heed_sigterm() -> Any:
    """Let SIGTERM raise `Ended`; return the handler before. PETSc takes the signal when it is loaded: call it again."""

    def end(*_: Any) -> None:
        _received.append(signal.SIGTERM)
        raise Ended

    with suppress(ValueError):  # not in the main thread
        return signal.signal(signal.SIGTERM, end)
    return None


def _stop(*_: Any) -> None:
    """Note Ctrl-C, and stop as Python does."""
    _received.append(signal.SIGINT)
    raise KeyboardInterrupt


def _unless_ended(act: Callable[[click.Context], Any], ctx: click.Context) -> Any:
    """Run a command; an error that compiled code has made of a signal is that signal."""
    _received.clear()
    try:
        return act(ctx)
    except KeyboardInterrupt:
        raise
    except BaseException:  # a panic of compiled code is no Exception
        if _received:
            raise Ended if signal.SIGTERM in _received else KeyboardInterrupt from None
        raise


@contextmanager
def _heeding_signals() -> Iterator[None]:
    before = heed_sigterm()
    stoppable = before is not None and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if stoppable:  # nohup and others may have it ignored
        signal.signal(signal.SIGINT, _stop)
    try:
        yield
    finally:
        if before is not None:
            signal.signal(signal.SIGTERM, before)
        if stoppable:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def say(words: str, err: bool = False) -> None:
    """Print on the first process only."""
    if os.environ.get("OMPI_COMM_WORLD_RANK", os.environ.get("PMI_RANK", "0")) == "0":
        click.echo(printable(words), err=err)


def once(act: Callable[[], None]) -> None:
    """Act on the first process only; MPI is loaded under mpirun alone."""
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", os.environ.get("PMI_SIZE", "1"))) == 1:
        act()
        return
    from ..runtime.processes import by_the_first  # noqa: PLC0415

    by_the_first(act)()


def _warn(message: Warning | str, *_: Any) -> None:
    say(f"Warning: {in_words(str(message))}", err=True)


def in_words(words: str) -> str:
    """Put a message of the package, which speaks of Python, in words of case files."""
    from ..files.cases.wording import in_keys_of_files  # noqa: PLC0415

    return in_keys_of_files(words)


def quoted(path: Path) -> str:
    """Name of a file in a command to copy."""
    return shlex.quote(str(path))


def write(file: Path, text: str) -> None:
    """Write a whole file or none."""
    from ..files.whole_file import writing  # noqa: PLC0415

    with writing(file, encoding="utf-8", errors="backslashreplace") as stream:
        stream.write(text)
