"""Pictures of structures and results."""

from .colours import STATES
from .contour_maps import contours
from .curves import compare_convergence, convergence
from .wireframes import wireframe

__all__ = ["STATES", "compare_convergence", "contours", "convergence", "wireframe"]
