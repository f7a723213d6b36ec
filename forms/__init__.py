"""The physics of prestressed tension structures, as UFL functions of UFL operands.

One formula, one function; d = 2 is a membrane, d = 1 a cable or a mast, and the same functions serve both. The
reference configuration is the prestressed one, `X`; the displacement is `u`; the current position `x = X + u`. Stresses
are forces per length (d = 2, [N/m]) or forces (d = 1, [N]): they include the thickness or the cross-section. Equation
numbers, `Gil (40)`, are those of A. J. Gil, Computers & Structures 84 (2006) 1012-1028. `EQUATIONS` gives the place of
each; the hand-derived kernel has in full those that `ufl.derivative` yields.
"""

# Number in the paper: its meaning, and its place in the code.
EQUATIONS = {
    "(12)": ("deformation gradient", "forms.kinematics.deformation_gradient"),
    "(15)": ("linear part of the strain", "forms.kinematics.green_lagrange"),
    "(17)": ("incremental Green-Lagrange strain", "forms.kinematics.green_lagrange"),
    "(19)": ("Cauchy stress", "forms.stress.cauchy"),
    "(31)": ("moduli in the prestressed state", "forms.elasticity.isotropic"),
    "(32)": ("2nd Piola-Kirchhoff stress", "forms.stress.second_piola_kirchhoff"),
    "(40)": ("strain energy per prestressed volume", "forms.elasticity.strain_energy"),
    "(41)": ("current position", "forms.kinematics.deformation_gradient"),
    "(42)": ("principle of virtual work", "assembly.loaded_problem.LoadedProblem.residual"),
    "(43)": ("internal virtual work, by ufl.derivative", "assembly.part_forms.part_forms"),
    "(44)": ("virtual work of the loads", "forms.loads.distributed_load"),
    "(45)": ("linear shape functions", "_dolfinx.functionspace"),
    "(46)": ("internal nodal forces, by ufl.derivative", "assembly.part_forms.part_forms"),
    "(47)": ("external nodal forces", "assembly.assembler.Assembler.nodal_loads"),
    "(48)": ("internal nodal forces as matrices", "dccf.internal_force"),
    "(49)": ("external nodal forces as matrices", "assembly.assembler.Assembler.nodal_loads"),
    "(50)": ("residual forces", "assembly.loaded_problem.LoadedProblem.residual"),
    "(51)": ("tangent stiffness, by ufl.derivative", "assembly.loaded_problem.LoadedProblem.tangent"),
    "(52)": ("material part of the tangent", "dccf.tangent"),
    "(53)": ("geometric part of the tangent", "dccf.tangent"),
    "(54)": ("follower pressure along the current normal", "forms.loads.follower_pressure"),
    "(55)": ("follower pressure by Nanson's rule", "forms.loads.follower_pressure"),
    "(56)": ("follower pressure on a triangle", "dccf.pressure_force"),
    "(57)": ("load stiffness of the pressure", "dccf.pressure_tangent"),
    "(58)": ("displacement gradient", "forms.kinematics.displacement_gradient"),
    "(59)": ("gradient from nodal displacements", "dccf.elements"),
    "(60)": ("nodal displacements of an element", "dccf.elements"),
    "(61)": ("strains as a vector", "dccf.core"),
    "(62)": ("strains from the gradient", "dccf.core"),
    "(63)": ("stresses as a vector", "dccf.core"),
    "(64)": ("core force and nodal forces", "dccf.internal_force"),
    "(65)": ("tangent from core tangents", "dccf.tangent"),
    "(66)": ("core tangents", "dccf.core"),
    "(67)": ("stresses from prestress and strains", "dccf.core"),
    "(68)": ("external potential energy", "forms.loads.distributed_load"),
    "(69)": ("internal potential energy", "forms.elasticity.strain_energy"),
    "(70)": ("total potential energy", "assembly.loaded_problem.LoadedProblem.energy"),
    "(71)": ("equilibrium as a minimum", "solvers.newton.Newton"),
    "(72)": ("step along a direction", "solvers.line_search.search"),
    "(73)": ("steepest descent", "solvers.conjugate_gradient.SteepestDescent"),
    "(74)": ("Newton-Raphson", "solvers.newton.Newton"),
    "(75)": ("first direction of conjugate gradients", "solvers.conjugate_gradient.ConjugateGradient"),
    "(76)": ("next direction of conjugate gradients", "solvers.conjugate_gradient.ConjugateGradient"),
    "(77)": ("Fletcher-Reeves and Polak-Ribiere", "solvers.conjugate_gradient.ConjugateGradient"),
}

# Not computed: strains and stresses from the unstressed state, the strong form, and steps that lead to (32) and (40).
NOT_NEEDED = {
    *("(13)", "(14)", "(16)", "(18)", "(20)", "(21)", "(22)", "(23)", "(24)", "(25)", "(26)", "(27)", "(28)", "(29)"),
    *("(30)", "(33)", "(34)", "(35)", "(36)", "(37)", "(38)", "(39)"),
}
