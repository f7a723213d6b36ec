"""Elastic catenary of a given unstressed length.

Reference: H. M. Irvine, Cable Structures, MIT Press (1981), in closed form with the engineering strain: span 100, right
end 10 higher, unstressed length 105, 50 N per m of it, EA 5e6. Claim: forces of the supports and the
lowest point, 59.1165690850 from the upper end, converge to it in second order of the length of the segments.
"""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

from fx_membrane import Analysis, Cable, DistributedLoad, Stage, Structure, Support, UnstressedLength, polyline

SOURCE = "Irvine (1981)"

H, LEFT, RIGHT = 4771.74034842, 2105.07586738, 3144.92413262
LOWEST = 100 - 59.1165690850


@dataclass(frozen=True)
class Engineering:
    """Force proportional to the engineering strain."""

    axial_stiffness: float

    @property
    def stiffness(self):
        return self.axial_stiffness

    def energy(self, E, sigma0, parameters):
        stretch = ufl.sqrt(1 + 2 * E[0, 0])
        return sigma0[0, 0] * E[0, 0] + parameters.axial_stiffness * (stretch - 1) ** 2 / 2


def solved(n):
    """Solve for the forces of the supports, and the lowest point of the parabola through the three lowest nodes."""
    s = np.linspace(0, 1, n + 1)
    points = np.stack([100 * s, 0 * s, 10 * s - 60 * s * (1 - s)], axis=1)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1).sum()
    cable = Cable(polyline(range(n + 1)), material=Engineering(5e6))
    structure = Structure(points, {"cable": cable}, [Support([0, n]), Support(range(n + 1), "y")])
    weight = DistributedLoad((0, 0, -50 * 105 / length), "cable")  # per length of the reference shape
    stage = Stage("weight", [weight], changes=[UnstressedLength(105.0, "cable")])
    state = Analysis(structure, progress=False).run([stage])["weight"]
    x, _, z = state.position[np.argmin(state.position[:, 2]) + np.arange(-1, 2)].T
    square, slope, _ = np.polyfit(x, z, 2)
    return np.array([state.reactions[-1, 0], state.reactions[0, 2], state.reactions[-1, 2], -slope / 2 / square])


@pytest.mark.filterwarnings("ignore")
def test_forces_of_the_supports_and_the_lowest_point_converge(verified):
    found = [solved(n) for n in (40, 80, 160)]
    errors = [np.abs(numbers[:3] - (H, LEFT, RIGHT)).max() for numbers in found]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    verified("horizontal force [N]", H, found[-1][0], orders[-1])
    np.testing.assert_allclose(orders, 2, atol=0.15)
    off = np.abs([numbers[3] - LOWEST for numbers in found])
    verified("lowest point from the lower end [m]", LOWEST, found[-1][3], np.log2(off[-2] / off[-1]))
    np.testing.assert_allclose(np.log2(off[:-1] / off[1:]), 2, atol=0.15)
