"""Files of cutting patterns: DXF for cutting machines, sheets to print, tables."""
