"""Pictures of structures and results."""

from .pictures import compare_convergence, contours, convergence, wireframe

__all__ = ["compare_convergence", "contours", "convergence", "wireframe"]
