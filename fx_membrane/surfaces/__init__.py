"""Surfaces of found shapes and of sails: meshes, lines on them, and the run-off of water."""
