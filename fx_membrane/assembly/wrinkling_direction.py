"""Direction of the tension in a wrinkled woven fabric, for many cells at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..checks import validation
from ..model.fabrics import OrthotropicFabric

SAMPLES = 48
MAXIMA = 3  # number of maxima compared: a fabric of strongly negative nu has several
MAX_NEWTON_STEPS = 20
SETTLED_STEP = 1e-12  # step of Newton's method whose next one is rounding [rad]
UNSYMMETRIC = 1e-9  # difference of the shears of a strain over its largest component, beyond rounding
STRAIN_ROUNDING = 1e-12  # the same, of a strain that was computed from stretches near one
STATE_MARGIN = 1e-6  # margin for taut and slack, beyond the rounding in which the forms may decide otherwise


class Moduli(NamedTuple):
    """Moduli of woven fabrics, one for each cell, shape (n,)."""

    Et_warp: NDArray[np.float64]
    Et_weft: NDArray[np.float64]
    nu: NDArray[np.float64]
    Gt: NDArray[np.float64]

    def of(self, cells: NDArray[np.intp]) -> Moduli:
        """Moduli of some cells."""
        return Moduli(*(values[cells] for values in self))


Woven = OrthotropicFabric | Moduli


def tension_direction(
    strain: ArrayLike, Et_warp: ArrayLike, Et_weft: ArrayLike, nu: ArrayLike, Gt: ArrayLike
) -> NDArray[np.float64]:
    """Direction of the tension in the wrinkled cells of a woven fabric: `angle` of `forms.wrinkling.orthotropic`.

    Without compression, a wrinkled cell carries a tension along one direction t. It is that of the largest energy
    e_tt^2 / (2 H_tt), with the compliance H_tt along t. It has no closed form. Solve for it at each strain at which the
    form is evaluated: of the energy, the residual or the tangent. The derivatives of the form are right then.

    Args:
        strain: Total elastic strain E + C^-1 : sigma0 of each cell in the warp/weft frame, shape (n, 2, 2) [-]: the
            Green-Lagrange strain and `forms.elasticity.orthotropic_compliance` of the prestress.
        Et_warp, Et_weft: Modulus times thickness along warp and weft [N/m]: a number, or one for each cell, shape (n,).
        nu: Poisson's ratio, the contraction of the weft under tension in the warp, in the same form [-].
        Gt: Shear modulus times thickness, in the same form [N/m].

    Returns:
        Angles from the warp towards the weft, shape (n,) [rad]; 0 in taut and slack cells, whose energy has no angle.

    Raises:
        ValueError: Strains or moduli have another shape, or are not finite; a strain is not symmetric; a stiffness is
            not positive, or nu^2 Et_weft / Et_warp >= 1.

    Example:
        >>> import numpy as np
        >>> from fx_membrane import tension_direction
        >>> shear = [[[0.0, 0.01], [0.01, 0.0]]]
        >>> np.degrees(tension_direction(shear, Et_warp=5e5, Et_weft=5e5, nu=0.3, Gt=2e4)).round(6)
        array([45.])
    """
    e = validation.finite("tension_direction strain", strain)
    if e.ndim != 3 or e.shape[1:] != (2, 2):
        raise ValueError(f"tension_direction strain has shape {e.shape}; give (n, 2, 2), a tensor for each cell.")
    _refuse_unsymmetric(e)
    n = len(e)
    fabric = Moduli(
        _per_cell("Et_warp", Et_warp, n),
        _per_cell("Et_weft", Et_weft, n),
        _per_cell("nu", nu, n),
        _per_cell("Gt", Gt, n),
    )
    for name in ("Et_warp", "Et_weft", "Gt"):
        lowest = getattr(fabric, name).min(initial=np.inf)
        if lowest <= 0:
            raise ValueError(f"tension_direction {name} is {lowest:g}; it must be positive.")
    if (fabric.nu**2 * fabric.Et_weft >= fabric.Et_warp).any():
        raise ValueError("tension_direction nu^2 Et_weft / Et_warp must be below 1: the energy would not be positive.")
    components = np.stack([e[:, 0, 0], e[:, 1, 1], (e[:, 0, 1] + e[:, 1, 0]) / 2], axis=1)
    cells = np.flatnonzero(may_wrinkle(components, fabric))
    angle = np.zeros(n)
    angle[cells] = direction(components[cells], fabric.of(cells))
    return angle


def _refuse_unsymmetric(e: NDArray[np.float64]) -> None:
    error = np.abs(e[:, 0, 1] - e[:, 1, 0])
    for cell in np.flatnonzero(error > UNSYMMETRIC * np.abs(e).max(axis=(1, 2)) + STRAIN_ROUNDING)[:1]:
        raise ValueError(
            f"tension_direction strain of cell {cell} is {e[cell].tolist()}, which is not symmetric; give tensors with "
            "the same component 12 and 21, half of the engineering shear strain."
        )


def _per_cell(name: str, given: ArrayLike, n: int) -> NDArray[np.float64]:
    values = validation.finite(f"tension_direction {name}", given)
    if values.shape not in ((), (n,)):
        raise ValueError(
            f"tension_direction {name} has shape {values.shape}; give a number, or one for each of {n} cells."
        )
    return np.broadcast_to(values, n)


def direction(e: NDArray[np.float64], fabric: Woven) -> NDArray[np.float64]:
    """Angle from the warp that maximizes <e_tt>^2 / (2 H_tt), shape (n,) [rad].

    The largest values at equally spaced angles are refined to rounding; the best one is returned.

    Args:
        e: Total elastic strains e11, e22, e12 in the warp/weft frame, shape (n, 3) [-]. Without any extended direction
            the angle has no meaning.
        fabric: The fabric.
    """
    angles = np.asarray(np.arange(SAMPLES) * (np.pi / SAMPLES), dtype=np.float64)
    energies = _energy(angles[:, None], e, fabric)
    higher = np.maximum(np.roll(energies, 1, axis=0), np.roll(energies, -1, axis=0))
    peaks = np.where(energies >= higher, energies, -np.inf)
    best, largest, every = np.zeros(len(e)), np.full(len(e), -np.inf), np.arange(len(e))
    for _ in range(MAXIMA):
        peak = np.argmax(peaks, axis=0)
        # A maximum where t is shortened can lead to the narrow cone of extended directions, until that is found.
        cells = np.flatnonzero((peaks[peak, every] > 0) | ((largest <= 0) & (peaks[peak, every] > -np.inf)))
        if not len(cells):
            break
        peaks[peak, every] = -np.inf
        some = fabric.of(cells) if isinstance(fabric, Moduli) else fabric
        angle = _refined(angles[peak[cells]], e[cells], some)
        energy = _energy(angle, e[cells], some)
        best[cells] = np.where(energy > largest[cells], angle, best[cells])
        largest[cells] = np.maximum(energy, largest[cells])
    return best


def may_wrinkle(e: NDArray[np.float64], fabric: Woven) -> NDArray[np.bool_]:
    """Cells that are neither clearly taut nor clearly slack, shape (n,): those that need a direction.

    Args:
        e: Total elastic strains as for `direction`, shape (n, 3) [-].
        fabric: The fabric.
    """
    e11, e22, e12 = e.T
    nu_weft = fabric.nu * fabric.Et_weft / fabric.Et_warp
    S11 = fabric.Et_warp * (e11 + nu_weft * e22) / (1 - fabric.nu * nu_weft)
    S22 = fabric.Et_weft * (e22 + fabric.nu * e11) / (1 - fabric.nu * nu_weft)
    S12 = 2 * fabric.Gt * e12
    taut = (S11 + S22 > 0) & (S11 * S22 - S12**2 > STATE_MARGIN * (S11 + S22) ** 2)
    largest = (e11 + e22) / 2 + np.hypot((e11 - e22) / 2, e12)
    slack = largest < -STATE_MARGIN * np.abs(e).max(axis=1)
    return np.asarray(~taut & ~slack)


def _refined(
    angle: NDArray[np.float64],
    e: NDArray[np.float64],
    fabric: Woven,
) -> NDArray[np.float64]:
    """Refine the maximum beside a sample by Newton's method within a bracket that bisection narrows."""
    low, high = angle - np.pi / SAMPLES, angle + np.pi / SAMPLES
    settled = np.zeros(len(angle), dtype=bool)  # cell by cell: the angle does not depend on other cells
    for _ in range(MAX_NEWTON_STEPS):
        f, slope = _stationarity(angle, e, fabric)
        low, high = np.where(f > 0, angle, low), np.where(f > 0, high, angle)
        with np.errstate(divide="ignore", invalid="ignore"):
            newton = angle - f / slope
        last, angle = angle, np.where((newton >= low) & (newton <= high), newton, (low + high) / 2)
        angle = np.where(settled, last, angle)
        settled |= np.abs(angle - last) < SETTLED_STEP
        if settled.all():
            break
    return angle


