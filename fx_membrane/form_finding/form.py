"""Form: the result of every method of form finding."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from html import escape
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks.values import counted
from ..model import natural_shape
from ..model.structure import Structure
from ..model.supports import Support
from ..model.term_parameters import described
from ..runtime.notebook_pictures import picture_html, picture_png, table


class FormStep(NamedTuple):
    """One step of a method that goes to its form in several.

    Attributes:
        area: Area of all membranes [m2].
        change: Largest displacement of the step across the surface or the lines, over the mean length of the edges; for
            cables and masts between nodes that do not slide, the relative change of length if it is larger [-].
            `prescribed_stress` counts the changes of area and stress and all motion, too.
        stress_error: Largest difference of the stress in the shape from the prescribed one, relative to the latter.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> rim = Support(np.unique(boundary_edges(triangles)))
        >>> points[4, 2] = 0.5  # the middle, off the plane of its supports
        >>> sheet = Structure(points, {"sheet": Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)}, [rim])
        >>> step = updated_reference(sheet).steps[-1]
        >>> round(step.area, 6), bool(step.stress_error < 1e-3)
        (4.0, True)
    """

    area: float
    change: float
    stress_error: float


@dataclass(frozen=True, eq=False, repr=False)
class Form:
    """Shape in equilibrium with its forces, under the loads of its form finding.

    Attributes:
        points: Positions of the nodes, shape (n, 3) [m].
        forces: By part, axial forces of cables and masts, shape (cells,) [N]. Of membranes, Cauchy stress times
            thickness in the warp/weft frame, shape (cells, 2, 2) [N/m]. `force_density` gives those of its branches
            under "net".
        reactions: Forces of supports, and of constraints of nodes, shape (n, 3) [N]; zero where free.
        steps: The steps of a method that takes several.
        converged: True if the form meets the conditions of its method, which may be far from the wish: `differences`
            says how far, `remarks` in words.
        made: As `structure`; None for a net of force densities.
        wish: By part, the forces wished for where the cells now are, as `forces`; empty where a method has none in
            space, as `force_density` and `projected_stress`.
        remarks: Sentences on the wish, such as that which would be exact, and on what constraints did.
        supports: Supports of a net, those given and those that bear its constraints; of other forms, `structure` has
            them.
        force_unit: Name of the unit of force, for pages and files; nothing is converted.
        length_unit: Name of the unit of length.

    Example:
        >>> corners = [(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 1), (9, 9, 9)]
        >>> form = force_density(corners, [[0, 4], [1, 4], [2, 4], [3, 4]], 100.0, [Support(range(4))])
        >>> form.points[4].round(9).tolist(), form.converged
        ([1.0, 1.0, 0.5], True)
    """

    points: NDArray[np.float64]
    forces: Mapping[str, NDArray[np.float64]]
    reactions: NDArray[np.float64]
    steps: tuple[FormStep, ...] = ()
    converged: bool = True
    made: Structure | None = None
    wish: Mapping[str, NDArray[np.float64]] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()
    supports: tuple[Support, ...] = ()
    force_unit: str = "N"
    length_unit: str = "m"

    @property
    def differences(self) -> dict[str, NDArray[np.float64]]:
        """Difference of forces from the wish by part, shape (cells,) [-]: a map of errors for `plot.contours`.

        It is the largest of a principal value, relative to the wish in its direction: w^-1/2 s w^-1/2 - 1. Zero where
        nothing is wished for.
        """
        none = {name: np.zeros(len(force)) for name, force in self.forces.items()}
        return none | {name: relative_difference(self.forces[name], wish) for name, wish in self.wish.items()}

    @property
    def structure(self) -> Structure:
        """The structure in this shape, with the forces as prestress.

        Raises:
            ValueError: The form is that of a net of force densities, without stiffness.
        """
        if self.made is None:
            raise ValueError(
                "The form of a net has no stiffness; make a Structure from its points, with Cable(branches, "
                'axial_stiffness, prestress=form.forces["net"]).'
            )
        return self.made

    def __repr__(self) -> str:
        shape = counted(len(self.points), "point") if self.made is None else repr(self.made)
        return f"Form({shape}, {counted(len(self.steps), 'step')}, converged={self.converged})"

    def _repr_html_(self) -> str:
        """Show the forces and a picture in notebooks."""
        forces = {name: np.reshape(values, (len(values), -1)) for name, values in self.forces.items()}
        rows = [[escape(name), str(len(f)), f"{f.min():.5g}", f"{f.max():.5g}"] for name, f in forces.items() if f.size]
        told = table(["part", "cells", "least component of force", "largest"], rows)
        return f"<b>{escape(repr(self))}</b>" + told + picture_html(self)

    def _repr_png_(self) -> bytes | None:
        """Show a picture where a notebook takes no HTML."""
        return picture_png(self)


def refuse_unfit(structure: Structure) -> None:
    """Refuse a structure with energy terms or natural shapes.

    Raises:
        ValueError: It has one.
    """
    natural_shape.refuse("Form finding", structure.parts)
    if structure.terms:
        raise ValueError(
            f"The structure has energy terms ({described(structure.terms[0])}), which form finding does not take; "
            "leave them out by dataclasses.replace(structure, terms=()), and add them to the form."
        )


def relative_difference(found: NDArray[np.float64], wish: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest principal value of w^-1/2 s w^-1/2 - 1, of tensors (cells, 2, 2) or forces (cells,), shape (cells,).

    Zero where the wish is no tension in all directions, or a force of zero.
    """
    if wish.ndim == 1:
        return np.abs(np.divide(found, wish, where=wish != 0, out=np.ones_like(found)) - 1)
    values, vectors = np.linalg.eigh(wish)
    wished = values[:, 0] > 0
    values = np.where(wished[:, None], values, 1.0)
    root = (vectors / np.sqrt(values)[:, None]) @ vectors.swapaxes(1, 2)
    size = np.abs(np.linalg.eigvalsh(root @ found @ root - np.eye(2))).max(axis=1)
    return np.where(wished, size, 0.0)
