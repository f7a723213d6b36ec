"""The energy of a part, its derivatives, and their compiled forms on the cells of this process."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from numpy.typing import NDArray

from .. import _dolfinx
from ..forms import elasticity, kinematics, loads, natural_shape, rope, stress, wrinkling
from ..model import laws
from ..model.parts import Part
from ..model.structure import Structure
from . import relaxation
from .discretization import PartMesh
from .kinds_of_forms import NO_KIND, Kind, kind_of, named
from .ropes import RopeState


@dataclass(frozen=True, eq=False)
class PartForms:
    """Symbols and compiled forms of one part on this process.

    Attributes:
        mesh: The cells.
        T, F: Tangent frame and deformation gradient in UFL.
        E: Green-Lagrange strain with respect to the natural shape, in UFL.
        S: 2nd Piola-Kirchhoff stress with respect to the reference shape, in UFL.
        state: Taut, wrinkled or slack, numbered as in `forms.wrinkling`, in UFL; taut where all stiffness is kept.
        update: Adapts the wrinkling direction to the displacement.
        compression_stiffness: That of the part, as a fraction of the stiffness; None for one with a single energy.
        q: Load per reference area or length, piecewise constant [N/m2 or N/m].
        p: Pressure along `Structure.normals`, piecewise constant [Pa]; without meaning in cables and masts.
        prestress: Prestress, row by row, piecewise constant [N/m or N].
        natural: Natural shape, H of `forms.natural_shape` row by row, piecewise constant [-]; None for the reference
            shape.
        tensions: Share of the law, and force beside it [N], of cables whose force stages may give, piecewise constant;
            None for others.
        elastic: False if the prestress is the only stress.
        moduli: Numbers of the material by the name of their attribute; empty for a stress without elasticity.
        potential: Strain energy in UFL.
        energy: Compiled strain energy.
        residual: Compiled derivative of the energy, less the virtual work of p.
        tangent: Compiled derivative of the residual.
        load: Compiled virtual work of q.
        pressure: Compiled virtual work of p; None for cables and masts.
        kind: All that the formulas depend on, numbers aside; see `kind_of`.
        rope: State of a rope, in the forms; None for other parts. The energy of a rope is that of its length, which the
            forms do not have: its `energy` is the elongation.
    """

    mesh: PartMesh
    T: Any
    F: Any
    E: Any
    S: Any
    state: Any
    update: Callable[[], None]
    compression_stiffness: fem.Constant | None
    q: fem.Function
    p: fem.Function
    prestress: fem.Function
    natural: fem.Function | None
    tensions: fem.Function | None
    elastic: bool
    moduli: Mapping[str, fem.Constant]
    potential: Any
    energy: Any
    residual: Any
    tangent: Any
    load: Any
    pressure: Any
    kind: Kind
    rope: RopeConstants | None = None
    _compiled: dict[str, Any] = field(default_factory=dict, repr=False)
    _altered: list[str] = field(default_factory=list, repr=False)  # data that differ from those of the part

    def set_natural_shape(self, H: NDArray[np.float64] | None) -> None:
        """Set the natural shape of the cells of this process, shape (cells, d, d) [-]; None for the reference shape."""
        if self.natural is not None:
            self.natural.x.array[:] = 0.0 if H is None else H.ravel()

    def set_tensions(self, tensions: NDArray[np.float64] | None) -> None:
        """Set share of the law and force of the cells of this process, shape (cells, 2); None for the law alone."""
        if self.tensions is not None:
            self.tensions.x.array[:] = np.tile([1.0, 0.0], len(self.mesh.cell_rows))
            if tensions is not None:
                self.tensions.x.array[:] = tensions.ravel()

    def set_prestress(self, sigma0: NDArray[np.float64] | None) -> None:
        """Set the prestress of the cells of this process, shape (cells, d, d) [N/m or N]; None for the part's own."""
        if sigma0 is not None:
            self.prestress.x.array[:] = sigma0.ravel()
            self._altered.append("prestress")
        elif self._altered:
            self.prestress.x.array[:] = self.mesh.part.prestress_tensors()[self.mesh.cell_rows].ravel()
            self._altered.clear()

    def compiled(self, name: str, make: Callable[[PartForms], Any]) -> Any:
        """Return a further form or expression of this part, compiled by `make` on first use and kept by its name."""
        if name not in self._compiled:
            self._compiled[name] = make(self)
        return self._compiled[name]


