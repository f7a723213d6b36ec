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

# %% [markdown]
# ## The solver
#
# The time step is one. Masses are twice the sums of the rows of the tangent in absolute values: the sums keep the
# motion stable (Gershgorin), twice them also while nodes turn. Masses follow the tangent at each peak of the kinetic
# energy, from which the motion starts anew. They never fall: slack parts will be taut again.


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
            history = []
            loaded.constraints.impose(x)
            for number in range(self.max_iterations):
                loaded.residual(x, forces)
                scale = forces.norm() + loaded.load_norm(x)
                loaded.constraints.zero_constrained(forces)  # reactions
                history.append(fx.Iteration(loaded.energy(x), forces.norm(3), float(number > 0)))
                monitor(number, history[-1])
                if forces.norm() <= self.rtol * scale:
                    return fx.Solution(fx.Outcome.CONVERGED, "at rest", history)
                if number == 0 or velocity.dot(forces) >= 0:  # the start, or a peak
                    rows, _, entries = loaded.tangent(x, K).getValuesCSR()
                    masses.array = np.maximum(masses.array, 2 * np.add.reduceat(np.abs(entries), rows[:-1]))
                    velocity.set(0.0)
                velocity.axpy(-1.0, forces / masses)
                x.axpy(1.0, velocity)
            return fx.Solution(fx.Outcome.MAX_ITERATIONS, "more steps are needed", history)

        return solve


# %% [markdown]
# ## A hypar, prestressed, then under snow

# %%
points, triangles = fx.rectangle(4.0, 3.0, columns=4, rows=4)
points[:, 2] = points[:, 0] * points[:, 1] / 6.0
fabric = fx.Membrane(triangles, fx.Fabric(Et=500e3, nu=0.3), prestress=2e3)
cable = fx.Cable(fx.boundary_edges(triangles), axial_stiffness=1e6, prestress=20e3)
structure = fx.Structure(points, {"fabric": fabric, "cable": cable}, [fx.Support([0, 4, 20, 24])])
stages = [fx.Stage("rest"), fx.Stage("snow", [fx.DistributedLoad((0, 0, -600.0), "fabric")], after="rest")]
found, exact = (fx.Analysis(structure, solver).run(stages)["snow"] for solver in (DynamicRelaxation(), fx.Newton()))

# %% [markdown]
# ## Check
#
# Newton's method finds the same state.

# %%
numbers = {"displacement [m]": exact.displacement.ravel().tolist(), "energy [J]": [exact.energy]}
np.testing.assert_allclose(found.displacement, exact.displacement, rtol=0, atol=1e-4 * exact.largest_displacement)
if MPI.COMM_WORLD.rank == 0:
    print(f"Check passed: {len(found.history)} states reach Newton's after {len(exact.history)}.")
