"""Effects of `import fx_membrane`: loaded modules and changes, in separate processes."""

import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest

import fx_membrane
from fx_membrane.checks.former_names import NAMES


def output(script):
    return subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True).stdout.split()


def test_nothing_is_loaded_before_it_is_used():
    heavy = ["numpy", "scipy", "mpi4py", "petsc4py", "dolfinx", "ufl", "matplotlib", "pyvista"]
    script = f"import sys, fx_membrane; print(*(name for name in {heavy} if name in sys.modules))"
    assert output(script) == []


@pytest.mark.parametrize("command", [[], ["run"], ["patterns"]])
def test_command_shows_its_help_without_dolfinx(command):
    script = (
        "import sys; from click.testing import CliRunner; from fx_membrane.cli import main; "
        f"done = CliRunner().invoke(main, {[*command, '--help']}); "
        "print('Usage' in done.output, done.exit_code, *done.output.split()[-1:], 'dolfinx' in sys.modules)"
    )
    shown, code, last, loaded = output(script)
    assert (shown, code, loaded) == ("True", "0", "False")
    assert last != "0"  # the code as a message


@pytest.mark.parametrize(
    ("first", "threads"),
    [
        ("fx_membrane.Analysis", None),
        ("import fx_membrane.analysis.convergence_error", "2"),
        ("fx_membrane.edges_where", "2"),
    ],
)
def test_process_stays_as_it_was(first, threads):
    """Shown warnings, which ffcx 0.5 logs; a handler, where PETSc sets its own for closed pipes; the environment.

    Any module may be the first to import ffcx, as that of the command. One variable is set unless the user did.
    """
    given = f"os.environ['OMP_NUM_THREADS'] = '{threads}'" if threads else "os.environ.pop('OMP_NUM_THREADS', 0)"
    script = (
        f"import logging, os, signal, warnings; {given}; heard = []; "
        "signal.signal(signal.SIGPIPE, lambda *_: heard.append(True)); "
        "shown = warnings.showwarning; before = dict(os.environ); "
        f"import fx_membrane; {first}; print(warnings.showwarning is shown); fx_membrane.Analysis; "
        "print(warnings.showwarning is shown); signal.raise_signal(signal.SIGPIPE); print(*heard); "
        "logging.captureWarnings(True); print(warnings.showwarning is shown); "
        "print(*(f'{name}={value}' for name, value in os.environ.items() if before.get(name) != value))"
    )
    mpi = ("OMPI_", "PMIX_", "PRTE_", "OPAL_", "ORTE_")  # set by the MPI library
    *found, logged = (told := output(script))[:4]
    assert (found, logged) == (["True"] * 3, "False")
    changed = [entry for entry in told[4:] if not entry.startswith(mpi)]
    assert changed == ([] if threads else ["OMP_NUM_THREADS=1"])


def test_pictures_set_a_window_where_there_is_no_screen():
    """README names both variables that are set; the second and third time the module is loaded again."""
    script = (
        "import importlib, os; env, CHOICE = os.environ, 'VTK_DEFAULT_OPENGL_WINDOW'\n"
        "env.pop(CHOICE, 0); env.pop('DISPLAY', 0)\n"
        "import fx_membrane; print(CHOICE in env); fx_membrane.plot; print(env[CHOICE])\n"
        "from fx_membrane.plot import screen\n"
        "env[CHOICE] = 'vtkEGLRenderWindow'; importlib.reload(screen); print(env[CHOICE])\n"
        "env.pop(CHOICE); env['DISPLAY'] = ':0'; importlib.reload(screen); print(env.get(CHOICE))\n"
    )
    assert output(script) == ["False", "vtkOSOpenGLRenderWindow", "vtkEGLRenderWindow", "None"]
    readme = (Path(fx_membrane.__file__).parent.parent / "README.md").read_text()
    assert "`VTK_DEFAULT_OPENGL_WINDOW`" in readme
    assert "`OMP_NUM_THREADS`" in readme


def test_each_public_name_is_there():
    assert sorted(fx_membrane.__all__) == list(fx_membrane.__all__)
    for name in fx_membrane.__all__:
        assert getattr(fx_membrane, name).__name__.rpartition(".")[2] == name
    with pytest.raises(AttributeError, match="Membrain"):
        getattr(fx_membrane, "Membrain")  # noqa: B009  (the subject, unknown to mypy)


def test_former_name_tells_the_new_one():
    with pytest.raises(AttributeError, match=r"fx_membrane\.DeadLoad is now DistributedLoad; see 'Changes since"):
        getattr(fx_membrane, "DeadLoad")  # noqa: B009  (the subject, unknown to mypy)
    assert set(NAMES.values()) <= set(fx_membrane.__all__)
    assert not set(NAMES) & set(fx_membrane.__all__)


def test_version():
    """Three numbers; sources without installation do not know theirs."""
    installed = list(importlib.metadata.distributions(name="fx-membrane"))
    assert fx_membrane.__version__ == (installed[0].version if installed else "unknown")
    assert not installed or fx_membrane.__version__.count(".") == 2
