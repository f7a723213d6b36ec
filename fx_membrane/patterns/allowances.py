"""Allowances: widths of cloth beyond the sewing lines, and the cut of their corners."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from ..checks import validation
from ..geometry.length_units import METRES
from .strips import Edge

CORNERS = ("mitre", "straight")
SEAM, BORDER = 0.02, 0.05  # usual widths [m]


@dataclass(frozen=True)
class Allowances:
    """Widths of cloth between sewing line and cut line.

    Args:
        seam: Width on each side of a seam; a lap weld that is centred on the sewing line needs half of its width. None
            for 20 mm, in the unit of the pattern [m].
        border: Width at borders, as for a hem or a clamp; None for 50 mm [m].
        pocket: Width at borders along which a cable runs; None for that of borders [m].
        edges: Width at single edges, by the name of the edge, or of the cable or rope along it [m].
        corners: "mitre" continues both cut lines to the point where they meet; "straight" cuts from the end of one to
            the end of the other.
        mitre_limit: Largest distance of a mitred corner from the corner of the sewing line, over the larger of the two
            widths; sharper corners are cut off there, at a right angle to that distance [-].

    Raises:
        ValueError: A width is negative; corners is none of the two; mitre_limit is less than one.

    Example:
        >>> Allowances(seam=0.02, border=0.05, edges={"border 2": 0.12}).mitre_limit
        1.5
    """

    seam: float | None = None
    border: float | None = None
    pocket: float | None = None
    edges: Mapping[str, float] = field(default_factory=dict)
    corners: str = "mitre"
    mitre_limit: float = 1.5

    def __post_init__(self) -> None:
        for key in ("seam", "border", "pocket"):
            if getattr(self, key) is not None:
                validation.store(self, validation.not_negative, key)
        validation.instance("Allowances edges", self.edges, Mapping)
        widths = {
            validation.name("Allowances edges name", edge): validation.not_negative(
                f"Allowances edges[{edge!r}]", width
            )
            for edge, width in self.edges.items()
        }
        validation.choice("Allowances corners", self.corners, CORNERS, f"one of {list(CORNERS)}")
        limit = validation.number("Allowances mitre_limit", self.mitre_limit)
        if limit < 1:
            raise ValueError(f"Allowances mitre_limit is {limit:g}; give at least 1.")
        validation.keep(self, edges=widths, mitre_limit=limit)

    def in_unit(self, length_unit: str) -> Allowances:
        """Return the allowances with the usual widths of seams and borders in a unit; unknown units count as metres."""
        metre = 1 / METRES.get(length_unit, 1.0)
        return replace(
            self,
            seam=SEAM * metre if self.seam is None else self.seam,
            border=BORDER * metre if self.border is None else self.border,
        )

    @property
    def of_seams(self) -> float:
        """Width at seams; the usual one in metres where none is given [m]."""
        return SEAM if self.seam is None else self.seam

    @property
    def of_borders(self) -> float:
        """Width at borders without a line; the usual one in metres where none is given [m]."""
        return BORDER if self.border is None else self.border

    def of(self, edge: Edge) -> float:
        """Width at an edge [m]."""
        if (name := self._named(edge)) is not None:
            return self.edges[name]
        if edge.is_seam:
            return self.of_seams
        return self.of_borders if edge.line is None or self.pocket is None else self.pocket

    def check_widths(self, edges: Iterable[Edge], widths: Mapping[str, float]) -> None:
        """Refuse allowances wider than half of the widest strip, as of another unit.

        Args:
            edges: Edges of the strips.
            widths: Widths of the strips by name [m].

        Raises:
            ValueError: One is.
        """
        strip = max(widths, key=lambda name: widths[name])
        for edge in edges:
            if 2 * self.of(edge) > widths[strip]:
                raise ValueError(
                    f"Allowances {self._kind(edge)} is {self.of(edge):g}, more than half of the widest strip, "
                    f"{strip!r} with {widths[strip]:.4g}; give it in the unit of the points, as 0.02 [m] for 20 mm."
                )

    def _named(self, edge: Edge) -> str | None:
        """Name in `edges` that an edge has its width from: its own, or else that of its line."""
        return next((name for name in (edge.name, edge.line) if name in self.edges), None)

    def _kind(self, edge: Edge) -> str:
        """Name of the argument that an edge has its width from."""
        if (name := self._named(edge)) is not None:
            return f"edges[{name!r}]"
        if edge.is_seam:
            return "seam"
        return "border" if edge.line is None or self.pocket is None else "pocket"

    def check_names(self, edges: Iterable[Edge]) -> None:
        """Refuse names that are of no edge.

        Raises:
            ValueError: One is.
        """
        edges = tuple(edges)
        known = [edge.name for edge in edges] + sorted({edge.line for edge in edges if edge.line})
        for name in self.edges:
            if name not in known:
                raise ValueError(f"Allowances edges names {name!r}, which is no edge; there are {', '.join(known)}.")