class RopeConstants(NamedTuple):
    """State of a rope in its forms: tension [N], strain [-], taut or slack; and derivative of the length in UFL."""

    tension: fem.Constant
    strain: fem.Constant
    state: fem.Constant
    length: Any


class _Energy(NamedTuple):
    """Energy density and state of a part in UFL, update of its wrinkling direction, its numbers in the forms."""

    density: Any
    state: Any
    update: Callable[[], None]
    compression_stiffness: fem.Constant | None = None
    moduli: Mapping[str, fem.Constant] = {}


def part_forms(
    mesh: PartMesh, structure: Structure, elastic: bool = True, natural: bool = False, given: bool = False
) -> PartForms:
    """Forms of a part, Gil (43), (46); parts of a kind differ by data only, so that they share one compiled form.

    Args:
        mesh: The cells.
        structure: The structure.
        elastic: False keeps the prestress as the only stress.
        natural: True for a natural shape, which stages may change.
        given: True for cables whose force stages may give.
    """
    part, u, d = mesh.part, mesh.u, mesh.part.dimension
    if part.shares_tension:
        return _rope_forms(mesh)
    T, F, E = _kinematics(mesh, mesh.cell_field(structure.warp(mesh.name)) if d == 2 else None)
    shape = mesh.zero_field(d * d) if natural else None
    H = None if shape is None else _tensor(shape, d)
    E_e = E if H is None else ufl.variable(natural_shape.elastic_strain(E, H))
    prestress = mesh.cell_field(part.prestress_tensors())
    sigma0, v = _tensor(prestress, d), ufl.TestFunction(u.function_space)
    w = _strain_energy(mesh, E_e, sigma0, prestress) if elastic else _prescribed_stress(E, sigma0)
    density = w.density if H is None else natural_shape.measure_ratio(H) * w.density
    state, tensions = w.state, mesh.zero_field(2) if given else None
    if tensions is not None:
        density, state, E_e = _with_given_force(part, tensions, density, state, E, E_e)
    q, p = mesh.zero_field(3), mesh.zero_field(1)
    dx = ufl.Measure("dx", domain=mesh.mesh, metadata={"quadrature_degree": 1})  # exact: strains are constant per cell
    energy = density * dx
    residual = ufl.derivative(energy, u, v)
    if pressure := loads.follower_pressure(p[0], F, v) * dx if d == 2 else None:
        residual -= pressure
    tangent = ufl.derivative(residual, u, ufl.TrialFunction(u.function_space))
    kind = NO_KIND if given else kind_of(part, elastic, natural)  # forces are compared with a stiffness in numbers
    return PartForms(
        mesh=mesh,
        T=T,
        F=F,
        E=E_e,
        S=stress.second_piola_kirchhoff(density, E),
        state=state,
        update=w.update,
        compression_stiffness=w.compression_stiffness,
        q=q,
        p=p,
        prestress=prestress,
        natural=shape,
        tensions=tensions,
        elastic=elastic,
        moduli=w.moduli,
        potential=energy,
        energy=_dolfinx.form(energy, named("energy", kind)),
        residual=_dolfinx.form(residual, named("residual", kind)),
        tangent=_dolfinx.form(tangent, named("tangent", kind)),
        load=_dolfinx.form(loads.distributed_load(q, v) * dx, named("load", kind)),
        pressure=pressure and _dolfinx.form(pressure, named("pressure", kind)),
        kind=kind,
    )


def _kinematics(mesh: PartMesh, warp: fem.Function | None) -> tuple[Any, Any, Any]:
    """Tangent frame, of the warp for a membrane, deformation gradient and Green-Lagrange strain in UFL."""
    J = ufl.Jacobian(mesh.mesh)
    T = kinematics.bar_frame(J) if warp is None else kinematics.membrane_frame(J, warp)
    G = kinematics.displacement_gradient(mesh.u, T)
    return T, kinematics.deformation_gradient(G, T), ufl.variable(kinematics.green_lagrange(G, T))


def _tensor(values: fem.Function, d: int) -> Any:
    """Tensor of values per cell in UFL, shape (d, d)."""
    return ufl.as_matrix([[values[d * i + j] for j in range(d)] for i in range(d)])


