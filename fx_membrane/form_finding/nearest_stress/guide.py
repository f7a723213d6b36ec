"""Constraints on the way to the nearest stress: motions of nodes, and cables whose force is no wish but given."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from ...geometry.vector_columns import lengths
from ...model.structure import Structure
from ..balance.constrained_balance import Balance, ConstrainedBalance
from ..constraints.bodies import tangents
from ..constraints.motions import Motions
from ..plan import Plan
from ..reasons.tangents import line_tangents

Array = NDArray[np.float64]
Segments = NDArray[np.int64]

# Ranges: tests/benchmarks/form_finding_constants.py, on 24 rings and rigid bodies.
SLIDES = 0.05  # part of a motion of a body off its lines, below which it slides along them; same from 0.005 to 0.5
# A central difference of length SHORT errs by its square, 1e-8, and by rounding over it, 1e-12: both below NEUTRAL.
NEUTRAL = (
    1e-6  # work of forces on a slide, and its change, over the forces, that count as none; the same from 1e-7 to 1e-5
)
DIFFERENCE_LENGTH = 1e-4  # length of a difference over the extent of a body; the same from 1e-5 to 1e-3


class BodyWays(NamedTuple):
    """Motions of rings and rigid bodies that change the shape, and those along their own lines, such as a spin.

    Attributes:
        across: The former as combinations of all motions of bodies, sparse (k, a).
        along: The latter, which leave the shape as it is, sparse (k, b).
    """

    across: sparse.csr_matrix
    along: sparse.csr_matrix


class MotionGuide:
    """Motions of nodes that supports and constraints leave, at a shape.

    Args:
        motions: The motions.
    """

    def __init__(self, motions: Motions) -> None:
        self.motions = motions
        self.free = ~motions.held  # components of nodes that move one by one, shape (n, 3)
        self.free[motions.slides] = True
        for body in motions.bodies:
            self.free[body.nodes] = False
        basis, columns = motions.basis()
        self.single = basis[:, : columns[0][0] if columns else basis.shape[1]]
        self.slides = [True] * len(motions.bodies)

    def projected(self, triads: Array) -> Array:
        """Directions of nodes, shape (n, 3, 3), with those of sliding nodes projected on their way."""
        ways, slides = self.motions.free, self.motions.slides
        if len(slides):
            triads = triads.copy()
            triads[slides] = triads[slides] @ ways @ ways.swapaxes(1, 2)
        return triads

    def of_bodies(self, points: Array) -> sparse.csc_matrix:
        """Motions of rings and rigid bodies in a shape, orthonormal columns, sparse (3 n, k)."""
        rows, columns, values, count = [np.zeros(0, int)], [np.zeros(0, int)], [np.zeros(0)], 0
        for body in self.motions.bodies:
            block = tangents(body, points)[0]
            rows.append(np.repeat((3 * body.nodes[:, None] + np.arange(3)).ravel(), block.shape[1]))
            columns.append(np.tile(count + np.arange(block.shape[1]), 3 * len(body.nodes)))
            values.append(block.ravel())
            count += block.shape[1]
        entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
        return sparse.coo_matrix(entries, shape=(points.size, count)).tocsc()

    def bind(self, points: Array, lines: Segments, forces: Callable[[Array], Array]) -> None:
        """Keep bodies from sliding along their lines where forces on them work on it, as of cables that meet there.

        Args:
            points: The shape, shape (n, 3) [m].
            lines: Segments of lines, shape (s, 2).
            forces: Forces on the nodes in a shape, both of shape (n, 3) [N].
        """
        along, start, first = self.of_bodies(points) @ self.split(points, lines).along, forces(points), 0
        for number, (body, ways) in enumerate(zip(self.motions.bodies, self._split(points, lines), strict=True)):
            turned = ways[1].T @ tangents(body, points, start)[1] @ ways[1]
            short = DIFFERENCE_LENGTH * float(np.ptp(points[body.nodes], axis=0).max())
            size = NEUTRAL * float(np.linalg.norm(start[body.nodes], axis=1).sum())
            for column in range(ways[1].shape[1]):
                way = along[:, [first + column]].toarray().reshape(points.shape)
                rise = np.sum(way * (forces(points + short * way) - forces(points - short * way))) / (2 * short)
                change = abs(float(rise + turned[column, column])) * short / DIFFERENCE_LENGTH
                self.slides[number] &= bool(abs(float(np.sum(way * start))) <= size and change <= size)
            first += ways[1].shape[1]

    def split(self, points: Array, lines: Segments) -> BodyWays:
        """Tell motions of bodies along their own lines from all others.

        Args:
            points: The shape, shape (n, 3) [m].
            lines: Segments of lines, shape (s, 2); those with both ends in a body are its own.
        """
        pairs = self._split(points, lines)
        return BodyWays(_diagonal([across for across, _ in pairs]), _diagonal([along for _, along in pairs]))

    def _split(self, points: Array, lines: Segments) -> list[tuple[Array, Array]]:
        """Combine the motions of each body across its lines, and along them, as columns."""
        found = []
        for body, slides in zip(self.motions.bodies, self.slides, strict=True):
            columns = tangents(body, points)[0].reshape(len(body.nodes), 3, -1)
            own = lines[np.isin(lines, body.nodes).all(axis=1)]
            unit = line_tangents(points, own)[body.nodes]
            off = columns - unit[:, :, None] * np.einsum("kx,kxm->km", unit, columns)[:, None]
            _, size, ways = np.linalg.svd(off.reshape(-1, columns.shape[2]), full_matrices=False)
            stays = (size > SLIDES) | (not slides)
            found.append((ways[stays].T, ways[~stays].T))
        return found

    def turning(self, points: Array, forces: Array) -> sparse.csr_matrix:
        """Derive the work of forces on each motion of bodies by each, sparse (k, k).

        Args:
            points: The shape, shape (n, 3) [m].
            forces: Forces on the nodes, shape (n, 3) [N].
        """
        return _diagonal([tangents(body, points, forces)[1] for body in self.motions.bodies])

    def basis(self, points: Array) -> sparse.csr_matrix:
        """All motions in a shape, sparse (3 n, m)."""
        if not self.motions.bodies:
            return self.single
        return sparse.hstack([self.single, self.of_bodies(points)]).tocsr()


def _diagonal(blocks: list[Array]) -> sparse.csr_matrix:
    """Matrix of blocks on its diagonal, some without rows or columns."""
    found = [sparse.csr_matrix(block) for block in blocks]
    return sparse.block_diag(found).tocsr() if found else sparse.csr_matrix((0, 0))


class CableGuide:
    """Cables whose force, or the geometry that gives it, is that of a constraint.

    Args:
        structure: The structure in its first shape.
        balance: Its balance under constraints.
        plans: Membranes in that shape, with the stress wished for.
    """

    def __init__(self, structure: Structure, balance: ConstrainedBalance, plans: Mapping[str, Plan]) -> None:
        self.balance, targets = balance, balance.targets
        self.given = {name: np.zeros(len(bar.cells), dtype=bool) for name, bar in targets.bars.items()}
        for constraint, cells in targets.given:
            self.given[constraint.part][cells] = True
        for name, line, *_ in targets.targets:
            self.given[name][line.cells] = True
        self.first = balance.start(plans)

    def densities(self, points: Array, before: Mapping[str, Array] | None) -> dict[str, Array]:
        """Force densities that constraints give in a shape, from those of a shape before, by part [N/m]."""
        targets = self.balance.targets
        return targets.mixed(targets.by_force(points), self.first if before is None else before)

    def forces(self, points: Array, densities: Mapping[str, Array]) -> dict[str, Array]:
        """Give the forces of bars in a shape of some force densities, by part, shape (cells,) [N]."""
        asked = self.balance.targets.asked(points, densities)
        return {name: bar.prestress_tensors().ravel() for name, bar in asked.items()}

    def growth(self, name: str, acting: NDArray[np.bool_], corners: Array) -> Callable[[Array], Array]:
        """Return the factor of forces of acting cells of a bar, of corners in columns, over those of some corners."""
        kinds = self.balance.targets.kinds[name][acting]
        steered = np.zeros(len(self.given[name]), dtype=bool)  # of given geometry: one force in each solve
        for of, line, *_ in self.balance.targets.targets:
            if of == name:
                steered[line.cells] = True
        by_density = (kinds == "force density") & ~steered[acting]
        horizontal = (kinds == "horizontal force") & ~steered[acting]

        def ratio(at: Array) -> Array:
            way = at[1] - at[0]
            length, flat = lengths(way), np.hypot(way[0], way[1])
            return np.where(by_density, length, np.where(horizontal, length / np.where(horizontal, flat, 1.0), 1.0))

        first = ratio(corners)
        return lambda at: ratio(at) / first

    def balanced(self, start: Array, plans: dict[str, Plan], densities: dict[str, Array]) -> Balance:
        """Balance that meets the constraints; force densities of other bars stay.

        Raises:
            ValueError, RuntimeError: There is none.
        """
        found = self.balance.settled(start, plans, densities, 1, meets_forces=True)
        if isinstance(found, str):
            raise RuntimeError(found)
        return found
