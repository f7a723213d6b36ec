"""Energy terms of a user: their compiled forms, and their sums over the parts of this process.

Terms whose integrals are equal in UFL share one form. Before it is assembled, its coefficients get the factor and the
parameters of the term.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc as fem_petsc
from numpy.typing import NDArray
from petsc4py import PETSc

from .. import _dolfinx
from ..forms.energy_terms import State
from ..model import energy_terms, term_parameters
from ..model.energy_terms import Acting
from ..model.term_trial import Kinds, integral, named
from .directed_forms import DirectedForm
from .discretization import Discretization, PartMesh
from .forms_of_parts import PartForms


class _Symbols:
    """Weight of the cells and parameters of terms on a part, as coefficients."""

    def __init__(self, mesh: PartMesh, kinds: Kinds):
        self._count = len(mesh.part.cells)
        self._mesh, self._acting = mesh, Acting(None, 0.0)
        self.weight = mesh.zero_field(1)
        self.fields: dict[str, fem.Constant | fem.Function] = {}
        for name, kind, size in kinds:
            self.fields[name] = self._zero(kind, size)
        single = {name for name, kind, size in kinds if kind == "cells" and size == 1}
        self.parameters = named({name: f[0] if name in single else f for name, f in self.fields.items()})

    def _zero(self, kind: str, size: int) -> fem.Constant | fem.Function:
        """Coefficient for a parameter of a kind, zero."""
        if kind == "constant":
            return fem.Constant(self._mesh.mesh, np.zeros((size,) if size > 1 else ()))
        return self._mesh.zero_field(size)

    def like(self, name: str) -> fem.Constant | fem.Function:
        """Make a coefficient like that of a parameter, zero."""
        symbol = self.fields[name]
        if isinstance(symbol, fem.Function):
            return self._zero("cells", symbol.ufl_shape[0])
        return self._zero("constant", (*symbol.ufl_shape, 1)[0])

    def write(self, symbol: fem.Constant | fem.Function, value: NDArray[np.float64]) -> None:
        """Set a coefficient to a number, a vector, or rows of all cells of the part."""
        if isinstance(symbol, fem.Function):
            symbol.x.array[:] = value[self._mesh.cell_rows].ravel()
        else:
            symbol.value = value

    def set(self, acting: Acting) -> None:
        """Set the coefficients to the factor and the parameters of a term."""
        if acting.term is self._acting.term and acting.factor == self._acting.factor:
            return
        weight = np.zeros(self._count)
        weight[term_parameters.chosen(acting.term, self._count)] = acting.factor
        self.weight.x.array[:] = weight[self._mesh.cell_rows]
        for name, value in term_parameters.values(acting.term, self._count).items():
            self.write(self.fields[name], value)
        self._acting = acting


@dataclass(frozen=True, eq=False)
class _Forms:
    """Forms of terms on a part, compiled on first use.

    Attributes:
        mesh: The part.
        symbols: Their coefficients.
        integral: Energy or virtual work in UFL.
        conservative: True if it is an energy.
    """

    mesh: PartMesh
    symbols: _Symbols
    integral: ufl.Form
    conservative: bool
    _by_parameter: dict[str, DirectedForm] = field(default_factory=dict, repr=False)

    @cached_property
    def energy(self) -> Any:
        """Compiled energy."""
        return _dolfinx.form(self.integral)

    @cached_property
    def work(self) -> Any:
        """Compiled virtual work of the forces."""
        return _dolfinx.form(self._work)

    @cached_property
    def tangent(self) -> Any:
        """Compiled derivative of the residual, which is minus the virtual work."""
        u = self.mesh.u
        return _dolfinx.form(ufl.derivative(-self._work, u, ufl.TrialFunction(u.function_space)))

    def by_parameter(self, name: str, change: NDArray[np.float64]) -> Any:
        """Compiled derivative of the residual along a change of a parameter, shaped as by `term_parameters.values`."""
        if name not in self._by_parameter:
            symbol, direction = self.symbols.fields[name], self.symbols.like(name)
            length = ufl.variable(fem.Constant(self.mesh.mesh, np.float64(0.0)))
            moved = ufl.diff(ufl.replace(self.integral, {symbol: symbol + length * direction}), length)
            derivative = ufl.derivative(moved, self.mesh.u, _v(self.mesh)) if self.conservative else -moved
            self._by_parameter[name] = DirectedForm(_dolfinx.form(derivative), direction)
        found = self._by_parameter[name]
        self.symbols.write(found.direction, change)
        return found.form

    @property
    def _work(self) -> ufl.Form:
        return -ufl.derivative(self.integral, self.mesh.u, _v(self.mesh)) if self.conservative else self.integral


class TermChange(NamedTuple):
    """Change of a parameter of an energy term.

    Attributes:
        acting: The term and its factor.
        parameter: Name of the parameter.
        values: The change on all cells of the part, in the shape of `model.term_parameters.values`.
    """

    acting: Acting
    parameter: str
    values: NDArray[np.float64]


class TermPool:
    """Forms of energy terms on the parts of this process, made when a term is first met.

    Args:
        discretization: The meshes and their common numbering.
        parts: Forms of the parts of which this process has cells.
    """

    def __init__(self, discretization: Discretization, parts: Mapping[str, PartForms]):
        self.discretization, self.parts = discretization, parts
        self._of_term: dict[int, tuple[Any, _Forms | None]] = {}  # by identity; the term is kept, and so its identity
        self._symbols: dict[tuple[str, Kinds], _Symbols] = {}
        self._shared: dict[tuple[ufl.Form, bool], _Forms] = {}

    def check(self, term: Any) -> None:
        """Refuse a term that does not fit the structure, when it is first met."""
        if id(term) not in self._of_term:
            energy_terms.check_on(self.discretization.structure, "Actions", term)
            self._of_term[id(term)] = term, self._made(term)

    def forms(self, acting: Acting) -> _Forms | None:
        """Forms of a term with its coefficients; None if this process has no cell of its part."""
        found = self._of_term[id(acting.term)][1]
        if found is not None:
            found.symbols.set(acting)
        return found

    def _made(self, term: Any) -> _Forms | None:
        if term.part not in self.parts:
            return None
        part, kinds = self.parts[term.part], term_parameters.kinds(term)
        mesh = part.mesh
        key = term.part, kinds
        if key not in self._symbols:
            self._symbols[key] = _Symbols(mesh, kinds)
        symbols = self._symbols[key]
        state = State(mesh.u, ufl.SpatialCoordinate(mesh.mesh), part.F)
        form = integral(term, state, symbols.parameters, symbols.weight[0], _v(mesh), mesh.mesh)
        conservative = energy_terms.is_conservative(term)
        return self._shared.setdefault((form, conservative), _Forms(mesh, symbols, form, conservative))


@dataclass(frozen=True, eq=False)
class Terms:
    """Energy terms that act in a problem.

    Attributes:
        pool: Their forms.
        standing: Terms of the structure, in full.
        applied: Terms of the actions, with factors other than zero.
    """

    pool: TermPool
    standing: tuple[Acting, ...]
    applied: tuple[Acting, ...]

    @property
    def all(self) -> tuple[Acting, ...]:
        """Terms of the structure and of the actions."""
        return self.standing + self.applied

    @property
    def without_potential(self) -> tuple[Acting, ...]:
        """Terms that have a virtual work only."""
        return tuple(acting for acting in self.all if not energy_terms.is_conservative(acting.term))

    def energy(self) -> float:
        """Energy on this process, of terms that have one [J]."""
        return sum(map(self.energy_of, self.all))

    def energy_of(self, acting: Acting) -> float:
        """Energy of a term on this process [J]; 0 for one without a potential."""
        forms = self.pool.forms(acting) if energy_terms.is_conservative(acting.term) else None
        return float(fem.assemble_scalar(forms.energy)) if forms else 0.0

    def forces(self, terms: Iterable[Acting], b: PETSc.Vec) -> PETSc.Vec:
        """Set a vector to the nodal forces of some terms [N]; collective."""
        b.set(0.0)
        found = (forms for forms in map(self.pool.forms, terms) if forms)
        self.pool.discretization.scatter_add(((forms.mesh, _vector(forms.mesh, forms.work)) for forms in found), b)
        return b

    def add_forces(self, terms: Sequence[Acting], b: PETSc.Vec, factor: float = 1.0) -> None:
        """Add the nodal forces of some terms, times a factor, to a vector [N]; collective."""
        if terms:
            with self.pool.discretization.work(1) as (forces,):
                b.axpy(factor, self.forces(terms, forces))

    def derivative(self, change: TermChange, b: PETSc.Vec) -> PETSc.Vec:
        """Set a vector to the derivative of the residual along a change of a term; collective."""
        b.set(0.0)
        forms = self.pool.forms(change.acting)
        made = forms and forms.by_parameter(change.parameter, change.values)
        shares = iter([(forms.mesh, _vector(forms.mesh, made))] if forms else [])
        self.pool.discretization.scatter_add(shares, b)
        return b

    def add_tangent(self, A: PETSc.Mat) -> None:
        """Add the derivatives of the residual to a tangent [N/m]; collective."""
        for acting in self.all:
            forms = self.pool.forms(acting)
            if forms:
                A.setLGMap(forms.mesh.lgmap, forms.mesh.lgmap)
                fem_petsc.assemble_matrix(A, forms.tangent)
            else:  # end of assemble_matrix, together on all processes
                A.assemble(PETSc.Mat.AssemblyType.FLUSH)
        if self.all:
            A.assemble()


def terms_of(pool: TermPool, actions: Iterable[Acting]) -> Terms:
    """Energy terms of a structure and of actions; all are checked on first use."""
    standing = tuple(Acting(term, 1.0) for term in pool.discretization.structure.terms)
    applied = tuple(acting for acting in actions if acting.factor)
    for acting in standing + applied:
        pool.check(acting.term)
    return Terms(pool, standing, applied)


def _v(mesh: PartMesh) -> Any:
    return ufl.TestFunction(mesh.u.function_space)


def _vector(mesh: PartMesh, form: Any) -> NDArray[np.float64]:
    values = np.zeros(len(mesh.u.x.array))
    fem.assemble_vector(values, form)
    return values
