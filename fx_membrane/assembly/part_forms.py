"""The energy of a part, its derivatives, and their compiled forms on the cells of this process."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem

from .. import _dolfinx
from ..forms import elasticity, inertia, kinematics, loads, stress, wrinkling
from ..model import laws
from ..model.parts import Part
from ..model.structure import Structure
from . import relaxation
from .discretization import PartMesh


@dataclass(frozen=True, eq=False)
class PartForms:
    """Symbols and compiled forms of one part on this process.

    Attributes:
        mesh: The cells.
        T, F, E, S: Tangent frame, deformation gradient, Green-Lagrange strain, 2nd Piola-Kirchhoff stress, in UFL.
        state: Taut, wrinkled or slack, numbered as in `forms.wrinkling`, in UFL; taut where all stiffness is kept.
        follow: Updates the wrinkling direction to the displacement.
        kept: Compression stiffness, as a fraction of the stiffness; None for a part with one energy only.
        q: Load per reference area or length, piecewise constant [N/m2 or N/m].
        p: Pressure along `Structure.normals`, piecewise constant [Pa]; without meaning in cables and masts.
        prestress: Prestress, row by row, piecewise constant [N/m or N].
        moduli: Numbers of the material by the name of their attribute; empty for a stress without elasticity.
        potential: Strain energy in UFL.
        energy: Compiled strain energy.
        residual: Compiled derivative of the energy, less the virtual work of p.
        tangent: Compiled derivative of the residual.
        load: Compiled virtual work of q.
        pressure: Compiled virtual work of p; None for cables and masts.
    """

    mesh: PartMesh
    T: Any
    F: Any
    E: Any
    S: Any
    state: Any
    follow: Callable[[], None]
    kept: fem.Constant | None
    q: fem.Function
    p: fem.Function
    prestress: fem.Function
    moduli: Mapping[str, fem.Constant]
    potential: Any
    energy: Any
    residual: Any
    tangent: Any
    load: Any
    pressure: Any
    _compiled: dict[str, Any] = field(default_factory=dict, repr=False)

    def compiled(self, name: str, make: Callable[["PartForms"], Any]) -> Any:
        """Return a further form or expression of this part, compiled by `make` on first use and kept by its name."""
        if name not in self._compiled:
            self._compiled[name] = make(self)
        return self._compiled[name]


class _Energy(NamedTuple):
    """Energy density and state of a part in UFL, update of its wrinkling direction, its numbers in the forms."""

    density: Any
    state: Any
    follow: Callable[[], None]
    kept: fem.Constant | None = None
    moduli: Mapping[str, fem.Constant] = {}


def part_forms(mesh: PartMesh, structure: Structure, elastic: bool) -> PartForms:
    """Forms of a part, Gil (43), (46); parts of a kind differ by data only, so that they share one compiled form."""
    part, u, d = mesh.part, mesh.u, mesh.part.dimension
    J = ufl.Jacobian(mesh.mesh)
    T = kinematics.membrane_frame(J, mesh.cell_field(structure.warp(mesh.name))) if d == 2 else kinematics.bar_frame(J)
    G = kinematics.displacement_gradient(u, T)
    F = kinematics.deformation_gradient(G, T)
    E = ufl.variable(kinematics.green_lagrange(G, T))
    prestress = mesh.cell_field(part.prestress_tensors())
    sigma0 = ufl.as_matrix([[prestress[d * i + j] for j in range(d)] for i in range(d)])
    w = _strain_energy(mesh, E, sigma0, prestress) if elastic else _prescribed_stress(E, sigma0)

    q, p = mesh.zero_field(3), mesh.zero_field(1)
    v = ufl.TestFunction(u.function_space)
    dx = ufl.Measure("dx", domain=mesh.mesh, metadata={"quadrature_degree": 1})  # exact: strains are constant per cell
    energy = w.density * dx
    residual = ufl.derivative(energy, u, v)
    pressure = loads.follower_pressure(p[0], F, v) * dx if d == 2 else None
    if pressure is not None:
        residual -= pressure
    tangent = ufl.derivative(residual, u, ufl.TrialFunction(u.function_space))
    return PartForms(
        mesh=mesh,
        T=T,
        F=F,
        E=E,
        S=stress.second_piola_kirchhoff(w.density, E),
        state=w.state,
        follow=w.follow,
        kept=w.kept,
        q=q,
        p=p,
        prestress=prestress,
        moduli=w.moduli,
        potential=energy,
        energy=_dolfinx.form(energy),
        residual=_dolfinx.form(residual),
        tangent=_dolfinx.form(tangent),
        load=_dolfinx.form(loads.distributed_load(q, v) * dx),
        pressure=pressure and _dolfinx.form(pressure),
    )


def mass_form(part: PartForms) -> Any:
    """Compiled work of the inertia forces of a part, its consistent mass matrix; the same in every state."""
    return part.compiled("mass", _mass_form)


def _mass_form(part: PartForms) -> Any:
    V = part.mesh.u.function_space
    m = fem.Constant(part.mesh.mesh, np.float64(part.mesh.part.mass))
    dx = ufl.Measure(
        "dx", domain=part.mesh.mesh, metadata={"quadrature_degree": 2}
    )  # exact: shape functions are linear
    return _dolfinx.form(inertia.inertia(m, ufl.TrialFunction(V), ufl.TestFunction(V)) * dx)


def tension_form(part: PartForms) -> Any:
    """Compiled stiffness against displacement gradients of a tension that equals the part's own stiffness."""
    V = part.mesh.u.function_space
    k = fem.Constant(part.mesh.mesh, np.float64(stiffness(part.mesh.part)))
    dx = ufl.Measure("dx", domain=part.mesh.mesh, metadata={"quadrature_degree": 1})  # exact: constant per cell
    gradients = [kinematics.displacement_gradient(v, part.T) for v in (ufl.TrialFunction(V), ufl.TestFunction(V))]
    return _dolfinx.form(k * ufl.inner(*gradients) * dx)


