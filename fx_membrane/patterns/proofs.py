"""Proof of a cutting pattern: equilibrium of the strips sewn together again, compared with the design."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..analysis.stages import Analysis
from ..checks import validation
from ..checks.values import counted
from ..model.changes import Change
from ..model.gas import GasChange
from ..model.loads import Load
from ..model.stages import Stage
from ..results.states import StageResult
from ..solvers.base import Solver
from ..solvers.newton import Newton
from . import proof_remarks, proof_tables
from .design_balance import design_error
from .flat_strips import CuttingPattern, check_pattern
from .named_membranes import by_strip, on_strips
from .reassembly import reassembled
from .seam_lengths import SeamLengths, edge_lengths
from .strip_proofs import StripProof, curvature_of_strips, most, strip_proof
from .strips import Strips

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class PatternProof:
    """Proof that a cutting pattern fits; as text, a table.

    Attributes:
        pattern: The pattern.
        state: Equilibrium of the strips sewn together, with displacements from the designed shape.
        strips: Strips by name.
        edges: Lengths of edges by name.
        roll_width: Width of the roll without allowances, or None [m].
        wanted_error: Stress error that remarks and `StripProof.widest` belong to [-].
        loads: Loads in the designed shape.
        changes: Changes of the stage beside these loads.
        design_error: Mean stress error of the design before it is cut, in its own equilibrium, infinite if it finds
            none; None where the stress error of most of the area is no larger than the wanted one [-].

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> proof = prove_pattern(cutting_pattern(cut_strips(roof, ["valley"])))
        >>> list(proof.strips), proof.stress_error < 0.1
        (['strip 1', 'strip 2'], True)
    """

    pattern: CuttingPattern
    state: StageResult
    strips: Mapping[str, StripProof]
    edges: Mapping[str, SeamLengths]
    roll_width: float | None
    wanted_error: float
    loads: tuple[Load, ...] = ()
    changes: tuple[Change | GasChange, ...] = ()
    design_error: float | None = None

    def __repr__(self) -> str:
        return (
            f"PatternProof({counted(len(self.strips), 'strip')}, largest stress error {100 * self.stress_error:.3g} %, "
            f"largest shift {self.shift.max():.4g})"
        )

    @property
    def shift(self) -> Array:
        """Shift of nodes from the designed shape, shape (n,) [m]."""
        return np.asarray(np.linalg.norm(self.state.displacement, axis=1))

    @property
    def stress_error(self) -> float:
        """Largest stress error of all cells [-]."""
        return float(self.stress_errors[0].max())

    @property
    def stress_errors(self) -> tuple[Array, Array]:
        """Stress errors of all cells, strip by strip [-], and their areas on the surface [m2], both shape (cells,)."""
        strips = self.strips.values()
        return np.concatenate([one.stress_error for one in strips]), np.concatenate([one.area for one in strips])

    @property
    def stress_error_of_most(self) -> float:
        """Stress error that 95 % of the area keep to [-]."""
        return most(*self.stress_errors)

    @property
    def utilisation(self) -> float | None:
        """Largest utilisation of all strips with a strength; None without any [-]."""
        used = [strip.largest_utilisation for strip in self.strips.values()]
        return max((one for one in used if one is not None), default=None)

    @property
    def remarks(self) -> tuple[str, ...]:
        """Sentences on stress beyond the wanted error, with its causes, and on strips beyond their strength."""
        return proof_remarks.remarks(self)

    @property
    def seam_difference(self) -> float:
        """Largest difference of both sides of a seam in the cloth, over its length [-]."""
        return max((edge.difference / edge.surface for edge in self.edges.values()), default=0.0)

    def __str__(self) -> str:
        return proof_tables.text(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers as plain data: sums, and rows of strips and edges, as for CSV and JSON."""
        return proof_tables.data(self)