def _with_given_force(
    part: Part, tensions: fem.Function, density: Any, state: Any, E: Any, E_e: Any
) -> tuple[Any, Any, Any]:
    """Energy density, state and elastic strain of cables with a share of their law and a force beside it."""
    tensions.x.array[::2] = 1.0
    share, force = tensions[0], tensions[1]
    return (
        share * density + force * rope.current_length(E),
        ufl.conditional(ufl.gt(force, 0), wrinkling.TAUT, state),
        share * E_e + ufl.as_matrix([[force / stiffness(part)]]),
    )


def _rope_forms(mesh: PartMesh) -> PartForms:
    """Forms of a rope, whose tension is a constant that its length decides."""
    u, V = mesh.u, mesh.u.function_space
    v, kind = ufl.TestFunction(V), kind_of(mesh.part)
    T, F, E = _kinematics(mesh, None)
    tension, strain, state = (fem.Constant(mesh.mesh, np.float64(0.0)) for _ in range(3))
    dx = ufl.Measure("dx", domain=mesh.mesh, metadata={"quadrature_degree": 1})  # exact: strains are constant per cell
    length, q = rope.current_length(E), mesh.zero_field(3)
    residual = ufl.derivative(tension * length * dx, u, v)
    return PartForms(
        mesh=mesh,
        T=T,
        F=F,
        E=ufl.as_matrix([[strain]]),
        S=stress.second_piola_kirchhoff(tension * length, E),
        state=state,
        update=relaxation.no_update,
        compression_stiffness=None,
        q=q,
        p=mesh.zero_field(1),
        prestress=mesh.cell_field(mesh.part.prestress_tensors()),
        natural=mesh.zero_field(1),
        tensions=None,
        elastic=True,
        moduli={},
        potential=tension * length * dx,
        energy=_dolfinx.form(rope.elongation(E) * dx, named("energy", kind)),
        residual=_dolfinx.form(residual, named("residual", kind)),
        tangent=_dolfinx.form(ufl.derivative(residual, u, ufl.TrialFunction(V)), named("tangent", kind)),
        load=_dolfinx.form(loads.distributed_load(q, v) * dx, named("load", kind)),
        pressure=None,
        kind=kind,
        rope=RopeConstants(tension, strain, state, ufl.derivative(length * dx, u, v)),
    )


def set_rope(part: PartForms, state: RopeState) -> None:
    """Set the state of a rope in its forms."""
    assert part.rope
    share, force = state.data.share, state.data.force
    part.rope.tension.value = state.tension
    part.rope.strain.value = share * state.strain + force / stiffness(part.mesh.part)
    part.rope.state.value = wrinkling.SLACK if state.slack else wrinkling.TAUT


def stiffness(part: Part) -> float:
    """Typical stiffness of a part: for fabric the larger Et [N/m]; for cables and masts EA [N]."""
    return float(part.material.stiffness)


def _prescribed_stress(E: Any, sigma0: Any) -> _Energy:
    return _Energy(elasticity.strain_energy(E, sigma0, 0 * E), ufl.as_ufl(wrinkling.TAUT), relaxation.no_update)


def moduli(part: Part) -> dict[str, float]:
    """Numbers of the material of a part, by name."""
    return dict(laws.parameters(part.material, float)._asdict())


def _strain_energy(mesh: PartMesh, E: Any, sigma0: Any, prestress: fem.Function) -> _Energy:
    part, law = mesh.part, mesh.part.material
    parameters = laws.parameters(law, lambda value: fem.Constant(mesh.mesh, np.float64(value)))
    constants = parameters._asdict()
    full = law.energy(E, sigma0, parameters)
    if part.is_strut or laws.carries_compression(law, part.dimension):
        return _Energy(full, ufl.as_ufl(wrinkling.TAUT), relaxation.no_update, moduli=constants)
    relaxed, update = relaxation.relaxed(mesh, E, sigma0, prestress, parameters)
    eta = fem.Constant(mesh.mesh, np.float64(part.compression_stiffness))
    state = ufl.conditional(ufl.lt(eta, 1), relaxed.state, wrinkling.TAUT)
    return _Energy(wrinkling.blend(relaxed.energy, full, eta), state, update, eta, constants)
