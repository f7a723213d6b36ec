"""Pictures of structures and results."""

from .colours import STATES
from .pictures import compare_convergence, contours, convergence, wireframe

__all__ = ["STATES", "compare_convergence", "contours", "convergence", "wireframe"]
