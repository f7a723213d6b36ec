# %% [markdown]
# # A solver of one's own
#
# Dynamic relaxation with kinetic damping, the method in which most tension structures have been designed, in 30 lines:
#
# - the solver keeps the protocol `fx_membrane.Solver`, so that `Analysis` takes it like `Newton`;
# - the structure moves freely under its unbalanced forces, and stands still wherever its kinetic energy has a peak;
# - load increments, stages, results, checkpoints and several processes work as with any solver.
#
# Source: M. R. Barnes, Form finding and analysis of tension structures by dynamic relaxation, International Journal of
# Space Structures 14 (1999) 89-104. Units are N and m.

# %%
from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

import fx_membrane as fx
from fx_membrane import Iteration, Outcome, Solution

# %% [markdown]
# ## The solver
#
# The time step is one. Masses are sums of the rows of the tangent in absolute values, which keeps the motion stable
# (Gershgorin). They follow the tangent at each peak, where the motion starts anew, but never fall: slack parts will be
# taut again.


# %%
@dataclass(frozen=True)
class DynamicRelaxation:
    """Dynamic relaxation: unbalanced forces fall below rtol times all nodal forces in at most max_iterations steps."""

    rtol: float = 1e-7
    max_iterations: int = 20_000

    def prepare(self, problem):
        """Make the workspace once."""
        K, masses, velocity, forces = problem.create_matrix(), *(problem.create_vector() for _ in range(3))

        def solve(loaded, x, monitor, thorough):
            """Move x until it is at rest."""
            history, kinetic = [], np.inf
            masses.set(0.0)
            loaded.constraints.impose(x)
            for number in range(self.max_iterations):
                loaded.residual(x, forces)
                scale = forces.norm() + loaded.load_norm(x)
                loaded.constraints.zero_constrained(forces)  # reactions
                history.append(Iteration(loaded.energy(x), forces.norm(3), float(number > 0)))
                monitor(number, history[-1])
                if forces.norm() <= self.rtol * scale:
                    return Solution(Outcome.CONVERGED, "at rest", history)
                before, kinetic = kinetic, velocity.dot(masses * velocity)
                if kinetic <= before:  # a peak, or the start
                    loaded.tangent(x, K)
                    rows, _, entries = K.getValuesCSR()
                    sums = np.add.reduceat(np.abs(entries), rows[:-1]).reshape(-1, 3).max(axis=1)  # nodes turn
                    masses.array = np.maximum(masses.array, np.repeat(sums, 3))
                    velocity.set(0.0)
                    kinetic = 0.0
                velocity.axpy(-1.0 if kinetic else -0.5, forces / masses)  # velocities are those of half steps
                x.axpy(1.0, velocity)
            return Solution(Outcome.MAX_ITERATIONS, "more steps are needed", history)

        return solve


# %% [markdown]
# ## A hypar, prestressed, then under snow

# %%
points, triangles = fx.rectangle(4.0, 3.0, columns=4, rows=4)
points[:, 2] = points[:, 0] * points[:, 1] / 6.0
fabric = fx.Membrane(triangles, fx.Fabric(Et=500e3, nu=0.3), prestress=2e3)
cable = fx.Cable(fx.boundary_edges(triangles), axial_stiffness=1e6, prestress=20e3)
structure = fx.Structure(points, {"fabric": fabric, "cable": cable}, [fx.Support([0, 4, 20, 24])])
snow = fx.Stage("snow", [fx.DistributedLoad((0, 0, -600.0), "fabric")], after="prestress")
solvers = DynamicRelaxation(), fx.Newton()
found, expected = (fx.Analysis(structure, solver).run([fx.Stage("prestress"), snow])["snow"] for solver in solvers)

# %% [markdown]
# ## Check
#
# Newton's method finds the same state.

# %%
numbers = {"displacement [m]": expected.displacement.ravel().tolist(), "energy [J]": [expected.energy]}
error = np.abs(found.displacement - expected.displacement).max() / expected.largest_displacement
assert error < 1e-4, error
if MPI.COMM_WORLD.rank == 0:
    print(f"{len(found.history)} states of dynamic relaxation, {len(expected.history)} of Newton; error {error:.1e}")
    print("Check passed: both solvers find the same state.")
