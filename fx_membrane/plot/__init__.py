"""Pictures of structures and results."""

from __future__ import annotations

from .animations import animation
from .colour_scale import STATES
from .contour_maps import contours, trajectories
from .curves import compare_convergence, convergence
from .cutting_patterns import cutting_pattern
from .proof_pictures import pattern_proof
from .wireframes import wireframe

__all__ = [
    "STATES",
    "animation",
    "compare_convergence",
    "contours",
    "convergence",
    "cutting_pattern",
    "pattern_proof",
    "trajectories",
    "wireframe",
]
