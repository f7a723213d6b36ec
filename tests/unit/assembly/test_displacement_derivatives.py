"""Derivatives of the displacement by moduli and load factors, from the tangent and derivatives of the residual."""

from dataclasses import replace

import numpy as np
import pytest
from petsc4py import PETSc

from fx_membrane import (
    Analysis,
    Fabric,
    Membrane,
    PointLoad,
    PrescribedDisplacement,
    Pressure,
    Stage,
    Structure,
    Support,
)
from models import CENTRE, EDGE, inclined_sheet


def solved(K, b):
    """Solution of K s = b."""
    ksp, s = PETSc.KSP().create(K.comm), b.duplicate()
    ksp.setOperators(K)
    ksp.setType("preonly")
    ksp.getPC().setType("lu")
    ksp.getPC().setFactorSolverType("mumps")
    ksp.solve(b, s)
    ksp.destroy()
    return s


@pytest.mark.mpi
def test_derivative_of_the_displacement_by_a_modulus():
    """The recipe of the documentation, against states of stiffer fabrics."""

    def state(Et):
        fabric = Membrane(inclined_sheet().parts["fabric"].cells, Fabric(Et, 0.3), prestress=1e3)
        structure = Structure(inclined_sheet().points, {"fabric": fabric}, [Support(EDGE)])
        loads = [PointLoad(CENTRE, (0, 0, -100.0)), Pressure(200.0, "fabric")]
        return Analysis(structure, progress=False).run([Stage("snow", loads)])["snow"]

    here = state(1e5)
    problem = here.problem
    loaded, x = problem.under(here.actions), problem.to_petsc(here.displacement)
    K, dR = loaded.tangent(x), loaded.derivative(x, "fabric", "Et")
    loaded.constraints.zero_constrained(dR)
    loaded.constraints.constrain_tangent(x, K, dR)
    du = -problem.to_numpy(solved(K, dR))
    assert not du[here.actions.held].any()
    h = 1e5 * np.array([4e-3, 2e-3, 1e-3])
    errors = [np.abs(state(1e5 + step).displacement - here.displacement - step * du).max() for step in h]
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, rtol=0, atol=0.1)


@pytest.mark.mpi
def test_derivative_of_the_displacement_by_a_load_factor_with_moving_supports():
    lift = Stage("lift", [PointLoad(7, (0, 0, 20.0))], displacements=[PrescribedDisplacement(CENTRE, (0, 0, 0.1))])
    analysis = Analysis(inclined_sheet())
    here = analysis.run([lift])["lift"]
    problem, start = analysis.problem, analysis.problem.under().actions
    loaded, x = problem.under(here.actions), problem.to_petsc(here.displacement)
    K, dR = loaded.tangent(x), loaded.load_derivative(x, start)
    loaded.under(here.actions.less(start)).constraints.constrain_tangent(problem.create_vector(), K, dR)
    du = -problem.to_numpy(solved(K, dR))
    assert du[CENTRE] == pytest.approx([0, 0, 0.1])
    errors = []
    for h in (4e-2, 2e-2, 1e-2):
        more = replace(
            lift,
            loads=[PointLoad(7, (0, 0, 20.0 * (1 + h)))],
            displacements=[PrescribedDisplacement(CENTRE, (0, 0, 0.1 * (1 + h)))],
        )
        errors.append(np.abs(analysis.run([more])["lift"].displacement - here.displacement - h * du).max())
    np.testing.assert_allclose(np.log2(np.divide(errors[:-1], errors[1:])), 2, rtol=0, atol=0.2)
