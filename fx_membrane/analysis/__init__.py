"""Stages and load increments, checkpoints, small motions, paths by arc length."""
