"""Cache of compiled forms: compilation is announced, and leftovers of a dead compiler stop no run.

FFCx makes `name.c`, compiles it and then makes `name.c.cached`; a process that finds the first file waits for the
second. A process killed between them left the others waiting for ever. Here, a process compiles under a lock that the
kernel releases for the dead; the locked file holds the name of the source in work. There are as many locks as last
letters of names, sixteen: two processes with a cold cache seldom wait for each other.

A process keeps the modules that it has loaded: to find one again, FFCx lists the whole folder and loads the library
anew. FFCx's name of a module identifies its formulas, elements and options, so that no other code is found by it. The
code knows no mesh and no values.
"""

from __future__ import annotations

import fcntl
import importlib.machinery
import os
import threading
import time
from collections import OrderedDict
from collections.abc import Hashable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import cffi

from .messages import say

DEAD = 10.0  # another program without a sign for so long is dead, as in dolfinx [s]
MAX_KEPT_MODULES = 512  # loaded modules and forms, of some forty kinds of parts
PERIOD = 10.0  # between messages to the user [s]
_threads = threading.RLock()  # FFCx is changed during a call
_loaded: OrderedDict[tuple[Hashable, ...], Any] = OrderedDict()  # code: by folder, module and its objects; by kind
_told: list[float] = []  # times of messages to the user


@contextmanager
def guard(jit: Any) -> Iterator[None]:
    """Make FFCx's compiler (`ffcx.codegeneration.jit`) work in turn, without leftovers, and load once; in this block.

    Raises:
        RuntimeError: The cache cannot be written, or the compiler does not work.
        TimeoutError: Another process compiles, and does not end.
    """
    with _threads, ExitStack() as held:
        find = jit.get_cached_module

        def get_cached_module(name: str, objects: list[str], cache_dir: str | Path, timeout: int) -> Any:
            key = str(cache_dir), name, *objects
            if key in _loaded:
                _loaded.move_to_end(key)
                return _loaded[key]
            source = Path(cache_dir, f"{name}.c")
            if not complete(source):
                held.enter_context(_in_words(source.parent))
                held.enter_context(_turn(source, timeout))
            with _in_words(source.parent):
                found = find(name, objects, cache_dir, timeout)
            if found[0] is not None:  # else FFCx compiles it
                _keep(key, found)
            return found

        held.callback(setattr, jit, "get_cached_module", find)
        jit.get_cached_module = get_cached_module
        yield


@contextmanager
def by_kind(jit: Any, kind: tuple[Hashable, ...]) -> Iterator[None]:
    """Make dolfinx's compiler (`dolfinx.jit`) take the code of the last object of a kind, unread; within `guard`.

    The caller answers for it that objects of a kind have one formula: only their meshes and values differ.
    """
    compiled = jit.ffcx_jit

    def ffcx_jit(*args: Any, **options: Any) -> Any:
        if kind not in _loaded:
            _keep(kind, compiled(*args, **options))
        _loaded.move_to_end(kind)
        return _loaded[kind]

    jit.ffcx_jit = ffcx_jit
    try:
        yield
    finally:
        jit.ffcx_jit = compiled


def is_kept(kind: tuple[Hashable, ...]) -> bool:
    """Return True if the code of a kind is loaded."""
    return kind in _loaded


def _keep(key: tuple[Hashable, ...], found: Any) -> None:
    """Keep loaded code; the one that was not used for the longest time makes room."""
    _loaded[key] = found
    while len(_loaded) > MAX_KEPT_MODULES:
        _loaded.popitem(last=False)


def complete(source: Path) -> bool:
    """Return True if a source of FFCx was compiled, for this Python."""
    libraries = (source.with_suffix(suffix) for suffix in importlib.machinery.EXTENSION_SUFFIXES)
    ready = source.exists() and source.with_suffix(".c.cached").exists()
    return ready and any(library.exists() and library.stat().st_size for library in libraries)


