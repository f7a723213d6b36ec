# %% [markdown]
# # Cutting patterns
#
# The cone of demos/cone.py is cut into gores from ring to edges. They are flattened with the law of the fabric,
# compensated for the prestress, and written for the workshop. For the proof the cloth is sewn together again. The
# stress in its equilibrium is compared with that of the form [kN, m].

# %%
import sys
from pathlib import Path

import ezdxf
import numpy as np
from mpi4py import MPI

from fx_membrane import (
    Allowances, cut_pieces, cut_strips, cutting_pattern, laid_on_roll, plot, prove_pattern, seams_between, with_copies,
    write_patterns,
)  # fmt: skip
from cone import form, ring

folder = Path("output/patterns")
say = print if MPI.COMM_WORLD.rank == 0 else (lambda *_, **__: None)

# %% [markdown]
# ## Seams and strips
#
# Geodesics between equal shares of ring and edges part 24 gores. Their cells get edges of 0.4 m, with nodes on the
# seams shared. Each quarter of the canopy is as the next one: those gores are cut once.

# %%
seams = seams_between(form, ring, "edge cables", strips=24, part="fabric")
size = 0.8 if "--small" in sys.argv else 0.4
strips = with_copies(cut_strips(form, seams, "fabric", size=size))
say(f"{len(strips.names)} strips, {len(strips.names) - len(strips.copies)} of them of unlike shape")

# %% [markdown]
# ## Flat cloth
#
# Flattening has the least strain energy with seams that are equally long on both sides. Compensation shrinks each cell
# by what its prestress will stretch it.

# %%
pattern = cutting_pattern(strips)
for name in list(dict.fromkeys(pattern.cloth))[:6]:
    warp, weft = 100 * (1 - pattern.compensation[name])
    cloth = pattern.cloth[name]
    say(f"{name}: {cloth.length:.2f} m x {cloth.width:.2f} m, compensation {warp:.2f} % and {weft:.2f} %")

# %% [markdown]
# ## For the workshop
#
# Seams are lap welds of 40 mm, half of it on each side; the edges have pockets of 100 mm for the cables. The roll is
# 2.5 m wide. DXF, sheets and tables come from the same pieces.

# %%
allowances = Allowances(seam=0.02, border=0.05, pocket=0.10)
pieces = cut_pieces(pattern, allowances)
roll = laid_on_roll(pieces, 2.5)
say(f"{roll.length:.1f} m of the roll, {roll.area:.1f} m2 of cloth, waste {100 * roll.waste:.0f} %")
for ending in ("dxf", "csv") if "--no-pictures" in sys.argv else ("dxf", "csv", "pdf"):
    write_patterns(pattern, folder / f"cone.{ending}", allowances, roll_width=2.5, project="Cone", material="PVC")

# %% [markdown]
# ## Proof
#
# Sewn together, the cloth is strained by its compensation and by the curvature that flattening lost.

# %%
proof = prove_pattern(pattern, roll_width=2.5 - 2 * 0.02, progress=False)
error = {name: 100 * strip.stress_error for name, strip in proof.strips.items()}
say(f"Largest shift {1e3 * proof.shift.max():.0f} mm; flattening energy {1e3 * pattern.energy:.0f} J")
area = np.concatenate([strip.area for strip in proof.strips.values()])
means = [
    np.average(np.concatenate([getattr(strip, key) for strip in proof.strips.values()]), axis=0, weights=area)
    for key in ("wanted", "found")
]
say(f"Mean stress along warp and weft: {means[0].round(3)} in the form, {means[1].round(3)} as sewn kN/m")
if "--no-pictures" not in sys.argv:
    plot.cutting_pattern(pattern, folder / "strips.png", view=(0.45, -1.8, 0.6))
    fields = {"stress error [%]": error, "shift [m]": proof.shift}
    plot.contours(proof.state, fields, folder / "error.png", ranges={"stress error [%]": (0, 100)})

# %% [markdown]
# `nearest_stress_pattern(pattern)` moves the outlines until that stress is nearest to the form's, in a minute. Here the
# root mean square error of the tensor, with shear, falls from 37 to 33 % of the mean stress. At the borders it falls
# from 36 to 29 %. Its `fit` tells these numbers, and so does the proof of what it returns. `nearest_stress = true` asks
# for it in `[patterns]` of a case. `print(proof)` tells that much of the error is in the form itself: its stress moved
# to larger cells is not in balance. `plot.pattern_proof(proof, folder)` draws all that the proof has.

# %% [markdown]
# ## Check
#
# Cells of a finer mesh have the area of the form; seams are equally long on both sides; the quarters are alike. The
# assembled roof has the mean stress of the form, and stays where it was found. The drawing has the areas of the pieces.

# %%
numbers: dict[str, list[float]] = {}
a, b, c = np.moveaxis(form.points[form.structure.parts["fabric"].cells], 1, 0)
surface = np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2
assert abs(area.sum() / surface - 1) < 0.02
assert proof.seam_difference < 1e-9
assert len(pieces) <= 8
assert np.abs(means[1] / means[0] - 1).max() < 0.05
assert proof.shift.max() < 0.03
if MPI.COMM_WORLD.rank == 0:
    lines = ezdxf.readfile(folder / "cone.dxf").modelspace().query("LWPOLYLINE[layer=='cut']")
    corners = [np.array(line.get_points("xy")) for line in lines]
    drawn = [abs(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2e6 for x, y in (points.T for points in corners)]
    assert len(drawn) == 24
    assert abs(sum(drawn) / roll.cut_area - 1) < 1e-9
say("Check passed: area, equal seams, like quarters, mean stress and place after assembly, drawing.")
