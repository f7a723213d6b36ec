# %% [markdown]
# # ETFE cushion: inflated, closed, under suction and under snow
#
# Two foils of ETFE share an edge that a frame holds. A fan inflates the cushion, and then a valve closes it. Suction of
# the wind on the upper foil makes room, the pressure falls, and the lower foil gives way; snow presses the gas
# together, and the lower foil bears its share. A constant pressure, as a fan holds it, hands on nothing. Units: N, m.

# %%
import numpy as np
from mpi4py import MPI
from scipy.optimize import brentq

from fx_membrane import (
    Ambient,
    Analysis,
    Chamber,
    DistributedLoad,
    Fabric,
    GasPressure,
    Membrane,
    Newton,
    Pressure,
    Seal,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

ETFE = Fabric(Et=8e8 * 2e-4, nu=0.43)  # 0.2 mm
FAN, AIR = 300.0, 101_325.0
SUCTION, SNOW = Pressure(500.0, "top"), DistributedLoad((0, 0, -200.0), "top")


def two_foils(length, width, nx, ny, edge_of):
    """Two flat foils that share the nodes of their edge; the upper one has its normals outwards, the lower inwards."""
    flat, cells = rectangle(length, width, nx, ny, "right")
    edge = edge_of(flat, cells)
    twin = np.where(edge, np.arange(len(flat)), len(flat) + np.cumsum(~edge) - 1)
    points = np.vstack([flat, flat[~edge]])
    return points, {"top": Membrane(twin[cells], ETFE), "bottom": Membrane(cells, ETFE)}, np.flatnonzero(edge)


def results_of(cushion):
    """Cushion inflated, closed, and loaded; the loads also with the fan running."""
    inflate = Stage("inflate", changes=[GasPressure(FAN, "air")])
    close = Stage("close", changes=[Ambient(AIR), Seal("air")], after="inflate")
    closed = [Stage("suction", [SUCTION], after="close"), Stage("snow", [SNOW], after="close")]
    fan = [Stage("suction, fan", [SUCTION], after="inflate"), Stage("snow, fan", [SNOW], after="inflate")]
    return Analysis(cushion, Newton(rtol=1e-12)).run([inflate, close, *closed, *fan])


# %% [markdown]
# A cushion of 3 m x 3 m. Its chamber is closed by the two foils alone. They are flat and without stress before. So the
# chamber is told on which side of each foil it lies: 1 where the normals point out of it, -1 where into it.

# %%
points, foils, rim = two_foils(
    3.0, 3.0, 12, 12, lambda flat, cells: np.isin(np.arange(len(flat)), boundary_edges(cells))
)
chambers = {"air": Chamber({"top": 1, "bottom": -1})}
cushion = Structure(points, foils, [Support(rim)], separate=[("top", "bottom")], chambers=chambers)
results = results_of(cushion)
if MPI.COMM_WORLD.rank == 0:
    print(f"{'':15}{'pressure':>10}{'volume':>10}{'top':>9}{'bottom':>9}{'n top':>9}{'n bottom':>9}")
    for name, state in results.items():
        gas, z = state.chambers["air"], state.displacement[:, 2]
        n = [state.membrane(foil).principal.max() for foil in foils]
        print(f"{name:15}{gas.pressure:10.2f}{gas.volume:10.5f}{z.max():9.4f}{z.min():9.4f}{n[0]:9.1f}{n[1]:9.1f}")

# %% [markdown]
# ## Check
#
# A long cushion, 3 m wide, of which a strip is modelled: its ends are planes of symmetry, rigid walls for the gas. Each
# foil is an arc, and Boyle's law of absolute pressures, (p + p_air) V constant, closes the equations. The gauge
# pressure in its place would give 259 Pa under suction.

# %%
points, foils, rim = two_foils(3.0, 0.1, 32, 2, lambda flat, cells: np.abs(flat[:, 0]) > 1.4999)
supports = [Support(rim), Support(np.arange(len(points)), "y")]
chambers = {"air": Chamber({"top": 1, "bottom": -1}, rigid_walls=True)}
strip = results_of(Structure(points, foils, supports, separate=[("top", "bottom")], chambers=chambers))


def arc(p, a=1.5):
    """Sag and area of a foil between the edges of a long cushion, for its difference of pressure."""

    def unbalanced(angle):
        stretch = angle / np.sin(angle)
        return stretch * ETFE.Et / (1 - ETFE.nu**2) * (stretch**2 - 1) / 2 * np.sin(angle) / a - p

    angle = brentq(unbalanced, 1e-6, 1.5, xtol=1e-15)
    return a * np.tan(angle / 2), a**2 * (angle / np.sin(angle) - np.cos(angle)) / np.sin(angle)


amount = (FAN + AIR) * 2 * arc(FAN)[1]
exact = brentq(lambda p: (p + AIR) * (arc(p + 500.0)[1] + arc(p)[1]) - amount, 1.0, 300.0)
found = strip["suction"].chambers["air"].pressure
middle = strip["suction"].displacement[np.abs(points[:, 0]) < 1e-9, 2]
sags = [middle.max(), -middle.min()]
assert abs(found / exact - 1) < 2e-4
assert np.allclose(sags, [arc(exact + 500.0)[0], arc(exact)[0]], rtol=2e-3)
for run in (results, strip):
    closed = [run[name].chambers["air"] for name in ("close", "suction", "snow")]
    assert np.ptp([(gas.pressure + AIR) * gas.volume for gas in closed]) < 1e-9 * AIR * closed[0].volume
    assert closed[1].pressure < FAN < closed[2].pressure
numbers = {
    "pressures [Pa]": [state.chambers["air"].pressure for state in results.values()],
    "volumes [m3]": [state.chambers["air"].volume for state in results.values()],
    "sags of the strip [m]": sags,
}
if MPI.COMM_WORLD.rank == 0:
    print(f"Strip under suction: {found:.3f} Pa, {exact:.3f} in closed form; sags {sags[0]:.4f} and {sags[1]:.4f} m")
    print("Check passed: Boyle's law of the absolute pressure, and the arcs of both foils.")