def lock_of(source: Path) -> Path:
    """File that is locked while a source of FFCx is compiled; sources with other last letters have other ones."""
    return source.with_name(f"fx_membrane-{source.stem[-1]}.lock")


@contextmanager
def _in_words(folder: Path) -> Iterator[None]:
    try:
        yield
    except cffi.VerificationError as error:
        raise RuntimeError(
            f"The C compiler, which forms need, does not work ({error}); install it, as by `apt install gcc libc6-dev "
            "python3-dev`, or name another in the environment variable CC."
        ) from error
    except ImportError as error:
        raise RuntimeError(
            f"A compiled form cannot be loaded ({error}); let all be compiled again, after `rm -r {folder}`."
        ) from error
    except TimeoutError:  # already a sentence
        raise
    except OSError as error:
        raise RuntimeError(
            f"Compiled forms cannot be kept in {folder} ({error.strerror}); give a folder that can be written and has "
            "space, as by `export XDG_CACHE_HOME=/tmp/cache` before Python starts."
        ) from error


@contextmanager
def _turn(source: Path, timeout: float) -> Iterator[None]:
    """Compile a source, one process at a time for each lock; leftovers of a dead process are removed before."""
    _tell_of_compilation()
    source.parent.mkdir(parents=True, exist_ok=True)
    with open(os.open(lock_of(source), os.O_RDWR | os.O_CREAT, 0o666), "r+") as lock:
        locked = _acquire(lock.fileno(), source, timeout)
        if locked and (unfinished := lock.read()):  # its process is dead, or was interrupted
            _remove(source.with_name(Path(unfinished).name))
        if not complete(source):
            _wait_for_other_programs(source, DEAD if locked else timeout)
        if not complete(source):
            _remove(source)
            _write(lock, source.name)
        try:
            yield
        except Exception:  # FFCx has put the source away; not if the user interrupts
            _write(lock, "")
            raise
        _write(lock, "")


def _write(lock: Any, text: str) -> None:
    lock.seek(0)
    lock.truncate()
    lock.write(text)
    lock.flush()


def _acquire(lock: int, source: Path, timeout: float) -> bool:
    """Acquire the lock; return False if another process compiled the source, or the disk has no locks."""
    for _ in _moments(timeout, "forms are compiled by another process"):
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            if complete(source):
                return False
        except OSError:  # some network disks
            return False
        else:
            return True
    raise TimeoutError(
        f"Another process has compiled forms into {source.parent} for {timeout} s; end it, or give this one another "
        "folder, as by `export XDG_CACHE_HOME=/tmp/cache` before Python starts."
    )


def _wait_for_other_programs(source: Path, patience: float) -> None:
    """Wait while a program without locks, such as plain dolfinx, may compile a source."""
    times = [0.0]
    for file in source.parent.glob(f"{source.stem}.*"):
        with suppress(FileNotFoundError):
            times.append(file.stat().st_mtime)
    left = min(patience, patience - (time.time() - max(times)))
    for _ in _moments(left, f"{source} was begun by another program, which is given {patience:g} s"):
        if complete(source):
            break


def _moments(seconds: float, words: str) -> Iterator[None]:
    """Yield moments of a wait, and report it to the user."""
    begin = told = time.monotonic()
    while (now := time.monotonic()) < begin + seconds:
        if now > told + PERIOD:
            say(f"{words}: {now - begin:.0f} s")
            told = now
        yield
        time.sleep(0.1)


def _remove(source: Path) -> None:
    for file in source.parent.glob(f"{source.stem}.*"):
        file.unlink(missing_ok=True)


def _tell_of_compilation() -> None:
    """Report a compilation, the first time and long after the last message."""
    now = time.monotonic()
    if not _told or now > _told[-1] + PERIOD:
        say("still compiling forms" if _told else "compiling forms (once)")
        _told.append(now)
