"""Cone cut into gores and laid flat: a developable surface unrolls without energy.

Reference: closed form. A frustum of radius 7 to 2 and height 5 unrolls to a ring of radius 7 sqrt(2) to 2 sqrt(2)
and the angle 2 pi / sqrt(2), of which a gore of 12 has 21.2132034356 degrees. Discrete: a pyramid of n facets unrolls
exactly to n triangles of apex angle 2 asin(sqrt(2) / 2 sin(pi / n)).
Claim: no energy, and all lengths exact, also with cells of unequal size, for isotropic and woven fabric; the angle goes
to that of the cone at second order in the number of facets.
Tolerance: rounding.
"""

import numpy as np
import pytest

from fx_membrane import Fabric, OrthotropicFabric
from fx_membrane.patterns.flat_shapes import flattened_strips
from gores import cone

SOURCE = "closed form, unrolled pyramid"
OUTER, INNER, GORES = 7 * np.sqrt(2), 2 * np.sqrt(2), 12
FULL = np.degrees(2 * np.pi / np.sqrt(2)) / GORES


def unrolled(across, along, law):
    """Energy over stiffness and area, and by gore: lengths of seams, chords at base and top, area, angle in degrees."""
    strips = cone(GORES, across, along, law=law)
    flat = flattened_strips(strips)
    found = []
    for strip in flat.pieces.flat_strips(strips, flat.places).values():
        sides = {side.edge.split()[0]: strip.points[side.rows[[0, -1]]] for side in strip.sides}
        seams = [np.ptp(strip.points[side.rows], axis=0) for side in strip.sides if "seam" in side.edge]
        chords = [np.linalg.norm(np.subtract(*sides[name])) for name in ("bottom", "top")]
        angle = 2 * np.degrees(np.arcsin((chords[0] - chords[1]) / 2 / np.linalg.norm(seams[0])))
        found.append([*np.linalg.norm(seams, axis=1), *chords, strip.area, angle])
    area = sum(row[4] for row in found)
    return flat.energy / area / law.stiffness, np.array(found)


@pytest.mark.parametrize("law", [Fabric(5e5, 0.3), OrthotropicFabric(6e5, 4e5, 0.3, 2e4)], ids=["Fabric", "woven"])
@pytest.mark.parametrize(("across", "along"), [(2, 3), (4, 8)])
def test_pyramid_unrolls_exactly(across, along, law, verified):
    energy, found = unrolled(across, along, law)
    facet = 2 * np.arcsin(np.sqrt(0.5) * np.sin(np.pi / across / GORES))
    chords = [2 * radius * np.sin(across * facet / 2) for radius in (OUTER, INNER)]
    area = across * np.sin(facet) * (OUTER**2 - INNER**2) / 2
    exact = np.array([OUTER - INNER, OUTER - INNER, *chords, area, np.degrees(across * facet)])
    np.testing.assert_allclose(found, np.tile(exact, (GORES, 1)), rtol=1e-11)
    assert energy < 1e-22
    verified("length of a seam [m]", OUTER - INNER, found[0, 0])
    verified("area of a gore [m2]", area, found[0, 4])
    verified("chord at the base [m]", chords[0], found[0, 2])


def test_angle_goes_to_that_of_the_cone(verified):
    angles = np.array([unrolled(across, 2, Fabric(5e5, 0.3))[1][0, 5] for across in (4, 8)])
    extrapolated = angles[1] + (angles[1] - angles[0]) / 3
    order = np.log2((angles[0] - FULL) / (angles[1] - FULL))
    assert order == pytest.approx(2, abs=0.01)
    assert pytest.approx(21.2132034356, abs=1e-10) == FULL
    assert extrapolated == pytest.approx(FULL, rel=1e-7)
