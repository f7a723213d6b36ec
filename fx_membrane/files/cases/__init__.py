"""Case files: structures, form finding, stages and output in TOML."""
