"""States of a structure: their evaluation, remarks and warnings, tables."""
