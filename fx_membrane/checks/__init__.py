"""Checks of input on entry: numbers, texts, arrays, names of files."""
