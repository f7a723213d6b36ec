"""Relaxed energies of parts that wrinkle or go slack, and the update of those that follow the strain.

A law brings a formula. The woven one needs a direction. Other wrinkles are found from the energy alone. The kind of a
law is asked for here, and nowhere else.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .. import _dolfinx
from ..forms import tension_field as forms
from ..forms.wrinkling import Relaxed
from ..model import laws
from ..model.fabrics import OrthotropicFabric
from . import tension_field, wrinkling_direction
from .discretization import PartMesh

Array = NDArray[np.float64]


class Relaxation(NamedTuple):
    """Relaxed energy and state in UFL, and the update of what they hold constant to the displacement."""

    relaxed: Relaxed
    update: Callable[[], None]


def no_update() -> None:
    """Leave energies as they are that hold nothing constant."""


def relaxed(mesh: PartMesh, E: Any, sigma0: Any, prestress: fem.Function, parameters: Any) -> Relaxation:
    """Relaxed energy of a part.

    Args:
        mesh: The cells.
        E: Green-Lagrange strain in UFL, shape (d, d).
        sigma0: Prestress in UFL, shape (d, d).
        prestress: The function that sigma0 is made of.
        parameters: Constants of the law, by name.
    """
    law = mesh.part.material
    if type(law) is OrthotropicFabric:
        return _woven(mesh, law, E, sigma0, parameters)
    formula = laws.member(law, "relaxed_energy")
    if formula is not None:
        return Relaxation(formula(E, sigma0, parameters), no_update)
    return _tension_field(mesh, E, sigma0, prestress, parameters)


def _woven(mesh: PartMesh, fabric: OrthotropicFabric, E: Any, sigma0: Any, parameters: Any) -> Relaxation:
    """Relaxed energy with the direction of the tension, solved for where the fabric may wrinkle."""
    angle = mesh.zero_field(1)
    e = E + fabric.elastic_strain(sigma0, parameters)
    strains = _dolfinx.cell_expression(ufl.as_vector(forms.components(e)), mesh.mesh)

    def update() -> None:
        values = strains()
        cells = np.flatnonzero(wrinkling_direction.may_wrinkle(values, fabric))
        angle.x.array[cells] = wrinkling_direction.direction(values[cells], fabric)

    return Relaxation(fabric.relaxed_energy(E, sigma0, parameters, angle[0]), update)


def _tension_field(mesh: PartMesh, E: Any, sigma0: Any, prestress: fem.Function, parameters: Any) -> Relaxation:
    """Relaxed energy with the wrinkle strains of the cells, found from the energy."""
    law, size = mesh.part.material, len(forms.components(E))
    b, K, state, trial = (mesh.zero_field(n) for n in (size, size**2, 1, size))
    e = ufl.variable(forms.tensor(trial))
    g = ufl.variable(forms.gradient(law.energy(e, sigma0, parameters), e))
    hessian = [ufl.diff(g[i], e) for i in range(size)]
    entries = [*(g[i] for i in range(size)), *(entry for row in hessian for entry in forms.components(row))]
    compiled = _dolfinx.cell_expression(ufl.as_vector(entries), mesh.mesh)
    strains = _dolfinx.cell_expression(ufl.as_vector(forms.components(E)), mesh.mesh)
    weights = np.array([1.0, 1.0, 2.0])[:size]  # E12 stands at two places of E

    def derivatives(
        cells: NDArray[np.int64], e: tension_field.Array
    ) -> tuple[tension_field.Array, tension_field.Array]:
        trial.x.array.reshape(-1, size)[cells] = e
        values = compiled(cells)
        return values[:, :size], values[:, size:].reshape(-1, size, size) * weights

    known: dict[str, Array] = {}  # strains and prestress of the wrinkles, and the strains without stress

    def update() -> None:
        now = strains()
        if not known or not np.array_equal(known["prestress"], prestress.x.array):
            known["prestress"] = prestress.x.array.copy()
            known["natural"] = tension_field.natural_strains(derivatives, len(now), size)
        elif np.array_equal(known["strains"], now):
            return
        known["strains"] = now
        found = tension_field.wrinkles(derivatives, now, known["natural"])
        b.x.array[:], K.x.array[:] = found.strain.ravel(), found.compliance.ravel()
        state.x.array[:] = found.state

    energy = forms.relaxed_energy(lambda e: law.energy(e, sigma0, parameters), E, b, K)
    # With all stiffness kept, the relaxed energy does not count: no wrinkles, and none looked for.
    return Relaxation(Relaxed(energy, state[0]), no_update if mesh.part.carries_compression else update)
