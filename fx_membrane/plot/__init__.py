"""Pictures of structures and results."""

from .animations import animation
from .colours import STATES
from .contour_maps import contours, trajectories
from .curves import compare_convergence, convergence
from .wireframes import wireframe

__all__ = ["STATES", "animation", "compare_convergence", "contours", "convergence", "trajectories", "wireframe"]
