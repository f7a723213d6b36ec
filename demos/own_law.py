# %% [markdown]
# # A law of your own
#
# - how a material law is written: parameters, an energy in UFL, a typical stiffness;
# - a foil that stiffens at large strains, by A. N. Gent, Rubber Chem. Technol. 69 (1996) 59-61;
# - a check against the closed form of a long strip under pressure.
#
# Gent's foil is incompressible, with the energy -G Jm / 2 ln(1 - (I1 - 3) / Jm). G is the shear modulus times the
# thickness, and Jm the limit of I1 - 3. Wrinkles need no formula: they are found from the energy. Units: N, m.

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

    Gt: float  # [N/m]
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
# A flat strip of the half width a is held along both edges and cannot strain along its length. It becomes a cylinder.

# %%
law, a, pressures = Gent(Gt=3e3, Jm=2.0), 0.5, (1e3, 5e3, 1e4)


def rises(columns):
    """Rises of the middle of the strip [m]; each stage begins where the last one ended."""
    points, triangles = rectangle(2 * a, 1e-3, columns, 2)
    supports = [Support(range(len(points)), "y"), Support(np.flatnonzero(np.abs(points[:, 0]) > a - 1e-9), "xz")]
    analysis = Analysis(Structure(points, {"foil": Membrane(triangles, law)}, supports), Newton(rtol=1e-12))
    more = zip(pressures, [None, *(f"{p} Pa" for p in pressures)], np.diff(pressures, prepend=0), strict=False)
    stages = [Stage(f"{p} Pa", [Pressure(dp, "foil")], after=last) for p, last, dp in more]
    return [state.displacement[3 * columns // 2 + 1, 2] for state in analysis.run(stages).values()]


def excess(alpha, pressure):
    """Stress less that of equilibrium, p a / sin(alpha), for half the opening angle alpha."""
    stretch = alpha / np.sin(alpha)
    stress = law.Gt * (stretch - stretch**-3) / (1 - (stretch**2 + stretch**-2 - 2) / law.Jm)
    return stress - pressure * a / np.sin(alpha)


found = np.transpose([rises(columns) for columns in (32, 64)])
exact = np.array([a * np.tan(brentq(excess, 0.1, 1.8, (pressure,)) / 2) for pressure in pressures])

# %% [markdown]
# ## Check
#
# The polygon of the mesh converges with second order; extrapolation leaves the square of its error, which is 1e-3.

# %%
extrapolated = found @ [-1 / 3, 4 / 3]
assert np.abs(extrapolated / exact - 1).max() < 1e-5
numbers = {"rises [m]": found.ravel().tolist()}
if MPI.COMM_WORLD.rank == 0:
    print(f"Pressures {pressures} Pa, rises {extrapolated} m; exact {exact} m")
    print("Check passed: the rises are those of the closed form.")
