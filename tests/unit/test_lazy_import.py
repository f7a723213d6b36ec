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


def test_command_shows_its_help_without_dolfinx():
    script = (
        "import sys; from click.testing import CliRunner; from fx_membrane.cli import main; "
        "print('Usage' in CliRunner().invoke(main, ['--help']).output, 'dolfinx' in sys.modules)"
    )
    assert output(script) == ["True", "False"]


def test_signal_handlers_stay_those_of_the_process():
    """PETSc sets its own handler for closed pipes."""
    script = (
        "import signal; before = signal.signal(signal.SIGPIPE, lambda *_: None), signal.getsignal(signal.SIGPIPE); "
        "import fx_membrane; fx_membrane.Analysis; print(signal.getsignal(signal.SIGPIPE) is before[1])"
    )
    assert output(script) == ["True"]


@pytest.mark.parametrize(
    "first", ["fx_membrane.Analysis", "fx_membrane.edges_where", "import fx_membrane.analysis.convergence_error"]
)
def test_warnings_are_shown_as_before(first):
    """ffcx 0.5 sends them to the log; any module may be the first to import it, as that of the command."""
    script = (
        f"import logging, warnings; before = warnings.showwarning; import fx_membrane; {first}; "
        "print(warnings.showwarning is before); logging.captureWarnings(True); "
        "print(warnings.showwarning is before)"
    )
    assert output(script) == ["True", "False"]


def test_one_environment_variable_is_set_unless_the_user_did():
    script = (
        "import os; {} before = dict(os.environ); import fx_membrane; fx_membrane.Analysis; "
        "print(*(f'{{name}}={{value}}' for name, value in os.environ.items() if before.get(name) != value))"
    )
    mpi = ("OMPI_", "PMIX_", "PRTE_", "OPAL_", "ORTE_")  # set by the MPI library
    assert [
        entry for entry in output(script.format("os.environ.pop('OMP_NUM_THREADS', 0);")) if not entry.startswith(mpi)
    ] == ["OMP_NUM_THREADS=1"]
    assert not [
        entry for entry in output(script.format("os.environ['OMP_NUM_THREADS'] = '2';")) if not entry.startswith(mpi)
    ]


@pytest.mark.parametrize(
    ("before", "expected"),
    [
        ("env.pop('DISPLAY', 0)", "vtkOSOpenGLRenderWindow"),
        ("env.pop('DISPLAY', 0); env[CHOICE] = 'vtkEGLRenderWindow'", "vtkEGLRenderWindow"),
        ("env['DISPLAY'] = ':0'", "None"),
    ],
)
def test_pictures_set_a_window_where_there_is_no_screen(before, expected):
    """README names both variables that are set."""
    script = (
        f"import os; env, CHOICE = os.environ, 'VTK_DEFAULT_OPENGL_WINDOW'; env.pop(CHOICE, 0); {before}; "
        "given = env.get(CHOICE); import fx_membrane; print(env.get(CHOICE) == given); "
        "fx_membrane.plot; print(env.get(CHOICE))"
    )
    assert output(script) == ["True", expected]
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
