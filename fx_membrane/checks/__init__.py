"""Input is checked when it is given: numbers, texts, arrays, names of files."""