def _energy(
    angle: NDArray[np.float64],
    e: NDArray[np.float64],
    fabric: Woven,
) -> NDArray[np.float64]:
    """Double the energy of a tension along t, e_tt^2 / H_tt; negative where t is shortened."""
    (e11, e22, e12), c, s = e.T, np.cos(angle), np.sin(angle)
    e_tt = c**2 * e11 + s**2 * e22 + 2 * c * s * e12
    return np.asarray(np.sign(e_tt) * e_tt**2 / _compliance(c, s, fabric))


def _compliance(c: NDArray[np.float64], s: NDArray[np.float64], fabric: Woven) -> NDArray[np.float64]:
    mixed = 1 / fabric.Gt - 2 * fabric.nu / fabric.Et_warp
    return np.asarray(c**4 / fabric.Et_warp + s**4 / fabric.Et_weft + c**2 * s**2 * mixed)


def _stationarity(
    angle: NDArray[np.float64],
    e: NDArray[np.float64],
    fabric: Woven,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """f = 2 e_tt' H_tt - e_tt H_tt', which has the sign of the slope of `_energy`; and f'."""
    (e11, e22, e12), c, s = e.T, np.cos(angle), np.sin(angle)
    mixed = 1 / fabric.Gt - 2 * fabric.nu / fabric.Et_warp
    a = c**2 * e11 + s**2 * e22 + 2 * c * s * e12
    a1 = 2 * c * s * (e22 - e11) + 2 * (c**2 - s**2) * e12
    a2 = 2 * (c**2 - s**2) * (e22 - e11) - 8 * c * s * e12
    H = _compliance(c, s, fabric)
    H1 = -4 * c**3 * s / fabric.Et_warp + 4 * s**3 * c / fabric.Et_weft + 2 * c * s * (c**2 - s**2) * mixed
    H2 = (
        (12 * c**2 * s**2 - 4 * c**4) / fabric.Et_warp
        + (12 * s**2 * c**2 - 4 * s**4) / fabric.Et_weft
        + 2 * ((c**2 - s**2) ** 2 - 4 * c**2 * s**2) * mixed
    )
    f = 2 * a1 * H - a * H1
    f1 = 2 * a2 * H + a1 * H1 - a * H2
    return f, f1
