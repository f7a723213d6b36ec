"""Cutting patterns of twenty generated roofs: seams, strips, flattening, compensation, pieces and proof.

    python tests/benchmarks/pattern_roofs.py [first roof [last roof]]

Each roof is cut along its seams, the cells split, and again with cells of a wanted size. The strips are flattened,
compensated for the prestress, cut with allowances, sewn together again and solved. The table gives numbers of cells and
strips, processor time [s] and largest aspect of a cell. Then follow difference of area, largest difference of seam
lengths and largest shift over the size of the roof. The last is mean
stress over that of the design. The exit status is 1 after a failure.

Failures are errors; strips whose edges do not close around them; cells more slender than 500; areas that differ by more
than 1e-12 (of split cells) or 5 % (of new ones); seams that differ by more than 1e-9; shifts of more than 3 % of the
size; and mean stress that differs by more than 20 %.
"""

import sys
from itertools import pairwise
from time import process_time

import numpy as np
from generated_roofs import ROOFS, Array, Roof  # type: ignore[import-not-found]

from fx_membrane import (
    Membrane,
    PatternProof,
    Pressure,
    Strips,
    Structure,
    boundary_edges,
    cut_pieces,
    cut_strips,
    cutting_pattern,
    prove_pattern,
)
from fx_membrane.geometry.sizes import aspects, measures

SLENDER, AREA, SEAMS, SHIFT, STRESS = 500, 1e-12, 1e-9, 0.03, 0.2
HEAD = (
    f"{'':2} {'roof':50} {'cells':>6} {'strips':>6} {'time':>7} {'aspect':>7} {'area':>8} {'seams':>8} {'shift':>8} "
    f"{'stress':>7}"
)


def chain(roof: Roof, size: float | None, area: float) -> tuple[list[str], str]:
    """Make the pattern of a roof; return failures in words, and the row of the table."""
    start, words, numbers = process_time(), [], [np.nan] * 5
    counts = [0, 0]
    try:
        strips = cut_strips(roof.structure, roof.seams, size=size)
        counts = [len(whole(strips.structure)[1]), len(strips.names)]
        words, numbers[:2] = of_strips(roof, strips, area)
        pattern = cutting_pattern(strips)
        cut_pieces(pattern)
        loads = [Pressure(roof.pressure, name) for name in strips.names] if roof.pressure else []
        more, numbers[2:] = of_proof(roof, prove_pattern(pattern, loads, progress=False))
        words += more
    except (ValueError, RuntimeError) as error:
        words = [*words, str(error)]
    told = f"{counts[0]:6d} {counts[1]:6d} {process_time() - start:7.2f}"
    aspect, *errors, stress = numbers
    return words, f"{told} {aspect:7.1f} " + " ".join(f"{error:8.1e}" for error in errors) + f" {stress:7.3f}"


def of_strips(roof: Roof, strips: Strips, area: float) -> tuple[list[str], list[float]]:
    """Failures of a cut in words; largest aspect of a cell, and difference of area."""
    points, words = strips.structure.points, []
    cells = [strips.membrane(name).cells for name in strips.names]
    slender = float(max(aspects(points, part).max() for part in cells))
    if slender > SLENDER:
        words.append(f"aspect {slender:.3g}")
    error = abs(sum(measures(points, part).sum() for part in cells) / measures(*whole(roof.structure)).sum() - 1)
    if error > area:
        words.append(f"area {error:.2g}")
    for name, part in zip(strips.names, cells, strict=True):
        rim = {tuple(edge) for edge in boundary_edges(part).tolist()}
        around = set()
        for edge in strips.edges_of(name):
            if edge.strips != (name, name):
                around |= set(pairwise(edge.nodes.tolist() if edge.strips[0] == name else edge.nodes[::-1].tolist()))
        if rim != around:
            words.append(f"edges of {name}")
    return words, [slender, error]


def of_proof(roof: Roof, proof: PatternProof) -> tuple[list[str], list[float]]:
    """Failures of a proof in words; largest difference of seams, largest shift, and mean stress over the design."""
    strips = proof.strips.values()
    size = float(np.ptp(roof.structure.points, axis=0).max())
    wanted, found = (np.sum([(getattr(s, key) * s.area[:, None]).sum() for s in strips]) for key in ("wanted", "found"))
    seams, shift, stress = proof.seam_difference, float(proof.shift.max()) / size, float(found / wanted)
    words = [f"seams {seams:.2g}"] if seams > SEAMS else []
    words += [f"shift {shift:.2g}"] if shift > SHIFT else []
    words += [f"stress {stress:.3g}"] if abs(stress - 1) > STRESS else []
    return words, [seams, shift, stress]


def whole(structure: Structure) -> tuple[Array, Array]:
    """Points and triangles of all membranes."""
    return structure.points, np.concatenate([part.cells for part in structure.parts_of(Membrane).values()])


def main(first: int = 0, last: int = len(ROOFS) - 1) -> int:
    """Make the patterns of the roofs; return the exit status."""
    failed = 0
    print(HEAD, flush=True)
    for number in range(first, last + 1):
        roof = ROOFS[number]()
        for size, area in ((None, AREA), (roof.size, 0.05)):
            words, told = chain(roof, size, area)
            failed += bool(words)
            print(f"{number:2d} {roof.words:50.50} {told} {'; '.join(words) or 'good'}", flush=True)
    return min(failed, 1)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
