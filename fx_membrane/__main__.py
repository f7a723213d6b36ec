"""The command `fx-membrane` as `python -m fx_membrane`."""

from .cli import main

main()
