"""The command `fx-membrane`."""

from __future__ import annotations

import click

from .commands.beginning import demo, init, schema
from .commands.group import Group
from .commands.reading import convert, info, report, show
from .commands.running import check, patterns, run


@click.group("fx-membrane", cls=Group)
@click.version_option(package_name="fx-membrane")
def main() -> None:
    """Nonlinear statics of prestressed tension structures, from case files; the README shows Python scripts.

    Exit codes: 0 done, also with warnings; 1 no equilibrium, no shape, or a limit of the design exceeded; 2 input
    refused, or a file not written; 130 stopped by Ctrl-C, 143 by SIGTERM.
    """


for command in (init, check, run, patterns, show, report, convert, schema, demo, info):
    main.add_command(command)

if __name__ == "__main__":
    main()
