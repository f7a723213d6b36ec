"""Grids and edges, and measures of meshes; structures are not known here."""
