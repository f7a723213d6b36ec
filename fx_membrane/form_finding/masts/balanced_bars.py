"""Masts and stays in the place of held nodes of a form, with forces that balance its reactions."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...checks import validation
from ...model.parts import Bar, Cable, Mast
from ...model.structure import Structure
from ...model.supports import Support
from ..form import Form, refuse_unfit
from ..unsettled_form import UnsettledFormWarning
from .bar_frame import BarFrame, checked_parts

Array = NDArray[np.float64]
Nodes = NDArray[np.int64]

WANTED_FORCE_ERROR = 1e-3  # accepted difference from a wanted force, relative to the largest of them


def masts_and_stays(
    form: Form,
    bars: Mapping[str, Bar],
    points: ArrayLike = (),
    heads: ArrayLike | None = None,
    components: str = "xyz",
) -> Form:
    """Put masts and stays in the place of held nodes of a form, with forces that balance its reactions.

    The shape stays as it is. The heads are released, and the feet are supported. Where the directions of the bars leave
    no choice, their forces are unique. Where they leave one, as four bars at a head do, least squares finds those
    nearest to the wanted ones; bars without a wanted force then have the smallest that remain. Masts never pull, and
    stays never push; a bar can come out without force.

    Args:
        form: A form of any method, found with the heads held.
        bars: Masts and stays by name, of one cell between joints. Their prestress is the wanted force [N], negative in
            masts; where it is zero, none is wanted.
        points: Positions of new nodes, shape (k, 3) [m], with the numbers len(form.points) and following. Those that
            are no heads are feet, held in all components.
        heads: Nodes that the bars are to hold, shape (h,): nodes held in the form, which are released, and new ones,
            which are joints. By default, all nodes held in the form where a bar ends. Name them where another held node
            serves as a foot.
        components: Components in which heads are released, some of "xyz"; "yz" for a head in the plane of symmetry
            x = 0 of half a structure. A mast foot on a rail along x takes a second call: that foot as head, "x", and a
            tie along the rail.

    Returns:
        The form with the bars as further parts, under the same loads. `forces` and `reactions` are those of the whole,
        and `wish` has the wanted forces, too.
        It has converged if the form had, and the wanted forces are met within 0.1 %.

    Raises:
        ValueError: The bars cannot balance the reaction of a head; a mast would be in tension or a stay in compression;
            a head is not held in the form, or no bar ends there; a bar has no length; a new point is at no bar; a name
            is that of a part of the form; a wanted force has the wrong sign; the form is that of a net of force
            densities without stiffness.

    Warns:
        UnsettledFormWarning: A wanted force is not met; it names the bar that is farthest. `Form.remarks` has it, too.

    Example:
        A hypar between two low points and two mast heads, each with a mast and two stays:

        >>> points, triangles = rectangle(8.0, 8.0, 4, 4)
        >>> points = points @ [[0.7, 0.7, 0], [-0.7, 0.7, 0], [0, 0, 1]]
        >>> low, high = np.argsort(points[:, 1])[[0, -1]], np.argsort(points[:, 0])[[0, -1]]
        >>> points[high, 2] = 4.0
        >>> edge = Cable(boundary_edges(triangles), 1e7, prestress=1e5)
        >>> sail = {"sail": Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3), "edge": edge}
        >>> form = projected_stress(Structure(points, sail, [Support(low), Support(high)]), cables="force density")
        >>> n, (west, east) = len(points), high
        >>> masts = Mast([[n, west], [n + 1, east]], 1e8)
        >>> stays = Cable([[n + 2, west], [n + 3, west], [n + 4, east], [n + 5, east]], 1e7)
        >>> feet = [(-5, 0, 0), (5, 0, 0), (-9, -3, 0), (-9, 3, 0), (9, -3, 0), (9, 3, 0)]
        >>> guyed = masts_and_stays(form, {"masts": masts, "stays": stays}, feet)
        >>> bool((guyed.forces["masts"] < 0).all() and (guyed.forces["stays"] > 0).all())
        True
        >>> Analysis(guyed.structure).run([Stage("form")])["form"].largest_displacement
        0.0
    """
    validation.instance("masts_and_stays form", form, Form)
    found = _checked_structure(form)
    parts = checked_parts(bars)
    for name in filter(found.parts.__contains__, parts):
        raise ValueError(f"bars: the form has a part {name!r} already; give another name.")
    released = validation.components("components", components)
    added = _checked_points(points)
    places, n = np.concatenate([found.points, added]), len(found.points)
    held = np.concatenate([found.supported, np.zeros(added.shape, dtype=bool)])
    ends = np.unique(np.concatenate([part.cells.ravel() for part in parts.values()]))
    validation.in_range("bars", ends, len(places), "node")
    carried = _checked_heads(heads, places, ends, held[:, released].any(axis=1), n)
    _check_use(places, ends, carried, n)
    feet = np.setdiff1d(np.arange(n, len(places)), carried)
    free = ~held
    free[carried[:, None], released] = True
    free[feet] = False
    frame = BarFrame(parts, places, free)
    reactions = np.concatenate([form.reactions, np.zeros(added.shape)])
    forces = frame.balance(np.where(free, reactions, 0.0))
    if unmet := frame.unmet(forces, WANTED_FORCE_ERROR):
        warnings.warn(unmet, UnsettledFormWarning, stacklevel=2)
    by_part = _by_part(parts, forces)
    made = replace(
        found,
        points=places,
        parts={**found.parts, **{name: replace(part, prestress=by_part[name]) for name, part in parts.items()}},
        supports=[*_without(found.supports, carried, released), *([Support(feet)] if len(feet) else [])],
    )
    return replace(
        form,
        points=places,
        forces={**form.forces, **by_part},
        reactions=np.where(free, 0.0, reactions - frame.pulls(forces)),
        converged=form.converged and not unmet,
        remarks=(*form.remarks, *([unmet] if unmet else [])),
        made=made,
        wish={**form.wish, **_by_part(parts, frame.wanted)},
    )


def _checked_structure(form: Form) -> Structure:
    """Structure of a form.

    Raises:
        ValueError: It has none, or not the points of the form; it has energy terms.
    """
    if form.made is None:
        raise ValueError(
            "The form of a net has no stiffness; make a Structure from its points, its forces as prestress and its "
            "supports, and give dataclasses.replace(form, made=structure)."
        )
    found = form.made
    if not np.array_equal(found.points, form.points):
        raise ValueError("The structure of the form has other points than the form; make it with form.points.")
    refuse_unfit(found)
    return found


def _checked_points(points: ArrayLike) -> Array:
    """Check new points, shape (k, 3); an empty list has none."""
    none = isinstance(points, list | tuple) and not points
    return np.zeros((0, 3)) if none else validation.positions("points", points)


def _checked_heads(heads: ArrayLike | None, points: Array, ends: Nodes, held: NDArray[np.bool_], n: int) -> Nodes:
    """Nodes that the bars are to hold, shape (h,).

    Raises:
        ValueError: One is free in the form; none is named or found.
    """
    if heads is None:
        found = ends[held[ends]]
        if not len(found):
            raise ValueError("No bar ends at a node that is held in the form; hold the mast heads in form finding.")
        return found
    found = validation.unique_indices("heads", heads, "node")
    validation.in_range("heads", found, len(points), "node")
    for node in found[(found < n) & ~held[found]][:1]:
        raise ValueError(
            f"heads names node {node} at {validation.format_point(points[node])}, which is not held in the form, so "
            "there is no reaction to balance; hold it by a support in form finding."
        )
    return found


def _check_use(points: Array, ends: Nodes, heads: Nodes, n: int) -> None:
    """Refuse heads and new points where no bar ends.

    Raises:
        ValueError: There is one.
    """
    for node in np.setdiff1d(heads, ends)[:1]:
        where = validation.format_point(points[node])
        raise ValueError(f"No bar ends at node {node} at {where}, one of heads; add masts and stays there.")
    for node in np.setdiff1d(np.arange(n, len(points)), ends)[:1]:
        where = validation.format_point(points[node])
        raise ValueError(
            f"No bar ends at node {node} at {where}, point {node - n} of points; leave it out, or mend the numbers of "
            "nodes in bars."
        )


def _by_part(parts: Mapping[str, Mast | Cable], forces: Array) -> dict[str, Array]:
    """Split the forces of all bars, shape (bars,), by part."""
    ends = np.cumsum([len(part.cells) for part in parts.values()])
    return dict(zip(parts, np.split(forces, ends[:-1]), strict=True))


def _without(supports: Sequence[Support], heads: Nodes, released: tuple[int, ...]) -> list[Support]:
    """Supports with some components of some nodes released."""
    left = []
    for support in supports:
        nodes = np.asarray(support.nodes)
        freed = np.isin(nodes, heads)
        kept = "".join(letter for letter in support.components if "xyz".index(letter) not in released)
        if not freed.all():
            left.append(Support(nodes[~freed], support.components))
        if freed.any() and kept:
            left.append(Support(nodes[freed], kept))
    return left
