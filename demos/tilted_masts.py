# %% [markdown]
# # Sail on tilted masts
#
# A sail between two low points and two masts that lean outwards, with two stays each. Its form is found with the heads
# held; masts and stays take their place, with forces in balance. Then snow and wind. At last the masts get round
# forces, and the heads find their place. Units: kN, m.

# %%
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis, Cable, Mast, Membrane, OrthotropicFabric, PlanLoad, Pressure, Stage, Structure, Support, boundary_edges,
    masts_and_stays, plot, projected_stress, rectangle, report, stability, updated_reference,
)  # fmt: skip

folder = Path("output/tilted_masts")
say = print if MPI.COMM_WORLD.rank == 0 else (lambda *_: None)

# %% [markdown]
# ## Plan and form
#
# The edges of the plan are arcs with the radius of force over stress. So the plan rests under 2.5 kN/m. Heights of low
# points and heads: 1 m and 4 m.

# %%
stress, edge_force, half, radius = 2.5, 25.0, 5.0, 10.0
flat, triangles = rectangle(2.0, 2.0, 16, 16)
sag = np.sqrt(radius**2 - (half * flat[:, :2]) ** 2) - np.sqrt(radius**2 - half**2)
plan = half * flat
plan[:, :2] -= flat[:, :2] * sag[:, ::-1]
points = plan @ np.array([[1, 1, 0], [-1, 1, 0], [0, 0, 1]]) / np.sqrt(2)
south, north = low = np.argsort(points[:, 1])[[0, -1]]
west, east = heads = np.argsort(points[:, 0])[[0, -1]]
points[low, 2], points[heads, 2] = 1.0, 4.0

fabric = OrthotropicFabric(Et_warp=900.0, Et_weft=700.0, nu=0.2, Gt=30.0)
sail = {
    "fabric": Membrane(triangles, fabric, stress, warp=(1, 1, 0)),
    "edges": Cable(boundary_edges(triangles), axial_stiffness=2.0e4, prestress=edge_force),
}
form = projected_stress(Structure(points, sail, [Support(low), Support(heads)]))

# %% [markdown]
# ## Masts and stays
#
# Nodes from `n` on: two feet, then four anchors. A mast and two stays at a head have unique forces.

# %%
n, reach = len(points), points[east, 0]
feet = [(-reach + 0.8, 0, 0), (reach - 0.8, 0, 0)]
anchors = [(side * (reach + 3.0), y, 0.0) for side in (-1, 1) for y in (2.5, -2.5)]
bars = {
    "masts": Mast([[n, west], [n + 1, east]], axial_stiffness=3.0e5),
    "stays": Cable([[n + 2, west], [n + 3, west], [n + 4, east], [n + 5, east]], axial_stiffness=2.0e4),
}
guyed = masts_and_stays(form, bars, feet + anchors)
say(f"Forces in balance: masts {guyed.forces['masts'].round(2)} kN, stays {guyed.forces['stays'].round(2)} kN")

# %% [markdown]
# A fifth and a sixth stay, in front of the masts, leave a choice: the masts are wanted at 80 kN.

# %%
more = {
    "masts": replace(bars["masts"], prestress=-80.0),
    "stays": Cable(np.vstack([bars["stays"].cells, [[n + 6, west], [n + 7, east]]]), axial_stiffness=2.0e4),
}
tighter = masts_and_stays(form, more, [*feet, *anchors, (-reach + 4.0, 0, 0), (reach - 4.0, 0, 0)])
say(f"With stays in front: masts {tighter.forces['masts'].round(2)} kN, stays {tighter.forces['stays'].round(2)} kN")

# %% [markdown]
# One stay to the side cannot balance a head: the message names the force that is missing, and a remedy.

# %%
astray = Cable([[n + 2, west], [n + 3, east]], axial_stiffness=2.0e4)
try:
    masts_and_stays(form, bars | {"stays": astray}, [*feet, anchors[0], anchors[2]])
except ValueError as message:
    refused = str(message)
    say(f"Refused: {refused}")

# %% [markdown]
# ## Snow and wind
#
# Under prestress alone the sail is at rest. Snow: 0.6 kN/m2 of plan area. Wind: suction of 0.5 kN/m2.

# %%
stages = [
    Stage("form"),
    Stage("snow", [PlanLoad((0, 0, -0.6), "fabric")], increments=2, after="form"),
    Stage("wind", [Pressure(0.5, "fabric")], increments=2, after="form"),
]
results = Analysis(guyed.structure).run(stages)
say(report(results["snow"], [n, n + 1, west, east], force_unit="kN"))

# %% [markdown]
# ## Masts of round forces
#
# Masts of 65 kN with stays of 33 kN: the heads are free, and found where these forces balance those of the sail.

# %%
parts = sail | {"masts": replace(bars["masts"], prestress=-65.0), "stays": replace(bars["stays"], prestress=33.0)}
free = updated_reference(Structure(guyed.points, parts, guyed.structure.supports))
moved = free.points[heads] - points[heads]
say(f"Free heads move by {moved.round(3).tolist()} m; masts {free.forces['masts'].round(3)} kN")

# %%
if "--no-pictures" not in sys.argv:
    plot.wireframe(guyed.points, guyed.structure.parts, folder / "structure.png", view=(1.0, -1.6, 0.7))
    for name in ("snow", "wind"):
        fields = {
            "vertical displacement [m]": results[name].displacement[:, 2],
            "principal stress I [kN/m]": {"fabric": results[name].membrane("fabric").principal[:, 0]},
        }
        plot.contours(results[name], fields, folder / f"{name}.png")
    say(f"Pictures are in {folder}/")

# %% [markdown]
# ## Check
#
# No displacement and no iteration under prestress; a stable state; loads and reactions in balance; masts in compression
# and stays in tension; the reaction of a held head is the sum of its bars; wanted forces are met.

# %%
rest, snow, wind = results.values()
again = Analysis(free.structure).run([Stage("form")])["form"]
tight = Analysis(tighter.structure).run([Stage("form")])["form"]
assert max(state.largest_displacement for state in (rest, again, tight)) <= 1e-12 * guyed.structure.size
assert len(rest.history) == 1
assert stability(rest).stable
for state in results.values():
    assert np.abs(state.equilibrium.loads + state.equilibrium.reactions).max() < 1e-8 * np.abs(state.reactions).max()
assert (guyed.forces["masts"] < 0).all()
assert min(guyed.forces["stays"].min(), tighter.forces["stays"].min()) > 0
ends = guyed.points[[n + 1, n + 4, n + 5]] - guyed.points[east]
pulls = np.r_[guyed.forces["masts"][1], guyed.forces["stays"][2:]] / np.linalg.norm(ends, axis=1)
assert np.abs(pulls @ ends - form.reactions[east]).max() < 1e-12 * edge_force
assert max(np.abs(tighter.forces["masts"] + 80).max(), np.abs(free.forces["masts"] + 65).max()) < 1e-10
assert "is missing; add a stay" in refused
numbers = {
    "forces of the form [kN]": [*guyed.forces["masts"], *guyed.forces["stays"]],
    "forces with stays in front [kN]": [*tighter.forces["masts"], *tighter.forces["stays"]],
    "displacements of the heads [m]": [*snow.displacement[heads].ravel(), *wind.displacement[heads].ravel()],
}
say("Check passed: at rest under prestress, stable, balanced, masts in compression, stays in tension.")
