"""Changes of cables and ropes in a stage, as plain data: a given force, a given unstressed length, a fixed end."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..checks.values import with_article
from ..geometry.sizes import lengths, measures
from .axial_law import Axial
from .base_classes import AnyChange
from .structure import Structure

Array = NDArray[np.float64]
ELASTIC = np.array([1.0, 0.0])  # share of the law, and force beside it


def store_cells(change: Any) -> None:
    """Check and store the part and the cells of a change."""
    validation.store(change, validation.text, "part")
    if change.cells is not None:
        validation.keep(change, cells=validation.unique_indices(f"{type(change).__name__} cells", change.cells, "cell"))


@dataclass(frozen=True, eq=False)
class GivenForce(AnyChange):
    """Cables or a rope stressed to a force, which they keep in every shape until another stage fixes them.

    The force grows from that at the start of the stage to the given one, and stays in later stages: a jack that
    follows, a weight over a pulley. `FixedLength` or `UnstressedLength` ends it.

    Args:
        force: Tension of each chosen cell [N].
        part: Name of the cables or the rope.
        cells: Changed cells of the cables, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The force is not positive; part and cells as for `NaturalStretch`.

    Example:
        >>> Stage("stressed", changes=[GivenForce(5e4, "stays")]).changes[0].force
        50000.0
    """

    force: float
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.positive, "force")
        store_cells(self)


@dataclass(frozen=True, eq=False)
class UnstressedLength(AnyChange):
    """Cables, masts or a rope of a given length without stress, from this stage on.

    Args:
        length: Unstressed length of all chosen cells together [m]; they share it in proportion to those at the start.
        part: Name of the part.
        cells: Changed cells of the part, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: The length is not positive; part and cells as for `NaturalStretch`.

    Example:
        >>> UnstressedLength(11.97, "stays", cells=[4]).length
        11.97
    """

    length: float
    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        validation.store(self, validation.positive, "length")
        store_cells(self)


@dataclass(frozen=True, eq=False)
class FixedLength(AnyChange):
    """Cables or a rope of given force, fixed with the length that they have at the start of the stage.

    From then on they are elastic: further loads change their force. The stage must follow another.

    Args:
        part: Name of the cables or the rope.
        cells: Changed cells of the cables, each once, shape (k,); all of them if not given.

    Raises:
        ValueError: Part and cells as for `NaturalStretch`.

    Example:
        >>> Stage("anchored", changes=[FixedLength("stays")], after="stressed").after
        'stressed'
    """

    part: str
    cells: ArrayLike | None = None

    def __post_init__(self) -> None:
        store_cells(self)


def check_cable_change(structure: Structure, stage: str, change: Any) -> None:
    """Refuse a change of a membrane, a given force of masts, or one of some cells of a rope."""
    part, kind = structure.parts[change.part], with_article(type(change).__name__)
    if change.part not in structure.bars or (part.is_strut and not isinstance(change, UnstressedLength)):
        found = type(part).__name__
        raise ValueError(f"{stage} has {kind} of {change.part!r}, a {found}; it acts on cables and ropes.")
    if part.shares_tension and change.cells is not None and len(np.asarray(change.cells)) < len(part.cells):
        raise ValueError(
            f"{stage} has {kind} of some cells of {change.part!r}, a Rope, which has one tension; leave cells out."
        )
    if not isinstance(change, UnstressedLength) and part.material != Axial(part.material.stiffness):
        law = type(part.material).__name__
        raise ValueError(f"{stage} has {kind} of {change.part!r} with the law {law}; it takes cables of Axial only.")


def tensions_after(change: Any, count: int, tensions: Array | None) -> Array:
    """Share of the law and force beside it of the cells of a part after a change, shape (count, 2)."""
    after = np.tile(ELASTIC, (count, 1)) if tensions is None else tensions.copy()
    chosen = slice(None) if change.cells is None else np.asarray(change.cells)
    after[chosen] = (0.0, change.force) if isinstance(change, GivenForce) else ELASTIC
    return after


def fixed(structure: Structure, change: FixedLength, natural: Array, held: Array, factor: Array, u: Array) -> Array:
    """Natural shape of cables of given force that are fixed in a shape, shape (cells, 1, 1) [-].

    Args:
        structure: The structure.
        change: The change.
        natural: Natural shape at the start, shape (cells, 1, 1) [-].
        held: Share of the law and force beside it at the start, shape (cells, 2).
        factor: Factors of the prestress, shape (cells,) [-].
        u: Displacement at the start, shape (n, 3) [m].
    """
    part = structure.parts[change.part]
    before = measures(structure.points, part.cells)
    now = lengths(np.diff((structure.points + u)[part.cells], axis=1)[:, 0])
    prestress = part.prestress_tensors()[:, 0, 0] * factor
    after = natural.copy()
    chosen = np.zeros(len(part.cells), dtype=bool)
    chosen[slice(None) if change.cells is None else np.asarray(change.cells)] = True
    chosen &= held[:, 0] == 0
    if part.shares_tension:  # the whole rope has one length
        before, now = np.full_like(before, before.sum()), np.full_like(now, now.sum())
        prestress = np.full_like(prestress, prestress.mean())
    ratio = now / (before * stretch_of(held[:, 1], prestress, part.material.stiffness))
    after[chosen, 0, 0] = ratio[chosen]
    return after


def stretch_of(tension: Array, prestress: Array, EA: float) -> Array:
    """Stretch l at which a cable has a tension, (prestress + EA (l^2 - 1) / 2) l, shape (cells,) [-]."""
    l = np.maximum(1.0, np.cbrt(2 * np.abs(tension) / EA)) + np.abs(tension) / EA  # noqa: E741  (as in the formula)
    for _ in range(100):
        step = ((prestress + EA * (l**2 - 1) / 2) * l - tension) / (prestress + EA * (3 * l**2 - 1) / 2)
        l = l - step  # noqa: E741
        if (np.abs(step) <= 4e-16 * l).all():
            break
    return l