class DirectedForm(NamedTuple):
    """Compiled derivative of the residual by a parameter, and its direction: a change of the parameter."""

    form: Any
    direction: fem.Function | fem.Constant


def by_modulus(part: PartForms, name: str) -> DirectedForm:
    """Differentiate the residual by a number of the material."""

    def make(part: PartForms) -> DirectedForm:
        direction = fem.Constant(part.mesh.mesh, np.float64(1.0))
        modulus = ufl.variable(part.moduli[name])
        potential = ufl.diff(ufl.replace(part.potential, {part.moduli[name]: modulus}), modulus)
        v = ufl.TestFunction(part.mesh.u.function_space)
        return DirectedForm(_dolfinx.form(direction * ufl.derivative(potential, part.mesh.u, v)), direction)

    return part.compiled(f"by {name}", make)


def by_prestress(part: PartForms) -> DirectedForm:
    """Differentiate the residual by the prestress."""

    def make(part: PartForms) -> DirectedForm:
        direction = fem.Function(part.prestress.function_space)
        residual = ufl.derivative(part.potential, part.mesh.u, ufl.TestFunction(part.mesh.u.function_space))
        return DirectedForm(_dolfinx.form(ufl.derivative(residual, part.prestress, direction)), direction)

    return part.compiled("by prestress", make)


def stiffness(part: Part) -> float:
    """Typical stiffness of a part: for fabric the larger Et [N/m]; for cables and masts EA [N]."""
    return float(part.material.stiffness)


def _prescribed_stress(E: Any, sigma0: Any) -> _Energy:
    return _Energy(elasticity.strain_energy(E, sigma0, 0 * E), ufl.as_ufl(wrinkling.TAUT), relaxation.nothing)


def moduli(part: Part) -> dict[str, float]:
    """Numbers of the material of a part, by name."""
    return dict(laws.parameters(part.material, float)._asdict())


def _strain_energy(mesh: PartMesh, E: Any, sigma0: Any, prestress: fem.Function) -> _Energy:
    part, law = mesh.part, mesh.part.material
    parameters = laws.parameters(law, lambda value: fem.Constant(mesh.mesh, np.float64(value)))
    constants = parameters._asdict()
    full = law.energy(E, sigma0, parameters)
    if part.is_strut or laws.carries_compression(law, part.dimension):
        return _Energy(full, ufl.as_ufl(wrinkling.TAUT), relaxation.nothing, moduli=constants)
    relaxed, follow = relaxation.relaxed(mesh, E, sigma0, prestress, parameters)
    eta = fem.Constant(mesh.mesh, np.float64(part.compression_stiffness))
    state = ufl.conditional(ufl.lt(eta, 1), relaxed.state, wrinkling.TAUT)
    return _Energy(wrinkling.blend(relaxed.energy, full, eta), state, follow, eta, constants)
