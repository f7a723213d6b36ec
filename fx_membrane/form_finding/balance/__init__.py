"""Equilibrium of prescribed stresses: the linear systems that form finding solves."""
