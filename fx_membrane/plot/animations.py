"""Moving pictures of stages, load increments, paths and modes (pyvista inside matplotlib)."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..analysis.path import EquilibriumPath
from ..checks import validation
from ..checks.values import counted
from ..form_finding.form import Form
from ..model.structure import Structure
from ..results.states import StageResult, StageResults
from ..runtime.processes import by_the_first
from ..solvers.progress import Pulse
from .contour_maps import VIEW
from .field_panels import checked_fields, checked_options, means, panels_of
from .fields import Checked
from .figures import empty, plain
from .marks import Strokes, strokes
from .movies import checked_movie, write
from .panels import Look, Panel, checked_look, draw_panels, setting, size, without_unseen
from .scene import INK
from .screen import obstacle
from .subjects import Shape, Shown, shown

States = StageResults | Sequence[Shape] | EquilibriumPath | StageResult

DOTS = 100  # [1/inch]
SWING = 0.1  # largest displacement of a mode over the size of the structure, by default
MAX_FRAMES = 500  # frames; more take minutes and hundreds of megabytes


@by_the_first
def animation(
    states: States,
    path: str | Path,
    *,
    fields: Callable[[Any], Mapping[str, Any]] | None = None,
    motion: ArrayLike | None = None,
    frames: int = 24,
    seconds: float | None = None,
    scale: float | None = None,
    view: Sequence[float] = VIEW,
    mirror: str | None = None,
    antisymmetric: Sequence[str] = (),
    ranges: Mapping[str, Sequence[float]] | None = None,
    smoothed: Sequence[str] = (),
    lines: Sequence[str] = (),
    spacing: float | None = None,
    forces: bool = False,
    axes: bool = False,
    force_unit: str = "N",
    length_unit: str = "m",
) -> None:
    """Plot states one after the other, or a mode, as a moving picture: GIF, or MP4 by the ending of the path.

    All frames have the same size, camera and colours. Without pyvista, or if VTK cannot draw, a warning replaces the
    file.

    Args:
        states: Stages, as `Analysis.run` returns them; a list of states, such as those of load increments, collected by
            `Analysis.run(observe=...)`, or of forms; an `EquilibriumPath`, whose points have displacements, but no
            stresses; or one state, with a motion.
        path: Path of the file, ending in .gif or .mp4.
        fields: Function of a state that returns the fields of its frame, as those of `contours`, with the same titles
            for all; by default the size of the displacement.
        motion: Mode shape, shape (n, 3), as a row of `Modes.shapes`: one period of its motion about the one state is
            drawn.
        frames: Number of frames of a motion.
        seconds: Time of each frame; by default 0.8 s for states, 0.08 s for points of a path and motions [s].
        scale: Factor of the displacements, by default 1; of a motion, by default one with which the largest is a tenth
            of the size of the structure.
        view, mirror, antisymmetric, smoothed, lines, spacing, forces, axes, force_unit, length_unit: As in `contours`.
        ranges: As in `contours`; by default from the minimum to the maximum of all frames.

    Raises:
        ValueError: There are no states; states is of another kind; a motion is given with several states, or has
            another shape; fields returns other titles for one of the states; the path ends in neither .gif nor .mp4, or
            cannot be written; or as `contours`.
        ImportError: imageio-ffmpeg is not installed, for an MP4.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pulls = [Stage(f"pull {force}", [PointLoad(1, (0, 0, -force))]) for force in (100, 200)]
        >>> plot.animation(Analysis(rope).run(pulls), "pulls.gif", view=(0, -1, 0), forces=True)
    """
    file = checked_movie(path)
    subjects, names, givens = _checked(states, motion, frames, scale)
    swift = motion is not None or isinstance(states, EquilibriumPath)
    pause = (0.08 if swift else 0.8) if seconds is None else validation.positive("seconds", seconds)
    if isinstance(states, EquilibriumPath):
        _refuse_stress_of_path(forces or bool(set(lines) - {"warp"}))
    factor = 1.0 if scale is None or motion is not None else scale
    given = Look(factor, view, mirror, lines, spacing, forces, axes, force_unit, length_unit)
    looks = [checked_look(subject, given) for subject in subjects]
    look = looks[0]
    if fields is None:
        drawn = _sizes(subjects, motion is not None, look.length_unit)
    else:
        drawn = [_returned(fields, *pair) for pair in zip(subjects, givens, strict=True)]
    if len({tuple(entry) for entry in drawn}) > 1:
        raise ValueError("fields returns other titles for some of the states; return the same for all.")
    options = checked_options(drawn[0], antisymmetric, ranges, smoothed)
    every = panels_of([means(*pair, options.smoothed) for pair in zip(subjects, drawn, strict=True)], options)
    panels = [
        without_unseen(subject, shows, look, told=fields is not None and number == 0)
        for number, (subject, shows) in enumerate(zip(subjects, every, strict=True))
    ]
    if reason := obstacle():
        warnings.warn(f"{file} is not drawn: {reason}", stacklevel=3)
        return
    write(file, _frames(file.name, subjects, names, panels, look), pause)


def _refuse_stress_of_path(asked: bool) -> None:
    if asked:
        raise ValueError(
            "An EquilibriumPath has displacements only, without forces or lines of stress; give a list of its states, "
            "[path.state(point) for point in ...]."
        )


def _checked(
    states: Any, motion: ArrayLike | None, frames: int, scale: float | None
) -> tuple[list[Shown], list[str], list[Any]]:
    """Subjects of the frames, their names, and the states as given."""
    if motion is not None:
        return _swinging(states, motion, frames, scale)
    if isinstance(states, EquilibriumPath):
        structure, points = states.structure, list(states.points)
        subjects = [Shown(structure, structure, point.displacement) for point in points]
        names: list[str] = [f"load factor {point.load_factor:.3f}" for point in points]
        given: list[Any] = points
    else:
        given = list(states.values()) if isinstance(states, StageResults) else _listed(states)
        subjects = [shown("animation", state) for state in given]
        names = _names(given)
    if not 1 <= len(subjects) <= MAX_FRAMES:
        raise ValueError(
            f"The first argument of animation has {counted(len(subjects), 'state')}; give 1 to {MAX_FRAMES}."
        )
    return subjects, names, given


def _listed(states: Any) -> list[Any]:
    if isinstance(states, StageResult | Form | Structure):
        raise ValueError(
            f"The first argument of animation is one state, {validation.short_repr(states)}; give a list of states, or "
            "a motion, motion=modes.shapes[0]."
        )
    if isinstance(states, str) or not isinstance(states, Sequence):
        raise ValueError(
            f"The first argument of animation is {validation.short_repr(states)}; give StageResults, a list of states, "
            "or an EquilibriumPath."
        )
    return list(states)


def _names(states: Sequence[Any]) -> list[str]:
    """Names of states: those of stages, with load factors if there are several of one; numbers of others."""
    if not all(isinstance(state, StageResult) for state in states):
        return [f"{number} of {len(states)}" for number in range(1, len(states) + 1)]
    names = [state.name for state in states]
    if len(set(names)) == len(names):
        return names
    return [f"{state.name}, load factor {state.increments[-1].load_factor:.3f}" for state in states]


def _swinging(
    state: Any, motion: ArrayLike, count: int, scale: float | None
) -> tuple[list[Shown], list[str], list[Any]]:
    """Shapes, titles and states of one period of a motion about a state."""
    subject = shown("animation with a motion", state)
    shape = validation.finite("motion", motion)
    if shape.shape != subject.structure.points.shape:
        raise ValueError(
            f"motion has shape {shape.shape}; give {subject.structure.points.shape}, a vector for each node."
        )
    largest = float(np.linalg.norm(shape, axis=1).max())
    if largest == 0:
        raise ValueError("motion is zero; give the shape of a mode.")
    count = validation.positive_integer("frames", count, MAX_FRAMES)
    factor = SWING * subject.structure.size / largest if scale is None else validation.number("scale", scale)
    phases = np.cos(2 * np.pi * np.arange(count) / count)
    subjects = [replace(subject, displacement=subject.displacement + factor * phase * shape) for phase in phases]
    return subjects, [""] * count, [state] * count


def _returned(fields: Any, subject: Shown, given: Any) -> dict[str, Checked]:
    if not callable(fields):
        raise ValueError(f"fields is {validation.short_repr(fields)}; give a function of a state that returns fields.")
    return checked_fields(subject, fields(given))


def _sizes(subjects: Sequence[Shown], swinging: bool, unit: str) -> list[dict[str, Checked]]:
    """Sizes of displacements; of motions relative to the largest, in the first frame."""
    if not swinging:
        return [{f"displacement [{unit}]": np.linalg.norm(subject.displacement, axis=1)} for subject in subjects]
    shape = subjects[0].shape
    still = shape.displacement if isinstance(shape, StageResult) else 0.0
    sizes = [np.linalg.norm(subject.displacement - still, axis=1) for subject in subjects]
    return [{"motion over the largest [-]": values / sizes[0].max()} for values in sizes]


def _frames(
    name: str, subjects: Sequence[Shown], names: Sequence[str], panels: Sequence[Sequence[Panel]], look: Look
) -> Iterator[NDArray[np.uint8]]:
    """Pictures of all states, each of shape (height, width, 3)."""
    import matplotlib.backends.backend_agg  # noqa: PLC0415

    lines: dict[int, list[Strokes]] = {}
    for subject in subjects:
        if id(subject.shape) not in lines:  # those of a motion are of one state
            lines[id(subject.shape)] = strokes(subject, look.lines, look.spacing)
    groups = [lines[id(subject.shape)] for subject in subjects]
    same = setting(subjects, groups, look)
    width, height = size(panels[0], look, same)
    height += 0.3 * any(names)
    pulse = Pulse(name, shown=True)
    for number, (subject, words, shows, group) in enumerate(zip(subjects, names, panels, groups, strict=True)):
        figure = empty(width, height)
        figure.set_dpi(DOTS)
        if words:
            figure.suptitle(plain(words), color=INK, fontsize=12)
        draw_panels(figure, subject, shows, look, same, group)
        canvas: Any = matplotlib.backends.backend_agg.FigureCanvasAgg(figure)
        canvas.draw()
        yield np.array(canvas.buffer_rgba())[..., :3]
        pulse(f"frame {number + 1} of {len(subjects)}")
