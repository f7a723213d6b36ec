"""Proof of a cutting pattern: equilibrium of the strips sewn together again, compared with the design."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..analysis.stages import Analysis
from ..checks import validation
from ..checks.values import counted
from ..geometry.sizes import measures
from ..model.loads import Load
from ..model.parts import Membrane
from ..model.stages import Stage
from ..model.structure import Structure
from ..results.states import StageResult
from ..solvers.base import Solver
from ..solvers.newton import Newton
from . import proof_tables
from .curvature import gauss_curvature
from .flat_strips import CuttingPattern, FlatStrip, check_pattern
from .reassembly import reassembled, threads

Array = NDArray[np.float64]

FLAT = 1e-9  # curvature times length squared that counts as none


class SeamLengths(NamedTuple):
    """Lengths of an edge [m].

    Attributes:
        surface: On the surface.
        flat: In the flat shapes, on each of its sides, shape (sides,).
        cloth: In the cloth, on each of its sides, shape (sides,).
    """

    surface: float
    flat: Array
    cloth: Array

    @property
    def difference(self) -> float:
        """Difference of both sides in the cloth, zero for a border [m]."""
        return float(np.ptp(self.cloth))


@dataclass(frozen=True, eq=False)
class StripProof:
    """Strip as sewn, beside its design.

    Attributes:
        wanted: Stress of the design along warp and weft of the cloth, shape (cells, 2) [N/m].
        found: Stress found there, shape (cells, 2) [N/m].
        area: Areas of the cells on the surface, shape (cells,) [m2].
        distortion: Flat area over the area on the surface, shape (cells,) [-].
        length: Length of the cloth along the warp [m].
        width: Width of the cloth along the weft [m].
        curvature: Gauss curvature of the surface, shape (cells,) [1/m2].
        widest: Width at which stress along its edges is off by the wanted share, by the largest curvature:
            `2 sqrt(3 e / |K|)`, e the strain that belongs to the share; infinite for a developable strip [m].
        utilisation: Largest principal stress over the strength; None without one [-].
    """

    wanted: Array
    found: Array
    area: Array
    distortion: Array
    length: float
    width: float
    curvature: Array
    widest: float
    utilisation: float | None

    @property
    def stress_error(self) -> Array:
        """Larger of the differences of warp and weft stress, over the mean stress of the design, shape (cells,) [-]."""
        return np.asarray(np.abs(self.found - self.wanted).max(axis=1) / np.abs(self.mean(self.wanted)).mean())

    def mean(self, values: Array) -> Array:
        """Mean of values of the cells over the area on the surface, shape (...)."""
        return np.asarray(np.average(values, axis=0, weights=self.area))


@dataclass(frozen=True, eq=False)
class PatternProof:
    """Proof that a cutting pattern fits; as text, a table.

    Attributes:
        pattern: The pattern.
        state: Equilibrium of the strips sewn together, with displacements from the designed shape.
        strips: Strips by name.
        edges: Lengths of edges by name.
        roll_width: Width of the roll without allowances, or None [m].
        wanted_error: Share of the design stress that `StripProof.widest` belongs to [-].
        loads: Loads in the designed shape.
    """

    pattern: CuttingPattern
    state: StageResult
    strips: Mapping[str, StripProof]
    edges: Mapping[str, SeamLengths]
    roll_width: float | None
    wanted_error: float
    loads: tuple[Load, ...] = ()

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
        return max(float(strip.stress_error.max()) for strip in self.strips.values())

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
            includes that of a design which is not at rest under them.
        solver: As of `Analysis`.
        strength: Largest stress, strength over safety, of all strips or of some by name, for their utilisation [N/m].
        roll_width: Width of the roll without allowances for welds; the table marks wider strips [m].
        stress_error: Share of the design stress for which the largest width of strips is told [-].
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
    limits = _strengths(strength, strips.names)
    if roll_width is not None:
        roll_width = validation.positive("prove_pattern roll_width", roll_width)
    share = validation.positive("prove_pattern stress_error", stress_error)
    stage = Stage("assembly", loads)
    _refuse_no_design(pattern)
    state = Analysis(structure, solver, comm, progress=progress).run([stage])["assembly"]
    whole = np.concatenate([strips.membrane(name).cells for name in strips.names])
    curvature = gauss_curvature(structure.points, whole)
    ends = np.cumsum([len(strips.membrane(name).cells) for name in strips.names])[:-1]
    by_strip = dict(zip(strips.names, np.split(curvature, ends), strict=True))
    return PatternProof(
        pattern=pattern,
        state=state,
        strips={name: _strip(pattern, state, name, by_strip[name], share, limits.get(name)) for name in strips.names},
        edges=_edges(pattern),
        roll_width=roll_width,
        wanted_error=share,
        loads=tuple(stage.loads),
    )


def _refuse_no_design(pattern: CuttingPattern) -> None:
    for name in pattern.strips.names:
        if not pattern.strips.membrane(name).prestress_tensors().any():
            raise ValueError(
                f"Strip {name!r} has no prestress that its stress can be compared with; give its membrane the wanted "
                "one, or analyse reassembled(pattern) for the stress alone."
            )


def _strengths(strength: float | Mapping[str, float] | None, names: Sequence[str]) -> dict[str, float]:
    """Strengths of strips by name [N/m]."""
    if strength is None:
        return {}
    given = dict(strength) if isinstance(strength, Mapping) else dict.fromkeys(names, strength)
    unknown = [name for name in given if name not in names]
    if unknown:
        raise ValueError(f"prove_pattern strength: {unknown[0]!r} is no strip; the strips are {list(names)}.")
    return {name: validation.positive(f"strength of strip {name!r}", value) for name, value in given.items()}


def _strip(
    pattern: CuttingPattern, state: StageResult, name: str, curvature: Array, share: float, limit: float | None
) -> StripProof:
    structure, part = pattern.strips.structure, pattern.strips.membrane(name)
    flat, cloth, found = pattern.flat[name], pattern.cloth[name], state.membrane(name)
    area = measures(structure.points, part.cells)
    wanted = _along(structure, name, threads(structure, part.cells, cloth))
    stress = float(np.abs(np.average(wanted, axis=0, weights=area)).mean())
    strain, steepest = share * stress / part.material.stiffness, float(np.abs(curvature).max())
    return StripProof(
        wanted=wanted,
        found=found.warp_weft_stress,
        area=area,
        distortion=flat.areas / area,
        length=cloth.length,
        width=cloth.width,
        curvature=curvature,
        widest=2 * float(np.sqrt(3 * strain / steepest)) if steepest * cloth.length**2 > FLAT else np.inf,
        utilisation=None if limit is None else float(found.principal.max() / limit),
    )


def _along(structure: Structure, name: str, thread: Array) -> Array:
    """Take normal stresses of the design along and across threads, shape (k, 2) [N/m]."""
    stress, warp = structure.part(name, Membrane).prestress_tensors(), structure.warp(name)
    c = (warp * thread).sum(axis=1)
    s = (np.cross(structure.normals(name), warp) * thread).sum(axis=1)
    along = np.stack([c, s], axis=1)
    across = np.stack([-s, c], axis=1)
    return np.stack([np.einsum("ki,kij,kj->k", t, stress, t) for t in (along, across)], axis=1)


def _edges(pattern: CuttingPattern) -> dict[str, SeamLengths]:
    points = pattern.strips.structure.points
    return {
        edge.name: SeamLengths(
            surface=float(np.linalg.norm(np.diff(points[edge.nodes], axis=0), axis=1).sum()),
            flat=_sides(pattern.flat, edge.name),
            cloth=_sides(pattern.cloth, edge.name),
        )
        for edge in pattern.strips.edges
    }


def _sides(flat: Mapping[str, FlatStrip], edge: str) -> Array:
    """Lengths of an edge on all its sides, shape (sides,) [m]."""
    return np.array([one.side_lengths(side).sum() for one in flat.values() for side in one.sides if side.edge == edge])
