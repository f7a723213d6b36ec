"""Demo cases: case files of the package, with their meshes."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path
from typing import Any

from .whole_file import writing

SCRIPTS = {  # demos of the sources without a case file of their own, each with the reason
    "dolfinx_in_and_out": "its mesh and results are objects of dolfinx",
    "forms_alone": "it uses the forms in a plain dolfinx script",
    "own_energy": "an energy term of one's own is a class in Python",
    "own_law": "a law of one's own is a class in Python",
    "own_solver": "a solver of one's own is a class in Python",
    "patterns": "the case file of the demo cone has its cutting pattern",
    "solvers": "it compares solvers, and a case file has one; its models are in square_membrane and shade_pavilion",
}


def demos() -> dict[str, str]:
    """Titles of the demo cases by name."""
    files = sorted(entry.name for entry in _folder().iterdir() if entry.name.endswith(".toml"))
    return {name.removesuffix(".toml"): _title(name) for name in files}


def demo_files(name: str, folder: Path) -> list[Path]:
    """Files of a demo case in a folder, the case first, then the mesh that it reads.

    Raises:
        ValueError: There is no demo of that name.
    """
    return [folder / entry.name for entry in _sources(name)]


def write_demo(name: str, folder: Path) -> None:
    """Write the files of a demo case in a folder.

    Raises:
        ValueError: There is no demo of that name; a file exists, or cannot be written.
    """
    targets = demo_files(name, folder)
    for target in targets:
        if target.exists():
            raise ValueError(f"{target} exists; remove it, or go to another folder.")
    for entry, target in zip(_sources(name), targets, strict=True):
        with writing(target, "wb") as stream:
            stream.write(entry.read_bytes())


def _sources(name: str) -> list[Any]:
    if name not in demos():
        known = ", ".join(demos())
        words = f"{name!r} is a script ({SCRIPTS[name]})" if name in SCRIPTS else f"there is no demo {name!r}"
        raise ValueError(f"{words[0].upper()}{words[1:]}; as case files there are {known}.")
    return sorted((entry for entry in _folder().iterdir() if entry.name.startswith(f"{name}.")), key=_case_first)


def _folder() -> resources.abc.Traversable:
    return resources.files(__package__) / "demos"


def _title(name: str) -> str:
    title: str = tomllib.loads((_folder() / name).read_text(encoding="utf-8"))["title"]
    return title


def _case_first(entry: resources.abc.Traversable) -> bool:
    return not entry.name.endswith(".toml")
