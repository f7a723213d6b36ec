"""Right arguments of form finding, and the kind of each."""

from fx_membrane import (
    Cable,
    CableDensity,
    CableForce,
    CableLength,
    CableSag,
    EdgeAngle,
    GeodesicDirection,
    RadialDirection,
    RigidBody,
    Ring,
    Slide,
    Support,
    force_density,
    masts_and_stays,
    natural_force_density,
    natural_frequencies,
    prescribed_stress,
    projected_stress,
    stability,
    updated_reference,
)
from right_subjects import COMM, FORM, MODES, POINTS, SHEET

FORM_FINDING = {
    force_density: (
        {"points": POINTS.tolist(), "branches": [[0, 1], [1, 2]], "q": [1.0, 2.0], "fixed": [Support([0, 2])],
         "loads": None, "constraints": (), "tolerance": 0.1, "max_iterations": 2},
        {"points": "array", "branches": "rows", "q": "array", "fixed": "object", "loads": "array?",
         "constraints": "list", "tolerance": "number", "max_iterations": "whole"},
    ),
    masts_and_stays: (
        {"form": FORM, "bars": {"stay": Cable([[0, 4]], 1e6)}, "points": [[-2.0, 0.0, 0.0]], "heads": [0],
         "components": "x"},
        {"form": "object", "bars": "object", "points": "array", "heads": "rows?", "components": "object"},
    ),
    CableForce: (
        {"part": "edge", "force": 1.0, "cells": [0, 1], "horizontal": True},
        {"part": "text", "force": "number", "cells": "rows?", "horizontal": "truth"},
    ),
    CableDensity: ({"part": "edge", "density": 1.0, "cells": [0, 1]},
                   {"part": "text", "density": "number", "cells": "rows?"}),
    CableLength: ({"part": "edge", "length": 1.0, "cells": [0, 1]},
                  {"part": "text", "length": "number", "cells": "rows?"}),
    CableSag: (
        {"part": "edge", "sag": 1.0, "cells": [0, 1], "along": [0.0, 0, 1]},
        {"part": "text", "sag": "number", "cells": "rows?", "along": "array?"},
    ),
    EdgeAngle: ({"part": "edge", "angle": 30.0, "cells": [0, 1]},
                {"part": "text", "angle": "number", "cells": "rows?"}),
    Slide: ({"nodes": [0, 1], "direction": [0.0, 0, 1], "normal": None},
            {"nodes": "rows", "direction": "array?", "normal": "array?"}),
    Ring: ({"nodes": [0, 1, 2], "radius": 1.0}, {"nodes": "rows", "radius": "number?"}),
    RigidBody: ({"nodes": [0, 1]}, {"nodes": "rows"}),
    natural_force_density: (
        {"structure": SHEET, "loads": (), "iterations": 2, "tolerance": 0.1, "constraints": ()},
        {"structure": "object", "loads": "list", "iterations": "whole", "tolerance": "number", "constraints": "list"},
    ),
    RadialDirection: ({"origin": [0.0, 0.0, 0.0], "axis": [0.0, 0.0, 1.0]}, {"origin": "array", "axis": "array"}),
    GeodesicDirection: ({"ends": [[0, 1], [2, 3]]}, {"ends": "rows"}),
    prescribed_stress: (
        {"structure": SHEET, "loads": (), "stress": {}, "warp": {}, "tolerance": 0.1, "max_iterations": 2,
         "constraints": ()},
        {"structure": "object", "loads": "list", "stress": "table?", "warp": "table?", "tolerance": "number",
         "max_iterations": "whole", "constraints": "list"},
    ),
    projected_stress: (
        {"structure": SHEET, "loads": (), "stress": {}, "cables": "force", "direction": [0.0, 0.0, 1.0],
         "tolerance": 0.1, "max_iterations": 2, "constraints": ()},
        {"structure": "object", "loads": "list", "stress": "table?", "cables": "object", "direction": "array",
         "tolerance": "number", "max_iterations": "whole", "constraints": "list"},
    ),
    updated_reference: (
        {"structure": SHEET, "loads": (), "tolerance": 0.1, "max_iterations": 2, **COMM, "constraints": ()},
        {"structure": "object", "loads": "list", "tolerance": "number", "max_iterations": "whole",
         "comm": "object", "constraints": "list"},
    ),
    natural_frequencies: MODES,
    stability: MODES,
}  # fmt: skip
