# %% [markdown]
# # Energies of your own: water on a strip, and the ground below it
#
# A term is a frozen dataclass with a part, parameters and its energy in UFL, per reference area (length of cables).
# `state` has the displacement u, the position x, the deformation gradient F and the area normal n. That is the current
# normal times the current area per reference area. Units: N, m.

# %%
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI
from ufl import max_value

from fx_membrane import Analysis, DistributedLoad, Fabric, Membrane, Stage, Structure, Support, rectangle


@dataclass(frozen=True)
class Water:
    """Pressure of the depth on a membrane whose normals point up; its rim is held, or above the water."""

    part: str
    weight: float  # [N/m3]
    level: float  # [m]

    def energy(self, state, parameters):
        """Energy per reference area [J/m2], by the divergence theorem: the slope of -depth^2 / 2 is the depth."""
        return -parameters.weight * max_value(parameters.level - state.x[2], 0) ** 2 / 2 * state.n[2]


@dataclass(frozen=True)
class Ground:
    """Contact with the plane below a height, by a penalty: a bed of springs that only pushes."""

    part: str
    stiffness: float  # [N/m3]
    height: float  # [m]

    def energy(self, state, parameters):
        """Energy per reference area [J/m2]."""
        return parameters.stiffness * max_value(parameters.height - state.x[2], 0) ** 2 / 2


# %% [markdown]
# A flat strip over 4 m: a load dips it, water fills the dip to the brim, and the load goes. Then the same above ground
# that it touches. A term in `terms` always acts; a term in `loads` is scaled by the load factor of its stage.

# %%
span, segments, weight, stiffness, height = 4.0, 64, 9810.0, 4e5, -0.1
points, triangles = rectangle(span, span / segments, segments, 1)
ends = np.flatnonzero(np.abs(points[:, 0]) > 0.4999 * span)
dip, back = (DistributedLoad((0, 0, load), "strip") for load in (-2e3, 2e3))
stages = [Stage("dip", [dip]), Stage("water", [Water("strip", weight, 0.0), back], after="dip")]
parts = {"strip": Membrane(triangles, Fabric(Et=1e6, nu=0.3), prestress=4e3)}
supports, ground = [Support(ends), Support(range(len(points)), "y")], [Ground("strip", stiffness, height)]
free, lying = (Analysis(Structure(points, parts, supports, terms=terms)).run(stages)["water"] for terms in ([], ground))
sag, low = (-state.displacement[points[:, 0] == 0, 2].mean() for state in (free, lying))
force = free.membrane("strip").principal[:, 0].mean()
thrust = force - free.reactions[ends][points[ends, 0] > 0, 0].sum() * segments / span
carried = [term.forces[:, 2].sum() * segments / span for term in lying.terms]
numbers = {"sags [m]": [sag, low], "forces [N/m]": [force, thrust, *carried], "energy [J]": [lying.energy]}

# %% [markdown]
# ## Check
#
# The force in the strip is the same everywhere. Its horizontal part is less at the edge than in the middle, by the
# thrust of the water, weight sag^2 / 2. Far from its ends the contact bears the water above: stiffness times depth.

# %%
assert abs(thrust / (weight * sag**2 / 2) - 1) < 1e-3
assert np.abs(lying.equilibrium.loads + lying.equilibrium.reactions).max() < 1e-10 * np.abs(carried).max()
assert abs(stiffness * (low + height) / (weight * low) - 1) < 1e-3
if MPI.COMM_WORLD.rank == 0:
    print(f"Free: sag {sag:.5f} m, force {force:.1f} N/m; with ground {low:.5f} m, of {carried} N/m")
    print("Check passed: thrust of the water, balance, and depth of the contact.")
