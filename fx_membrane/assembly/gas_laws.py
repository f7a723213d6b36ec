"""Energy of the gas in a chamber by its volume, and that of the air that it displaces.

    dE/dV = -p = p_air - p_abs(V),    p_abs = (a / V) (V0 / V)^(n - 1)

with the amount a = p V of the gas in the volume V0, at the present temperature, and the polytropic exponent n. The
energy is convex: d2E/dV2 = n p_abs / V.
"""

from __future__ import annotations

import math
from typing import NamedTuple

CRUSHED_VOLUME = 1e-2  # volume, as a fraction of that at the pressure around, below which the law goes on as a parabola


class Fan(NamedTuple):
    """Gas at a pressure above that around [Pa]."""

    pressure: float

    def energy(self, volume: float) -> float:
        """Energy [J]."""
        return -self.pressure * volume

    def force(self, volume: float) -> float:
        """Minus the pressure [Pa]."""
        return -self.pressure

    def stiffness(self, volume: float) -> float:
        """Zero."""
        return 0.0

    def size(self, volume: float) -> float:
        """Size of the energy [J]."""
        return abs(self.pressure * volume)

    def force_size(self, volume: float) -> float:
        """Size of the pressure [Pa]."""
        return abs(self.pressure)


class Enclosed(NamedTuple):
    """A given amount of gas.

    Below a hundredth of the volume that it takes at the pressure around, the energy goes on as a parabola: iterates may
    start from a flat chamber.

    Attributes:
        amount: p V in the reference volume [J].
        reference: Reference volume V0 [m3].
        exponent: Polytropic exponent n [-].
        around: Absolute pressure of the air around [Pa].
    """

    amount: float
    reference: float
    exponent: float
    around: float

    @property
    def least(self) -> float:
        """Volume below which the energy is a parabola [m3]."""
        n = self.exponent
        return CRUSHED_VOLUME * (self.amount * self.reference ** (n - 1) / self.around) ** (1 / n)

    def energy(self, volume: float) -> float:
        """Energy, that in the reference volume being zero [J]."""
        at = max(volume, self.least)
        less = volume - at
        more = self.force(at) * less + self._stiffness(at) * less**2 / 2 if less else 0.0
        if at <= 0:
            return self.around * (volume - self.reference)
        n, grown = self.exponent, at - self.reference
        log = -math.log1p(grown / self.reference)  # small changes of volume keep their digits
        gas = self.amount * (log if n == 1 else math.expm1((n - 1) * log) / (n - 1))
        return gas + self.around * grown + more

    def force(self, volume: float) -> float:
        """Minus the pressure above that around [Pa]."""
        at = max(volume, self.least)
        return self.around - self._absolute(at) + self._stiffness(at) * (volume - at)

    def stiffness(self, volume: float) -> float:
        """Loss of pressure with the volume [Pa/m3]."""
        return self._stiffness(max(volume, self.least))

    def by_amount(self, volume: float) -> float:
        """Differentiate the force by the amount [1/m3]."""
        at = max(volume, self.least)
        return -self._absolute(at) / self.amount * volume / at

    def by_air_pressure(self, volume: float) -> float:
        """Differentiate the force by the absolute pressure around [-]."""
        if volume >= self.least:
            return 1.0
        ratio, crushed = volume / self.least, CRUSHED_VOLUME**-self.exponent
        return 1.0 + crushed * (self.exponent + 1) * (ratio - 1)

    def size(self, volume: float) -> float:
        """Size of the works of gas and air around, which nearly cancel, and of the rounding of the volume [J]."""
        work = (self._absolute(max(volume, self.least)) + self.around) * abs(volume - self.reference)
        return work + abs(self.force(volume) * volume)

    def force_size(self, volume: float) -> float:
        """Size of the pressures of gas and air around, which nearly cancel, and of their change by the volume [Pa]."""
        return self._absolute(max(volume, self.least)) + self.around + self.stiffness(volume) * abs(volume)

    def _absolute(self, volume: float) -> float:
        if volume <= 0:
            return 0.0
        return self.amount / volume * (self.reference / volume) ** (self.exponent - 1)

    def _stiffness(self, volume: float) -> float:
        return self.exponent * self._absolute(volume) / volume if volume > 0 else 0.0
