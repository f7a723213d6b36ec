"""State of a part: strains, and stresses of membranes or forces of cables and masts."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks.values import counted
from ..runtime.notebook_pictures import table
from .plain_numbers import plain

Array = NDArray[np.float64]
SHEAR = "strain shear [-]"


class Column(NamedTuple):
    """Column of tables, in files, scenes and notebooks.

    Attributes:
        head: Its name; "{stress}" stands for the unit of the stresses of the part.
        field: Name of the quantity, a field or a property.
        component: Indices of one component of it.
    """

    head: str
    field: str
    component: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False, repr=False)
class MembraneResult:
    """State of a membrane; stresses are forces per length, divide by the thickness for [Pa].

    Attributes:
        strain: Green-Lagrange strain in the warp/weft frame, shape (cells, 2, 2) [-]. It counts from the natural shape
            where there is one, or else from the reference shape.
        second_piola_kirchhoff: Stress per reference length in the warp/weft frame, shape (cells, 2, 2) [N/m], Gil (32).
        cauchy: Stress per current length in global axes, shape (cells, 3, 3) [N/m].
        principal: Principal values of `cauchy`, the larger first, shape (cells, 2) [N/m].
        warp_weft_stress: Normal components of `cauchy` along the current warp and weft, shape (cells, 2) [N/m].
        state: "taut", "wrinkled" or "slack", shape (cells,). With `compression_stiffness=1` the membrane neither
            wrinkles nor slackens: all cells are "taut", even if `principal` shows compression.
        cauchy_projected: Cauchy stress of Gil (19) with J = det(I + grad u), the paper's Table 2, in global axes, shape
            (cells, 3, 3) [N/m]. It is larger than `cauchy` where cells have turned.

    Example:
        >>> points, triangles = rectangle(2.0, 2.0, 2, 2)
        >>> rim = Support(np.unique(boundary_edges(triangles)))
        >>> sheet = Structure(points, {"sheet": Membrane(triangles, Fabric(4e5, 0.3), prestress=2e3)}, [rim])
        >>> state = Analysis(sheet).run([Stage("rest")])["rest"].membrane("sheet")
        >>> state.principal[0].round(6).tolist(), bool(state.taut.all())
        ([2000.0, 2000.0], True)
    """

    dimension: ClassVar[Literal[2]] = 2
    columns: ClassVar[tuple[Column, ...]] = (
        Column("state", "state"),
        Column("strain warp [-]", "strain", (0, 0)),
        Column("strain weft [-]", "strain", (1, 1)),
        Column(SHEAR, "strain", (0, 1)),
        Column("principal stress I{stress}", "principal", (0,)),
        Column("principal stress II{stress}", "principal", (1,)),
        Column("stress along warp{stress}", "warp_weft_stress", (0,)),
        Column("stress along weft{stress}", "warp_weft_stress", (1,)),
    )
    strain: Array
    second_piola_kirchhoff: Array
    cauchy: Array
    principal: Array
    cauchy_projected: Array
    warp_weft_stress: Array
    state: NDArray[np.str_]

    def __repr__(self) -> str:
        kinds = ", ".join(f"{np.count_nonzero(self.state == kind)} {kind}" for kind in ("taut", "wrinkled", "slack"))
        return f"MembraneResult({counted(len(self.state), 'cell')}: {kinds}; principal stress {_range(self.principal)})"

    def _repr_html_(self) -> str:
        """Show the extremes in notebooks, each with its cell."""
        return _extremes(self)

    @property
    def taut(self) -> NDArray[np.bool_]:
        """Cells that are neither wrinkled nor slack, shape (cells,)."""
        return self.state == "taut"

    @property
    def slack(self) -> NDArray[np.bool_]:
        """Cells without tension, shape (cells,)."""
        return self.state == "slack"


@dataclass(frozen=True, eq=False, repr=False)
class BarResult:
    """State of cables or masts.

    Attributes:
        strain: Green-Lagrange strain with respect to the natural length where there is one, or else to the reference
            length, shape (cells,) [-].
        force: Axial force in the current shape, tension positive, shape (cells,) [N].
        slack: Cells without tension, shape (cells,); False for masts, and for cables with `compression_stiffness=1`.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> pull = Stage("pull", [PointLoad(1, (0, 0, -10.0))])
        >>> bar = Analysis(rope).run([pull])["pull"].cable("rope")
        >>> bar.force.round(1).tolist(), bar.state.tolist()
        ([1012.2, 1012.2], ['taut', 'taut'])
    """

    dimension: ClassVar[Literal[1]] = 1
    columns: ClassVar[tuple[Column, ...]] = (
        Column("state", "state"),
        Column("strain [-]", "strain"),
        Column("force{stress}", "force"),
    )
    strain: Array
    force: Array
    slack: NDArray[np.bool_]

    def __repr__(self) -> str:
        slack = f"{np.count_nonzero(self.slack)} slack"
        return f"{type(self).__name__}({counted(len(self.force), 'cell')}: {slack}; force {_range(self.force)})"

    def _repr_html_(self) -> str:
        """Show the extremes in notebooks, each with its cell."""
        return _extremes(self)

    @property
    def taut(self) -> NDArray[np.bool_]:
        """Cells that are not slack, shape (cells,)."""
        return ~self.slack

    @property
    def state(self) -> NDArray[np.str_]:
        """State of each cell, "taut" or "slack", shape (cells,)."""
        return np.where(self.slack, "slack", "taut")

    @property
    def principal(self) -> Array:
        """Axial force as the one principal value of a bar, shape (cells, 1) [N]; see `MembraneResult`."""
        return self.force[:, None]


@dataclass(frozen=True, eq=False, repr=False)
class RopeResult(BarResult):
    """State of a rope; strain, force and slack are equal in all its segments.

    Attributes:
        length: Current length of the whole rope [m].
        unstressed_length: Its length without stress, for a rope with a prestress [m]: by the Green-Lagrange strain
            that belongs to it. Of a rope of given force, the length that gives this force when it is fixed.

    Example:
        >>> points = [(0, 0, 0), (4, 0, -3), (10, 0, 2)]
        >>> line = Structure(points, {"rope": Rope([0, 1, 2], 1e6, unstressed_length=12.0)}, [Support([0, 2])])
        >>> rope = Analysis(line).run([Stage("weight", [PointLoad(1, (0, 0, -1e4))])])["weight"].rope("rope")
        >>> round(rope.tension, 2), round(rope.length, 6), rope.unstressed_length
        (8872.72, 12.105088, 12.0)
    """

    length: float
    unstressed_length: float

    @property
    def tension(self) -> float:
        """Tension of the whole rope [N]."""
        return float(self.force[0])


def quantities(found: MembraneResult | BarResult) -> dict[str, NDArray[Any]]:
    """Quantities of the cells by the names of their fields; those that an older archive lacks are left out."""
    values = {entry.name: getattr(found, entry.name) for entry in fields(found)}
    return {name: value for name, value in values.items() if np.ndim(value)}


def columns_of(found: MembraneResult | BarResult, unit: str = "") -> dict[str, NDArray[Any]]:
    """Columns of tables by head, with the unit of stresses, each (cells,); of the quantities that there are."""
    known: dict[str, Any] = {"state": found.state, **quantities(found)}
    stress = f" [{unit}]" if unit else ""
    return {
        entry.head.format(stress=stress): known[entry.field][..., *entry.component]
        for entry in found.columns
        if entry.field in known
    }


def _range(values: Array) -> str:
    return f"{plain(values.min())} to {plain(values.max())}"


def _extremes(found: MembraneResult | BarResult) -> str:
    """Table of the least and the largest value of each column of numbers, with their cells."""
    cells = [
        [name, *(text for cell in (values.argmin(), values.argmax()) for text in (plain(values[cell]), str(cell)))]
        for name, values in columns_of(found).items()
        if values.dtype.kind == "f"
    ]
    return f"<b>{found!r}</b>" + table(["quantity", "least", "in cell", "largest", "in cell"], cells)
