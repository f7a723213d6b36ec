# %% [markdown]
# # Solvers
#
# Section 7 of Gil (2006) has steepest descent, conjugate gradients and Newton-Raphson, all with a line search, and
# compares them in words: first-order methods find their way from anywhere, but slowly; Newton's method is fast near the
# solution, and the line search brings it there. Here are the numbers, for the paper's square membrane and for a roof
# that is prestressed by pulling its corners. The roof stands for the pavilion of `shade_pavilion.py`: found by force
# densities, slack to begin with, soft across and stiff along, but small enough to be solved ten times over.

# %%
import sys
from pathlib import Path
from time import perf_counter

import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Analysis, Cable, ConjugateGradient, ConvergenceError, Fabric, Membrane, Newton, PointLoad, PrescribedDisplacement,
    Stage, SteepestDescent, Structure, Support, boundary, force_density, plot, polyline, rectangle,
)  # fmt: skip

folder = Path("output/solvers")
say = print if MPI.COMM_WORLD.rank == 0 else (lambda *_: None)
solvers = {
    "Newton": Newton(),
    "Newton, full steps": Newton(line_search=False),
    "conjugate gradients, PR": ConjugateGradient("PR"),
    "conjugate gradients, FR": ConjugateGradient("FR"),
    "  PR, by the diagonal": ConjugateGradient("PR", preconditioner="jacobi"),
    "  PR, by the first tangent": ConjugateGradient("PR", preconditioner="tangent"),
    "steepest descent": SteepestDescent(max_iterations=1000),
    "  by the diagonal": SteepestDescent(preconditioner="jacobi", max_iterations=1000),
}

# %% [markdown]
# ## Two structures
#
# The square of the first example (kip, in), flat, with any prestress; and the roof (kN, m): 8 m by 8 m between two high
# and two low corners, stiff cables around it. The low corners are pulled by 5 cm outwards and down.

# %%
grid, square_cells = rectangle(240.0, 240.0, 4, 4, diagonals="to centre")
middle = int(np.argmin(np.hypot(*grid[:, :2].T)))


def square(prestress):
    """The square membrane with a prestress [ksi]."""
    fabric = Membrane(square_cells, Fabric.from_modulus(30_000.0, 0.3, 0.004167), prestress=prestress * 0.004167)
    return Structure(grid, {"membrane": fabric}, [Support(np.unique(boundary(square_cells)))])


n = 8
plan, cells = rectangle(8.0, 8.0, n, n)
node = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
low, high = [node[0, -1], node[-1, 0]], [node[0, 0], node[-1, -1]]
plan[high, 2] = 2.0
inner = np.vstack([polyline(line) for line in (*node[1:-1], *node.T[1:-1])])
rim = np.vstack([polyline(line) for line in (node[0], node[-1], node[:, 0], node[:, -1])])
densities = np.repeat([1.0, 10.0], [len(inner), len(rim)])
form = force_density(plan, np.vstack([inner, rim]), densities, [Support(low + high)])
parts = {
    "fabric": Membrane(cells, Fabric(Et=500.0, nu=0.3), prestress=0.01),
    "cables": Cable(rim, axial_stiffness=1.2e4, prestress=0.1),
}
roof = Structure(form.points, parts, [Support(high)])
pulls = [PrescribedDisplacement(corner, 0.05 * np.sign(plan[corner] - (0, 0, 1))) for corner in low]
push = Stage("point load", [PointLoad(middle, (0, 0, -10.0))])
cases = {
    "square": (square(80.0), push, "kip", "kip in"),
    "roof": (roof, Stage("prestress", displacements=pulls), "kN", "kN m"),
}

# %% [markdown]
# ## All solvers on both


# %%
def solve(structure, stage, solver):
    """Iterates, seconds, and displacements; without these where the iterations were too few."""
    analysis, began = Analysis(structure, solver), perf_counter()
    try:
        result = analysis.run([stage])[stage.name]
    except ConvergenceError as error:
        return error.failed.iterations, perf_counter() - began, None
    return [entry for _, entry in result.history], perf_counter() - began, result.displacement


numbers, counts, orders, errors = {}, {}, {}, {}
for case, (structure, stage, *units) in cases.items():
    found = {name: solve(structure, stage, solver) for name, solver in solvers.items()}
    *_, expected = found["Newton"]
    numbers[f"displacements of the {case}"] = expected.ravel().tolist()
    lowest = min(history[-1].energy for history, *_ in found.values())
    say(f"{case:29}{'iterations':>10}{'seconds':>9}{'residual':>10}{'energy error':>14}")
    for name, (history, seconds, displacement) in found.items():
        ended, last = displacement is not None, history[-1]
        say(
            f"{name:29}{len(history) - 1:>6}{'' if ended else ' ...':4}{seconds:9.2f}{last.residual:10.1e}"
            f"{last.energy - lowest:14.1e}"
        )
        counts[case, name] = len(history) - 1 if ended else np.inf
        if ended:
            errors[case, name] = np.abs(displacement - expected).max() / np.abs(expected).max()
    last_steps = [entry.residual for entry in found["Newton"][0][-4:-1]]  # the very last ends at rounding
    orders[case] = np.log(last_steps[2] / last_steps[1]) / np.log(last_steps[1] / last_steps[0])
    say(f"Order of Newton's last steps: {orders[case]:.2f}\n")
    if "--no-pictures" not in sys.argv:
        histories, times = ({name: values[i] for name, values in found.items()} for i in (0, 1))
        plot.compare_convergence(histories, times, folder / f"{case}.png", *units)

# %% [markdown]
# ## The line search
#
# The weaker the prestress of the square, the further a full first step overshoots, and the more steps it takes to come
# back; without prestress there is no first step at all. With the line search, and artificial tension where there is no
# stiffness, the prestress hardly matters.

# %%
searched, full = {}, {}
say(f"{'prestress [ksi]':>15}{'line search':>13}{'full steps':>12}{'highest energy [kip in]':>25}")
for prestress in (80.0, 8.0, 0.8, 0.08, 0.008, 0.0):
    iterates, _, there = solve(square(prestress), push, Newton())
    plain, _, arrived = solve(square(prestress), push, Newton(line_search=False))
    searched[prestress], full[prestress] = len(iterates) - 1, np.inf if arrived is None else len(plain) - 1
    numbers[f"displacement of the square with {prestress} ksi [in]"] = [there[middle, 2]]
    highest = max(entry.energy for entry in plain)
    assert max(entry.energy for entry in iterates) == 0.0  # at the start
    say(f"{prestress:15}{searched[prestress]:13}{full[prestress]:12}{highest:25.1e}")

# %% [markdown]
# ## Check
#
# All that came to an end came to the same state. Newton's method needs a handful of steps, the last of them quadratic,
# conjugate gradients up to a few times as many as there are unknowns, steepest descent thousands. Dividing by the
# diagonal of the tangent helps; by the tangent itself, where the first is still like the last: not in the slack roof.

# %%
unknowns = {"square": 27, "roof": 3 * 77}
assert max(errors.values()) < 1e-6, errors
for case, count in unknowns.items():
    newton, plain, pr, fr, diagonal, _, steepest, scaled = (counts[case, name] for name in solvers)
    assert newton < plain < 15 < diagonal < pr / 1.5
    assert max(pr, fr) < 6 * count
    assert 3 * diagonal < scaled <= steepest == np.inf
    assert 1.7 < orders[case] < 2.5
assert max(searched.values()) < 10
assert list(full.values()) == sorted(full.values())
assert full[0.008] > 25
say("\nCheck passed: one state, Newton's order, the ranks of the methods, a line search that weak prestress needs.")
