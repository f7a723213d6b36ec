"""The physics of prestressed tension structures, as UFL functions of UFL operands.

One formula, one function; d = 2 is a membrane, d = 1 a cable or a mast, and the same functions serve both. The
reference configuration is the prestressed one, `X`; the displacement is `u`; the current position `x = X + u`. Stresses
are forces per length (d = 2, [N/m]) or forces (d = 1, [N]): they include the thickness or the cross-section. Equation
numbers, `Gil (40)`, are those of A. J. Gil, Computers & Structures 84 (2006) 1012-1028. `EQUATIONS` gives the place of
each, which names it in full; the hand-derived kernel has those that `ufl.derivative` yields.
"""

from __future__ import annotations

# Number in the paper: its meaning, and the function or method, which help("...") and pydoc show.
EQUATIONS = {
    "(12)": ("deformation gradient", "fx_membrane.forms.kinematics.deformation_gradient"),
    "(15)": ("linear part of the strain", "fx_membrane.forms.kinematics.green_lagrange"),
    "(17)": ("incremental Green-Lagrange strain", "fx_membrane.forms.kinematics.green_lagrange"),
    "(19)": ("Cauchy stress", "fx_membrane.forms.stress.cauchy"),
    "(31)": ("moduli in the prestressed state", "fx_membrane.forms.elasticity.isotropic"),
    "(32)": ("2nd Piola-Kirchhoff stress", "fx_membrane.forms.stress.second_piola_kirchhoff"),
    "(40)": ("strain energy per prestressed volume", "fx_membrane.forms.elasticity.strain_energy"),
    "(41)": ("current position", "fx_membrane.forms.kinematics.deformation_gradient"),
    "(42)": ("principle of virtual work", "fx_membrane.assembly.problem_under_actions.LoadedProblem.residual"),
    "(43)": ("internal virtual work, by ufl.derivative", "fx_membrane.assembly.forms_of_parts.part_forms"),
    "(44)": ("virtual work of the loads", "fx_membrane.forms.loads.distributed_load"),
    "(45)": ("linear shape functions", "fx_membrane._dolfinx.functionspace"),
    "(46)": ("internal nodal forces, by ufl.derivative", "fx_membrane.assembly.forms_of_parts.part_forms"),
    "(47)": ("external nodal forces", "fx_membrane.assembly.assembler.Assembler.nodal_loads"),
    "(48)": ("internal nodal forces as matrices", "fx_membrane.dccf.internal_force"),
    "(49)": ("external nodal forces as matrices", "fx_membrane.assembly.assembler.Assembler.nodal_loads"),
    "(50)": ("residual forces", "fx_membrane.assembly.problem_under_actions.LoadedProblem.residual"),
    "(51)": (
        "tangent stiffness, by ufl.derivative",
        "fx_membrane.assembly.problem_under_actions.LoadedProblem.tangent",
    ),
    "(52)": ("material part of the tangent", "fx_membrane.dccf.tangent"),
    "(53)": ("geometric part of the tangent", "fx_membrane.dccf.tangent"),
    "(54)": ("follower pressure along the current normal", "fx_membrane.forms.loads.follower_pressure"),
    "(55)": ("follower pressure by Nanson's rule", "fx_membrane.forms.loads.follower_pressure"),
    "(56)": ("follower pressure on a triangle", "fx_membrane.dccf.pressure_force"),
    "(57)": ("load stiffness of the pressure", "fx_membrane.dccf.pressure_tangent"),
    "(58)": ("displacement gradient", "fx_membrane.forms.kinematics.displacement_gradient"),
    "(59)": ("gradient from nodal displacements", "fx_membrane.dccf.elements"),
    "(60)": ("nodal displacements of an element as a vector", "fx_membrane.dccf.gradient"),
    "(61)": ("strains as a vector", "fx_membrane.dccf.core"),
    "(62)": ("strains from the gradient", "fx_membrane.dccf.core"),
    "(63)": ("stresses as a vector", "fx_membrane.dccf.core"),
    "(64)": ("core force and nodal forces", "fx_membrane.dccf.internal_force"),
    "(65)": ("tangent from core tangents", "fx_membrane.dccf.tangent"),
    "(66)": ("core tangents", "fx_membrane.dccf.core"),
    "(67)": ("stresses from prestress and strains", "fx_membrane.dccf.core"),
    "(68)": ("external potential energy", "fx_membrane.forms.loads.distributed_load"),
    "(69)": ("internal potential energy", "fx_membrane.forms.elasticity.strain_energy"),
    "(70)": ("total potential energy", "fx_membrane.assembly.problem_under_actions.LoadedProblem.energy"),
    "(71)": (
        "equilibrium: no slope of the energy",
        "fx_membrane.assembly.problem_under_actions.LoadedProblem.residual",
    ),
    "(72)": ("step along a direction", "fx_membrane.solvers.line_search.search"),
    "(73)": ("steepest descent", "fx_membrane.solvers.conjugate_gradient.Descent.turn"),
    "(74)": ("Newton-Raphson", "fx_membrane.solvers.newton_loop.NewtonLoop.step"),
    "(75)": ("first direction of conjugate gradients", "fx_membrane.solvers.conjugate_gradient.Descent.turn"),
    "(76)": ("next direction of conjugate gradients", "fx_membrane.solvers.conjugate_gradient.Descent.turn"),
    "(77)": ("Polak-Ribiere; Fletcher-Reeves beside it", "fx_membrane.solvers.conjugate_directions.polak_ribiere"),
}

# Not computed: strains and stresses from the unstressed state, the strong form, and steps that lead to (32) and (40).
NOT_NEEDED = {
    *("(13)", "(14)", "(16)", "(18)", "(20)", "(21)", "(22)", "(23)", "(24)", "(25)", "(26)", "(27)", "(28)", "(29)"),
    *("(30)", "(33)", "(34)", "(35)", "(36)", "(37)", "(38)", "(39)"),
}
