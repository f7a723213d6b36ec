"""Grids, edges and measures of meshes, independent of structures."""
