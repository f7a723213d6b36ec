"""Strip of a proof: its stress beside that of the design, with the width that its curvature allows."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..geometry.sizes import measures
from ..model.parts import Membrane
from ..model.structure import Structure
from ..results.states import StageResult
from .curvature import gauss_curvature
from .flat_strips import CuttingPattern
from .reassembly import threads
from .strips import Strips

Array = NDArray[np.float64]

FLAT_CURVATURE = 1e-9  # curvature times length squared that counts as none
# Share of the area that errors and curvature are judged on: single cells at corners and rims count little.
JUDGED_SHARE = 0.95


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
        widest: Width at which stress along its edges is off by the wanted share, `2 sqrt(3 e / |K|)`: e is the strain
            that belongs to the share, K the curvature that 95 % of its area keep to. Infinite for a developable
            strip [m].
        utilisation: Largest principal stress over the strength, shape (cells,) [-]; None without one.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> parts = {"roof": Membrane(triangles, Fabric(5e5, 0.3), 2e3), "valley": Cable([[3, 4], [4, 5]], 1e7)}
        >>> roof = Structure(points, parts, [Support(np.unique(boundary_edges(triangles)))])
        >>> strip = prove_pattern(cutting_pattern(cut_strips(roof, ["valley"]))).strips["strip 1"]
        >>> strip.mean(strip.found).round(0).tolist(), bool(strip.stress_error.max() < 0.1)
        ([2000.0, 2000.0], True)
    """

    wanted: Array
    found: Array
    area: Array
    distortion: Array
    length: float
    width: float
    curvature: Array
    widest: float
    utilisation: Array | None

    @property
    def stress_error(self) -> Array:
        """Larger of the differences of warp and weft stress, over the mean stress of the design, shape (cells,) [-]."""
        return np.asarray(np.abs(self.found - self.wanted).max(axis=1) / np.abs(self.mean(self.wanted)).mean())

    @property
    def largest_utilisation(self) -> float | None:
        """Largest utilisation of all cells; None without a strength [-]."""
        return None if self.utilisation is None else float(self.utilisation.max())

    def mean(self, values: Array) -> Array:
        """Mean of values of the cells over the area on the surface, shape (...)."""
        return np.asarray(np.average(values, axis=0, weights=self.area))


def most(values: Array, area: Array) -> float:
    """Value that cells of 95 % of the area do not exceed."""
    order = np.argsort(values)
    covered = np.cumsum(area[order])
    return float(values[order][min(np.searchsorted(covered, JUDGED_SHARE * covered[-1]), len(values) - 1)])


def curvature_of_strips(strips: Strips) -> dict[str, Array]:
    """Gauss curvature of the cells of strips by name, each shape (cells,) [1/m2].

    Films of a cushion meet at an angle: each membrane that is cut has a surface of its own.
    """
    groups: dict[str, list[str]] = defaultdict(list)
    for name in strips.names:
        groups[(strips.membranes or {}).get(name, "")].append(name)
    found: dict[str, Array] = {}
    for names in groups.values():
        cells = [strips.membrane(name).cells for name in names]
        ends = np.cumsum([len(some) for some in cells])[:-1]
        curvature = gauss_curvature(strips.structure.points, np.concatenate(cells))
        found |= zip(names, np.split(curvature, ends), strict=True)
    return found


def strip_proof(
    pattern: CuttingPattern, state: StageResult, name: str, curvature: Array, share: float, limit: float | None
) -> StripProof:
    """Compare a strip as sewn with its design; `limit` is its strength, or None."""
    structure, part = pattern.strips.structure, pattern.strips.membrane(name)
    flat, cloth, found = pattern.flat[name], pattern.cloth[name], state.membrane(name)
    area = measures(structure.points, part.cells)
    wanted = _along(structure, name, threads(structure, part.cells, cloth))
    stress = float(np.abs(np.average(wanted, axis=0, weights=area)).mean())
    strain, steepest = share * stress / part.material.stiffness, most(np.abs(curvature), area)
    return StripProof(
        wanted=wanted,
        found=found.warp_weft_stress,
        area=area,
        distortion=flat.areas / area,
        length=cloth.length,
        width=cloth.width,
        curvature=curvature,
        widest=2 * float(np.sqrt(3 * strain / steepest)) if steepest * cloth.length**2 > FLAT_CURVATURE else np.inf,
        utilisation=None if limit is None else found.principal.max(axis=1) / limit,
    )


def _along(structure: Structure, name: str, thread: Array) -> Array:
    """Take normal stresses of the design along and across threads, shape (k, 2) [N/m]."""
    stress, warp = structure.part(name, Membrane).prestress_tensors(), structure.warp(name)
    c = (warp * thread).sum(axis=1)
    s = (np.cross(structure.normals(name), warp) * thread).sum(axis=1)
    along = np.stack([c, s], axis=1)
    across = np.stack([-s, c], axis=1)
    return np.stack([np.einsum("ki,kij,kj->k", t, stress, t) for t in (along, across)], axis=1)
