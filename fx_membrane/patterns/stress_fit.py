"""Report of outlines moved towards the nearest stress: errors before and after, within the surface and at borders."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class StressErrors(NamedTuple):
    """Differences of the stress after assembly and that of the design, over the mean stress of the design [-].

    The difference of a cell is the Frobenius norm of tensors, shear included: Cauchy stress in axes that turn with the
    cell. It is called tensor error; the stress error of a proof, of warp and weft alone, is no larger. Rms is the root
    of the mean of its square over the area on the surface.

    Attributes:
        rms: Of all cells.
        largest: The largest of all cells.
        border_rms: Of cells with a node on a border of the surface.
        border_largest: The largest of these.
        inside_rms: Of all other cells.
        inside_largest: The largest of these.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> short = cutting_pattern(cut_strips(roof, ["valley"]), compensation=0.99)  # too short for the prestress
        >>> fit = nearest_stress_pattern(short, progress=False).fit
        >>> fit.after.rms < fit.before.rms
        True
    """

    rms: float
    largest: float
    border_rms: float
    border_largest: float
    inside_rms: float
    inside_largest: float


@dataclass(frozen=True)
class StressFit:
    """Outlines moved so that the stress after assembly comes nearest to that of the design; as text, a table.

    Attributes:
        before: Errors of the pattern that was given, as that of least energy.
        after: Errors of the pattern found.
        iterations: Number of trial patterns, each in equilibrium or refused.
        converged: No step lowers the error any more.
        remark: Reason for an early end; empty without one.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> short = cutting_pattern(cut_strips(roof, ["valley"]), compensation=0.99)  # too short for the prestress
        >>> fit = nearest_stress_pattern(short, progress=False).fit
        >>> fit.converged, fit.gain > 0.5
        (True, True)
    """

    before: StressErrors
    after: StressErrors
    iterations: int
    converged: bool
    remark: str = ""

    @property
    def gain(self) -> float:
        """Share of the rms error that has gone [-]."""
        return _gain(self.before.rms, self.after.rms)

    @property
    def border_gain(self) -> float:
        """Share of the rms error at borders that has gone [-]."""
        return _gain(self.before.border_rms, self.after.border_rms)

    @property
    def inside_gain(self) -> float:
        """Share of the rms error within the surface that has gone [-]."""
        return _gain(self.before.inside_rms, self.after.inside_rms)

    def __str__(self) -> str:
        end = "settled" if self.converged else f"not settled: {self.remark}"
        rows = [("all cells", "", self.gain), ("at borders", "border_", self.border_gain)]
        rows.append(("within", "inside_", self.inside_gain))
        lines = [f"Nearest stress: {self.iterations} patterns tried, {end}; error of the tensor, with shear [%]"]
        lines.append(
            f"  {'tensor error':<14}{'rms before':>12}{'after':>9}{'gain':>9}{'largest before':>16}{'after':>9}"
        )
        for words, key, gain in rows:
            rms, most = ([getattr(one, key + of) for one in (self.before, self.after)] for of in ("rms", "largest"))
            lines.append(
                f"  {words:<14}{100 * rms[0]:>12.4g}{100 * rms[1]:>9.4g}{100 * gain:>9.3g}"
                f"{100 * most[0]:>16.4g}{100 * most[1]:>9.4g}"
            )
        return "\n".join(lines)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers as plain data, as for JSON."""
        return {
            "gain": self.gain,
            "gain at borders": self.border_gain,
            "gain within": self.inside_gain,
            "before": _plain(self.before),
            "after": _plain(self.after),
            "patterns tried": self.iterations,
            "converged": self.converged,
            "remark": self.remark,
        }


def errors_of(error: NDArray[np.float64], area: NDArray[np.float64], at_border: NDArray[np.bool_]) -> StressErrors:
    """Sum up the errors of cells.

    Args:
        error: Difference of the stress tensors over the mean stress, shape (cells, 2, 2) [-].
        area: Areas of the cells, shape (cells,) [m2].
        at_border: True for cells at borders, shape (cells,).
    """
    square = (error**2).sum(axis=(1, 2))
    found = []
    for chosen in (np.ones_like(at_border), at_border, ~at_border):
        share = float(area[chosen].sum())
        found.append(float(np.sqrt(area[chosen] @ square[chosen] / share)) if share else 0.0)
        found.append(float(np.sqrt(square[chosen].max(initial=0.0))))
    return StressErrors(*found)


def _gain(before: float, after: float) -> float:
    return 1 - after / before if before else 0.0


def _plain(errors: StressErrors) -> dict[str, float]:
    return {f"{key.replace('_', ' ')} tensor error": value for key, value in errors._asdict().items()}
