"""Right arguments of cutting patterns, and the kind of each."""

from typing import Any

from cone_gores import cone_gores
from fx_membrane import cut_pieces, laid_on_roll, write_patterns
from fx_membrane.patterns.cloth_pieces import Piece

PATTERN = cone_gores(3, along=1, across=1)
STRIP = PATTERN.flat["gore 1"].points[[0, 1, 3, 2]]

PATTERNS: Any = {
    cut_pieces: (
        {"pattern": PATTERN, "allowances": None, "mark_spacing": 1.0},
        {"pattern": "object", "allowances": "object?", "mark_spacing": "number?"},
    ),
    laid_on_roll: (
        {"pieces": {"a": Piece("a", ("a",), frozenset(), STRIP, STRIP, (), (), STRIP[:2], ())}, "width": 20.0,
         "gap": 0.01},
        {"pieces": "object", "width": "number", "gap": "number"},
    ),
    write_patterns: (
        {"pattern": PATTERN, "path": "a.csv", "allowances": None, "roll_width": None, "mark_spacing": 1.0,
         "project": "", "material": "", "date": "", "paper": "A3", "scale": None, "length_unit": "m"},
        {"pattern": "object", "path": "folder", "allowances": "object?", "roll_width": "number?",
         "mark_spacing": "number?", "project": "text", "material": "text", "date": "text", "paper": "object",
         "scale": "whole?", "length_unit": "object?"},
    ),
}  # fmt: skip
