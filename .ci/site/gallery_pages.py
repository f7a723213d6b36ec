"""Gallery of the demos: each a page of its text, code, output and pictures, run when the site is built."""

import jupytext
import nbformat

SHOW = """\
from pathlib import Path
from IPython.display import Image, display

for picture in sorted(Path("output").rglob("*.png")):
    display(Image(filename=str(picture), width=700))
"""


def page(demo, run):
    """Notebook of a demo; the last cell shows the pictures that it has written."""
    notebook = jupytext.read(demo, fmt="py:percent")
    notebook.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    if run:
        notebook.cells.append(nbformat.v4.new_code_cell(SHOW, metadata={"tags": ["remove-input"]}))
    else:
        notebook.metadata["mystnb"] = {"execution_mode": "off"}
    return notebook


def write(demos, folder, run=True):
    """Write a page for each demo, and the list of them, which `conf.py` gives pictures."""
    folder.mkdir(parents=True, exist_ok=True)
    names = sorted(demo.stem for demo in demos.glob("*.py"))
    for name in names:
        nbformat.write(page(demos / f"{name}.py", run), folder / f"{name}.ipynb")
    for script in sorted((demos / "cookbook").glob("*.py")):
        title = script.stem.replace("_", " ").capitalize()
        (folder / f"cookbook-{script.stem}.md").write_text(f"# {title}, short\n\n```python\n{script.read_text()}```\n")
        names.append(f"cookbook-{script.stem}")
    entries = "\n".join(names)
    (folder / "index.md").write_text(
        f"# Gallery\n\nThe scripts in `demos/`, as they run.\n\n```{{toctree}}\n:hidden:\n\n{entries}\n```\n"
    )
