"""Constraints of form finding: cables by their geometry, nodes that slide, rings and rigid bodies."""
