"""Balloons: an eighth of a sphere between its planes of symmetry."""

import numpy as np

from fx_membrane import Membrane, Structure, Support
from surfaces import octant


def eighth_of_a_balloon(n, law, prestress=0.0, radius=1.0, **structure):
    """Sphere about the origin, its part "balloon" in the octant of positive coordinates; n cells along an edge."""
    points, cells = octant(n, radius)
    planes = [Support(np.flatnonzero(points[:, i] == 0), "xyz"[i]) for i in range(3)]
    return Structure(points, {"balloon": Membrane(cells, law, prestress)}, planes, **structure)
