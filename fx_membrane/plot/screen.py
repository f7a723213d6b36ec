"""Ability of this machine to draw: VTK needs a screen, or a library that draws in memory."""

from __future__ import annotations

import ctypes
import os

# VTK's windows that draw in memory, and their libraries: without its library VTK crashes the process.
IN_MEMORY = {"vtkOSOpenGLRenderWindow": "libOSMesa.so.8", "vtkEGLRenderWindow": "libEGL.so.1"}
CHOICE = "VTK_DEFAULT_OPENGL_WINDOW"

INSTALL = "run pip install '.[plot]' in the folder of fx_membrane, in a virtual environment"

# Set before pyvista loads VTK; otherwise VTK looks for a screen first, and complains.
if not os.environ.get("DISPLAY"):
    os.environ.setdefault(CHOICE, "vtkOSOpenGLRenderWindow")


def obstacle() -> str:
    """Sentence on why pyvista cannot draw here, with the remedy; empty if it can."""
    try:
        import pyvista.plotting  # noqa: PLC0415  (numbers alone must not wait for it)

        # Loaded here: its first use would load it, and the frames of its callers stay in cycles, with their plotter.
        # The garbage collector would free that at any time, on any thread, where VTK can crash.
    except ImportError as error:
        return f"pyvista does not load ({error}); {INSTALL}."
    if os.environ.get("DISPLAY"):
        return ""
    if pyvista.vtk_version_info < (9, 4):  # it would abort the whole process
        version = ".".join(map(str, pyvista.vtk_version_info))
        return f"VTK {version} cannot draw without a screen; {INSTALL}, or run the script with xvfb-run -a."
    usable = [window for window, library in IN_MEMORY.items() if _loads(library)]
    if not usable:
        return "there is neither a screen nor a library that draws in memory; apt install libosmesa6 or libegl1."
    if os.environ.get(CHOICE) not in usable:
        os.environ[CHOICE] = usable[0]
    return ""


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True
