# %% [markdown]
# # Rain on two flat roofs: one ponds, one does not
#
# Water on a flat roof makes the hollow in which more water stands. A level sheet that is full bears that as long as
# its prestress is above rho g L^2 / pi^2 for a strip of span L; below, the least rain finds a hollow, and fills it.
# Here two strips of span 10 m, cut from long roofs, stand in 10 cm of rain. Units: N, m.

# %%
import numpy as np
from mpi4py import MPI

from fx_membrane import Analysis, Fabric, Membrane, Pond, Stage, Structure, Support, rectangle, report, stability

span, segments, weight, rain = 10.0, 128, 9810.0, 0.1
critical = weight * span**2 / np.pi**2  # [N/m]
points, triangles = rectangle(span, span / segments, segments, 1)
ends = np.abs(points[:, 0]) > 0.4999 * span
sides = np.flatnonzero(~ends)  # of the cut-out, where the roof goes on: no water runs off there
supports = [Support(np.flatnonzero(ends)), Support(np.arange(len(points)), "y")]

# %% [markdown]
# The same rain on both. The lower prestress is 4 % of the critical one, the higher 120 %, in a stronger fabric. The
# stage fills the pond by its load factor. Water that the roof does not hold runs off over its ends.


# %%
def rained(prestress, Et):
    """State of a roof in the rain."""
    roof = Structure(points, {"roof": Membrane(triangles, Fabric(Et, 0.3), prestress)}, supports)
    return Analysis(roof).run([Stage("rain", [Pond("roof", rain=rain, weight=weight, walls=sides)])])["rain"]


soft, stiff = rained(4e3, 1e6), rained(1.2 * critical, 4e6)
pond, none = soft.ponds[0], stiff.ponds[0]
width = span / segments
sag = -soft.displacement[points[:, 0] == 0, 2].mean()
force = soft.membrane("roof").principal[:, 0].mean()
lowest = stability(stiff)
numbers = {
    "sag, level, half width [m]": [sag, pond.level, pond.area / width / 2],
    "force [N/m]": [force],
    "water on 1 m [m3]": [pond.volume / width, none.volume / width, none.lost / width],
    "energy [J]": [soft.energy],
}

# %% [markdown]
# ## Check
#
# The elastica under a pond of 1 m3/m, by two independent methods: sag 0.8807866356 m, level -0.5553843655 m, force
# 23 421.2498 N/m, half width 2.4068616187 m. The stiff roof stays level, is stable, and sheds all of the rain.

# %%
exact = {"sag": (sag, 0.8807866356), "level": (pond.level, -0.5553843655), "force": (force, 23421.2498)}
for name, (found, expected) in exact.items():
    assert abs(found / expected - 1) < 1e-3, name
assert abs(pond.area / width / 2 / 2.4068616187 - 1) < 1e-3
assert abs(pond.volume / width - 1) < 1e-12
assert not np.any(stiff.displacement)
assert abs(none.lost / width - 1) < 1e-12
assert lowest.negative == 0
if MPI.COMM_WORLD.rank == 0:
    print(report(soft))
    print(report(stiff))
    print(f"Critical prestress {critical:.0f} N/m: sag {sag:.4f} m below it, none above.")
    print("Check passed: sag, level, force and width of the pond, and the roof that stays level.")
