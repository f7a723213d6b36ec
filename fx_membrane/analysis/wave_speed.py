"""Warning of masses in a wrong unit, by the wave speed in fabric and bars."""

from __future__ import annotations

import warnings

import numpy as np

from ..assembly.forms_of_parts import stiffness
from ..model.structure import Structure

# Speeds in real materials [m/s]: sqrt(Et / mass) is 300 to 2000 in coated fabrics and foils, sqrt(EA / mass) 1500 in
# polyester ropes, 5000 in steel, 12 000 in carbon. The margin covers sheaths, fittings and entrained air.
FABRIC = (60.0, 6e3)
BAR = (400.0, 15e3)
# Possible length units [m], each with the least and the largest size of a structure in that unit.
LENGTHS = [(1.0, 0.0, 1e3), (0.3048, 0.0, 1e3), (0.0254, 20.0, 1e3), (0.001, 20.0, np.inf)]


class MassUnitWarning(UserWarning):
    """Mass with a slower or faster wave speed than in any fabric, cable or mast: its unit is probably another.

    The mass unit is not free: it is the force unit times s2 over the length unit. The length unit is guessed from the
    size of the structure: below 20 m or ft, up to 1000 also in or mm, above mm.
    """


def warn_of_mass_units(structure: Structure, stacklevel: int) -> None:
    """Warn once, of the first part with a wave speed that fits no length unit."""
    size = structure.size
    units = [metres for metres, least, largest in LENGTHS if least <= size < largest]
    for name, part in structure.parts.items():
        if not part.mass:
            continue
        speed = float(np.sqrt(stiffness(part) / part.mass))
        slowest, fastest = FABRIC if name in structure.membranes else BAR
        if part.is_strut:
            fastest = np.inf  # it may stand for a rigid body
        if any(slowest <= metres * speed <= fastest for metres in units):
            continue
        fate = "slow" if speed * max(units) < slowest else "fast"
        warnings.warn(
            f"Part {name!r}, with the mass {part.mass:g}, is too {'heavy' if fate == 'slow' else 'light'} for its "
            f"stiffness: waves run through it at {speed:.3g} length units per second, too {fate} for any fabric "
            f"({FABRIC[0]:g} to {FABRIC[1]:g} m/s), cable or mast ({BAR[0]:g} to {BAR[1]:g} m/s). Units are probably "
            "mixed, and frequencies wrong: the mass unit is the force unit times s2 over the length unit. It is kg "
            "with N and m, t (1000 kg) with kN and m, t with N and mm.",
            MassUnitWarning,
            stacklevel=stacklevel,
        )
        return
