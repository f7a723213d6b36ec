"""The command `fx-membrane` as `python -m fx_membrane`."""

from __future__ import annotations

from .cli import main

main()
