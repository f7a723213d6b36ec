"""Shapes in equilibrium, by force densities and by prescribed stress."""
