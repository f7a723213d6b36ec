"""Cutting patterns: seams and strips of a found surface, flat cloth, compensation, and the proof that it fits."""
