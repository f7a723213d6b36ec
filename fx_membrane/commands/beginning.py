"""Commands to begin with: a case, the demos, the schema."""

from __future__ import annotations

import json
from pathlib import Path

import click

from ..runtime.package_versions import reason_of_import
from .group import FILE, once, quoted, say, write
from .running import run

TEMPLATE = """\
#:schema fx-membrane.schema.json
format = 1
title = "Flat sheet under snow"
units = { force = "kN", length = "m" }   # of plain numbers, and of all results

[geometry]           # or kind = "file", file = "roof.dxf": layers become parts
kind = "grid"
width = 4
height = 4
columns = 16
rows = 16

[materials.pvc]
kind = "fabric"
Et = "500 kN/m"
nu = 0.3

[parts.roof]
kind = "membrane"
group = "grid"
material = "pvc"
prestress = "1 kN/m"

[[supports]]
rim_of = "roof"

[[stages]]
name = "snow"
loads = [{ kind = "plan", part = "roof", load = [0, 0, "-0.6 kN/m2"] }]
"""


@click.command()
@click.argument("case", type=FILE, default="case.toml")
def init(case: Path) -> None:
    """Write a small case file to begin with, and its schema for editors beside it."""

    def begin() -> None:
        if case.exists():
            raise ValueError(f"{case} exists; give another name.")
        write(case, TEMPLATE)
        _write_schema(case.parent)

    once(begin)
    say(f"Wrote {case}. Next: {_next(case)}")


@click.command()
@click.argument("name", required=False)
@click.option("--run", "at_once", is_flag=True, help="Run it at once.")
@click.pass_context
def demo(ctx: click.Context, name: str | None, at_once: bool) -> None:
    """List the demo cases, or write one in this folder."""
    from ..files.demo_cases import SCRIPTS, demo_files, demos, write_demo  # noqa: PLC0415

    if name is None:
        width = max(map(len, demos()))
        for entry, title in demos().items():
            say(f"{entry:{width}}  {title}")
        scripts = ", ".join(f"{entry} ({words})" for entry, words in SCRIPTS.items())
        say(f"\nWrite one: fx-membrane demo NAME. As scripts only, in demos/ of the sources: {scripts}.")
        return
    files = demo_files(name, Path())

    def begin() -> None:
        write_demo(name, Path())
        _write_schema(Path())

    once(begin)
    say(f"Wrote {', '.join(map(str, files))}." + ("" if at_once else f" Next: {_next(files[0])}"))
    if at_once:
        ctx.invoke(run, case=files[0], resume=False, overwrite=False, quiet=False, log=None)


def _next(case: Path) -> str:
    return f"fx-membrane check {quoted(case)}; fx-membrane run {quoted(case)}"


@click.command()
def schema() -> None:
    """Print the JSON schema of case files, for editors."""
    say(_schema())


def _schema() -> str:
    from ..files.cases.schema import json_schema  # noqa: PLC0415

    return json.dumps(json_schema(), indent=1)


def _write_schema(folder: Path) -> None:
    try:
        write(folder / "fx-membrane.schema.json", _schema() + "\n")
    except ImportError as error:
        say(f"No schema written. {reason_of_import(error)}", err=True)
