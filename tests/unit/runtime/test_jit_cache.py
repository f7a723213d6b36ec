"""First runs that are killed, or lack a compiler or a cache: the next one works, or reports the remedy."""

import fcntl
import importlib.machinery
import os
import signal
import subprocess
import sys
import time

import pytest

from fx_membrane.runtime import jit_cache

WORD = "compiling forms (once)"
SCRIPT = """
import numpy as np
from fx_membrane import *
masts = {"mast": Mast([[0, 1]], 1e6, prestress=-10.0)}
Analysis(Structure(np.eye(3)[:2], masts, [Support([0, 1])])).run([Stage("prestress")])
"""


@pytest.fixture
def environment(tmp_path):
    """Cold cache, and a compiler that does not end as long as the file `slow` is there."""
    compiler = tmp_path / "cc"
    compiler.write_text(
        f'#!/bin/sh\ntouch "{tmp_path}/begun"\nwhile [ -e "{tmp_path}/slow" ]; do sleep 0.1; done\nexec gcc "$@" -O0\n'
    )
    compiler.chmod(0o755)
    return {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache"), "CC": str(compiler)}


def run(environment):
    return subprocess.run([sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=False)


# Processes in the background of a shell begin without.
INTERRUPTIBLE = "import signal\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"


def stop_while_compiling(environment, folder, number):
    begun, slow = folder / "begun", folder / "slow"
    begun.unlink(missing_ok=True)
    slow.touch()
    script = INTERRUPTIBLE + SCRIPT
    process = subprocess.Popen([sys.executable, "-c", script], env=environment, stderr=subprocess.PIPE, text=True)
    while not begun.exists():
        assert process.poll() is None, process.stderr.read()
        time.sleep(0.05)
    process.send_signal(number)
    if number == signal.SIGKILL:
        process.wait()  # before its compiler ends
    slow.unlink()
    words = process.communicate()[1]
    assert process.returncode == -number, words
    assert WORD in words


def unfinished(cache):
    """Files that FFCx would wait for."""
    return {file.name for file in cache.glob("*.c") if not file.with_suffix(".c.cached").exists()}


def test_next_run_after_a_stop_while_compiling(environment, tmp_path):
    cache = tmp_path / "cache/fenics"
    for number in (signal.SIGKILL, signal.SIGINT):
        stop_while_compiling(environment, tmp_path, number)
        assert len(unfinished(cache)) == 1
    again = run(environment)
    assert again.returncode == 0, again.stderr
    assert WORD in again.stderr
    assert not unfinished(cache)
    warm = run(environment)
    assert warm.returncode == 0, warm.stderr
    assert "compiling" not in warm.stderr


@pytest.mark.parametrize(
    ("variables", "words"),
    [
        (
            {"XDG_CACHE_HOME": "/dev/null"},
            "/dev/null/fenics (Not a directory)",
        ),
        ({"CC": "nocc"}, "does not work (CompileError: "),
    ],
)
def test_no_cache_and_no_compiler(variables, words, environment):
    done = run(environment | variables)
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1].startswith("RuntimeError: ")
    assert words in done.stderr.splitlines()[-1]
    assert "XDG_CACHE_HOME" in done.stderr or "apt install gcc libc6-dev python3-dev" in done.stderr


def test_warnings_as_errors_and_closed_streams_with_a_cold_cache(environment):
    closed = 'exec "$@" <&- >&- 2>&-'
    command = ["sh", "-c", closed, "sh", sys.executable, "-W", "error", "-c", SCRIPT]
    assert subprocess.run(command, env=environment, check=False).returncode == 0


CONDITIONS = """
import numpy as np
import ufl
from mpi4py import MPI  # it finds the MPI library of a wheel, which dolfinx alone does not
from dolfinx import fem
from fx_membrane import _dolfinx

msh = _dolfinx.create_mesh(np.array([[0.0, 0, 0], [1, 0, 0]]), np.array([[0, 1]]))
a, b, c = numbers = [fem.Constant(msh, 0.0) for _ in range(3)]
A, B, C = [ufl.gt(number, 0.5) for number in numbers]
conditions = ufl.Or(A, ufl.And(B, C)), ufl.And(ufl.Or(A, B), C)
forms = [_dolfinx.form(ufl.conditional(condition, 1.0, 0.0) * ufl.dx(msh)) for condition in conditions]
for k in range(8):
    a.value, b.value, c.value = values = [float(k >> i & 1) for i in range(3)]
    assert [fem.assemble_scalar(form) > 0.5 for form in forms] == [
        bool(values[0] or (values[1] and values[2])), bool((values[0] or values[1]) and values[2])
    ]
"""


def test_compiler_has_no_remark_on_conditions_of_conditions(environment):
    """Of a law with Or and And, gcc printed pages with FFCx 0.5; the conditions keep their meaning."""
    command = [sys.executable, "-c", CONDITIONS]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "warning" not in done.stderr


class FFCx:
    """Finds sources as FFCx does: no objects and no module for one to be compiled."""

    def __init__(self, compiled):
        self.compiled, self.searches = compiled, 0

    def get_cached_module(self, name, objects, cache_dir, timeout):
        self.searches += 1
        try:
            open(f"{cache_dir}/{name}.c", "x").close()
        except FileExistsError:
            return [], self.compiled
        return None, None

    def compile(self, cache, fails=None, objects=()):
        with jit_cache.guard(self):
            _, found = self.get_cached_module("form", list(objects), cache, 1)
            if found is None:
                if fails is not None:
                    raise fails
                for suffix in (importlib.machinery.EXTENSION_SUFFIXES[0], ".c.cached"):
                    (cache / f"form{suffix}").write_text("compiled")
        return found


def test_source_of_another_program_is_waited_for(tmp_path, monkeypatch):
    """A program without locks may still compile it."""
    monkeypatch.setattr(jit_cache, "DEAD", 1.0)
    (tmp_path / "form.c").touch()
    begin = time.monotonic()
    assert FFCx(None).compile(tmp_path) is None
    assert time.monotonic() - begin > 0.9
    assert FFCx("found").compile(tmp_path) == "found"


@pytest.mark.parametrize("damage", ["form.c", "form.c.cached", "form" + importlib.machinery.EXTENSION_SUFFIXES[0]])
def test_what_is_incomplete_is_compiled_again(damage, tmp_path, monkeypatch):
    monkeypatch.setattr(jit_cache, "DEAD", 0.0)
    assert FFCx(None).compile(tmp_path) is None
    (tmp_path / damage).unlink()
    assert FFCx("found").compile(tmp_path) is None
    assert FFCx("found").compile(tmp_path) == "found"


def test_interrupted_in_the_same_process(tmp_path):
    """At once, as in a notebook: without the waiting time for other programs."""
    with pytest.raises(KeyboardInterrupt):
        FFCx(None).compile(tmp_path, KeyboardInterrupt)
    assert jit_cache.lock_of(tmp_path / "form.c").read_text() == "form.c"
    assert FFCx("found").compile(tmp_path) is None
    assert jit_cache.lock_of(tmp_path / "form.c").read_text() == ""


def test_another_process_that_never_ends_to_compile(tmp_path):
    with open(jit_cache.lock_of(tmp_path / "form.c"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(TimeoutError, match=r"^Another process.*compiled forms.*1 s; end"):
            FFCx(None).compile(tmp_path)


def test_forms_with_other_locks_are_compiled_meanwhile(tmp_path):
    with open(jit_cache.lock_of(tmp_path / "shape.c"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        assert FFCx(None).compile(tmp_path) is None
    assert jit_cache.complete(tmp_path / "form.c")


def test_module_is_loaded_once(tmp_path):
    FFCx(None).compile(tmp_path)
    ffcx = FFCx("found")
    assert [ffcx.compile(tmp_path) for _ in range(3)] == ["found"] * 3
    assert ffcx.searches == 1


def test_module_of_another_folder_or_with_other_objects_is_another(tmp_path):
    folders = tmp_path / "a", tmp_path / "b"
    for folder in folders:
        folder.mkdir()
        FFCx(None).compile(folder)
    asked = [(folder, objects) for folder in folders for objects in ((), ("first",), ("first", "second"))]
    for _ in range(2):
        assert [FFCx(each).compile(each[0], objects=each[1]) for each in asked] == asked


def test_module_that_was_compiled_is_not_taken_for_found(tmp_path):
    ffcx = FFCx(None)
    assert ffcx.compile(tmp_path) is None
    ffcx.compiled = "found"
    assert ffcx.compile(tmp_path) == "found"


def test_few_modules_are_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(jit_cache, "MAX_KEPT_MODULES", 2)
    FFCx(None).compile(tmp_path)
    ffcx = FFCx("found")
    for name in ("a", "b", "a", "c", "a", "b"):
        ffcx.compile(tmp_path, objects=[name])
    assert ffcx.searches == 4  # a, b, c, and b again
    assert len(jit_cache._loaded) == 2
