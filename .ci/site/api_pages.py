"""API: the public names, a page for each folder of the package that defines them."""

import pkgutil
from collections import defaultdict

import fx_membrane
from fx_membrane import forms, plot

TITLES = {
    "model": "Structure: materials, parts, supports, loads, stages",
    "geometry": "Geometry: grids and edges",
    "form_finding": "Form finding",
    "surfaces": "Surfaces: meshes, lines, run-off",
    "analysis": "Analysis, paths and modes",
    "patterns": "Cutting patterns",
    "solvers": "Solvers",
    "results": "Results",
    "files": "Files",
    "assembly": "Problem: residual, tangent and mass matrix",
    "plot": "Pictures",
    "forms": "Forms in UFL",
}


def names_by_folder():
    """Public names by the folder of their module."""
    found = defaultdict(list)
    for name in sorted(fx_membrane.__all__):
        value = getattr(fx_membrane, name)
        module = getattr(value, "__module__", None)
        if module is not None:
            found[module.split(".")[1]].append(name)
    found["plot"] = [f"plot.{name}" for name in sorted(plot.__all__) if callable(getattr(plot, name))]
    found["forms"] = [f"forms.{module.name}" for module in pkgutil.iter_modules(forms.__path__)]
    return found


def directive(entry):
    """Documentation of a class, a function or a whole module, by autodoc."""
    value = pkgutil.resolve_name(f"fx_membrane.{entry}")
    kind = (
        "automodule" if isinstance(value, type(pkgutil)) else "autoclass" if isinstance(value, type) else "autofunction"
    )
    heading = f"## {entry}\n\n" if kind == "automodule" else ""
    return f"{heading}```{{eval-rst}}\n.. {kind}:: fx_membrane.{entry}\n```\n"


def write(folder):
    """Write a page for each folder, and the list of them; a folder without a title raises a KeyError."""
    folder.mkdir(parents=True, exist_ok=True)
    found = names_by_folder()
    pages = [name for name in TITLES if found[name]]
    for name in [*pages, *found.keys() - TITLES.keys()]:
        blocks = "\n".join(directive(entry) for entry in found[name])
        (folder / f"{name}.md").write_text(f"# {TITLES[name]}\n\n{blocks}")
    entries = "\n".join(pages)
    (folder / "index.md").write_text(f"# API\n\n```{{toctree}}\n:maxdepth: 1\n\n{entries}\n```\n")