def prove_pattern(
    pattern: CuttingPattern,
    loads: Sequence[Load] = (),
    *,
    changes: Sequence[Change | GasChange] = (),
    solver: Solver = Newton(),
    strength: float | Mapping[str, float] | None = None,
    roll_width: float | None = None,
    stress_error: float = 0.1,
    comm: MPI.Intracomm = MPI.COMM_WORLD,
    progress: bool = True,
) -> PatternProof:
    """Prove a cutting pattern: sew the cloth together, find the equilibrium on site, compare stress and shape.

    Args:
        pattern: The pattern.
        loads: Loads in the designed shape beside prestress, as the inner pressure of an air hall. The stress error
            includes that of a design which is not at rest under them. One on a membrane that is cut, by its name,
            acts on all its strips.
        changes: As of `Stage`, as the `GasPressure` of a cushion, on strips or membranes as loads are.
        solver: As of `Analysis`.
        strength: Largest stress, strength over safety, for utilisations: of all strips, or of some by name. A
            membrane's name stands for all strips that are cut from it [N/m].
        roll_width: Width of the roll without allowances for welds; the table marks wider strips [m].
        stress_error: Wanted stress error, a share of the design stress: remarks tell where the stress of more than
            5 % of the area is further off, and why. The largest width of strips is told for it, too [-].
        comm: The processes that share the work.
        progress: As of `Analysis`.

    Returns:
        The proof.

    Raises:
        ValueError: It is no pattern; a strip has no prestress to compare with, or a strip with a strength is unknown;
            a strength, width or share is not positive; as of `reassembled` and `Analysis.run`.
        ConvergenceError: The strips sewn together find no equilibrium.

    Example:
        >>> points, triangles = rectangle(8.0, 6.0, 8, 6)
        >>> points[:, 2] = points[:, 0] * points[:, 1] / 12.0  # a hypar, cut along a cable
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable(polyline(range(27, 36)), 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> proof = prove_pattern(cutting_pattern(cut_strips(roof, ["valley"])), progress=False)
        >>> print(str(proof).splitlines()[0])
        Proof of the cutting pattern: 2 strips sewn together, in equilibrium
        >>> bool(proof.shift.max() < 0.02), bool(proof.seam_difference < 1e-9)
        (True, True)
    """
    check_pattern("prove_pattern", pattern)
    structure = reassembled(pattern)
    strips = pattern.strips
    limits = _strengths(strength, strips)
    if roll_width is not None:
        roll_width = validation.positive("prove_pattern roll_width", roll_width)
    share = validation.fraction("prove_pattern stress_error", stress_error)
    stage = Stage(
        "assembly",
        on_strips("prove_pattern loads", strips, loads),
        changes=on_strips("prove_pattern changes", strips, changes),
    )
    _refuse_no_design(pattern)
    state = Analysis(structure, solver, comm, progress=progress).run([stage])["assembly"]
    curvatures = curvature_of_strips(strips)
    proof = PatternProof(
        pattern=pattern,
        state=state,
        strips={
            name: strip_proof(pattern, state, name, curvatures[name], share, limits.get(name)) for name in strips.names
        },
        edges=edge_lengths(pattern),
        roll_width=roll_width,
        wanted_error=share,
        loads=tuple(stage.loads),
        changes=tuple(stage.changes),
    )
    if proof.stress_error_of_most <= share:
        return proof
    return replace(proof, design_error=design_error(strips, stage, solver, comm, progress))


def _refuse_no_design(pattern: CuttingPattern) -> None:
    for name in pattern.strips.names:
        if not pattern.strips.membrane(name).prestress_tensors().any():
            raise ValueError(
                f"Strip {name!r} has no prestress that its stress can be compared with; give its membrane the wanted "
                "one, or analyse reassembled(pattern) for the stress alone."
            )


def _strengths(strength: float | Mapping[str, float] | None, strips: Strips) -> dict[str, float]:
    """Strengths of strips by name [N/m]."""
    if strength is None:
        return {}
    names = strips.names
    given = by_strip(strips, strength) if isinstance(strength, Mapping) else dict.fromkeys(names, strength)
    unknown = [name for name in given if name not in names]
    if unknown:
        raise ValueError(f"prove_pattern strength: {unknown[0]!r} is no strip; the strips are {list(names)}.")
    return {name: validation.positive(f"strength of strip {name!r}", value) for name, value in given.items()}
