# %% [markdown]
# # A law of your own
#
# - how a material law is written: parameters, an energy in UFL, a typical stiffness;
# - a foil that stiffens at large strains, by A. N. Gent, Rubber Chem. Technol. 69 (1996) 59-61;
# - a check against the closed form of a long strip under pressure.
#
# Gent's foil is incompressible, with the energy -G Jm / 2 ln(1 - (I1 - 3) / Jm) for the shear modulus G, times the
# thickness, and the limit Jm of I1 - 3. Wrinkles need no formula: they are found from the energy. Units: N, m.

# %%
from dataclasses import dataclass

import numpy as np
import ufl
from mpi4py import MPI
from scipy.optimize import brentq

from fx_membrane import Analysis, Membrane, Newton, Pressure, Stage, Structure, Support, rectangle
from fx_membrane.forms import hyperelasticity


@dataclass(frozen=True)
class Gent:
    """Incompressible foil with limited stretch."""

    Gt: float
    Jm: float

    def energy(self, E, sigma0, parameters):
        """Strain energy per reference area, a scalar in UFL; numbers come from `parameters`, not from self."""
        Gt, Jm = parameters
        return ufl.inner(sigma0, E) - Gt * Jm / 2 * ufl.ln(1 - hyperelasticity.first_invariant(E) / Jm)

    @property
    def stiffness(self):
        """Typical stiffness, Young's modulus times thickness."""
        return 3 * self.Gt


# %% [markdown]
# A flat strip of the half width a, held along both edges and unable to strain along its length, becomes a cylinder.

# %%
law, a = Gent(Gt=3e3, Jm=2.0), 0.5


def rise(columns, pressure):
    """Rise of the middle of the strip [m]."""
    points, triangles = rectangle(2 * a, 1e-3, columns, 2)
    edges = np.flatnonzero(np.abs(points[:, 0]) > a - 1e-9)
    structure = Structure(
        points, {"foil": Membrane(triangles, law)}, [Support(range(len(points)), "y"), Support(edges, "xz")]
    )
    state = Analysis(structure, Newton(rtol=1e-12)).run([Stage("blow", [Pressure(pressure, "foil")])])["blow"]
    return state.displacement[3 * columns // 2 + 1, 2]


def exact(pressure):
    """Rise of the cylinder: stretch l = alpha / sin(alpha), force n = p a / sin(alpha), half opening angle alpha."""

    def unbalanced(alpha):
        stretch = alpha / np.sin(alpha)
        limit = 1 - (stretch**2 + stretch**-2 - 2) / law.Jm
        return law.Gt * (stretch - stretch**-3) * np.sin(alpha) - pressure * a * limit

    alpha = brentq(unbalanced, 0.1, 2.1)
    return a * np.tan(alpha / 2)


pressures, rises = (1e3, 5e3, 1e4), []
for pressure in pressures:
    coarse, fine = rise(32, pressure), rise(64, pressure)
    rises += [coarse, fine]
    if MPI.COMM_WORLD.rank == 0:
        print(f"{pressure:8.0f} Pa: rise {fine:.6f} m, extrapolated {(4 * fine - coarse) / 3:.6f} m, "
              f"exact {exact(pressure):.6f} m")  # fmt: skip

# %% [markdown]
# ## Check
#
# The polygon of the mesh converges with second order; extrapolation leaves the square of its error, which is 1e-3.

# %%
for pressure, coarse, fine in zip(pressures, rises[::2], rises[1::2], strict=True):
    assert abs((4 * fine - coarse) / 3 / exact(pressure) - 1) < 1e-5, pressure
numbers = {"rises [m]": rises}
if MPI.COMM_WORLD.rank == 0:
    print("\nCheck passed: the rises are those of the closed form.")
