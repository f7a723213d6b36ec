"""Site in output/site: README, how-tos, demos as a gallery, table of verification, case-file reference, API.

    build.py [--records REPORT.xml ...] [--without-demos]

The pages are made in output/site-source. Their code is run while they are built; what it printed is kept beside them.
Records are reports of `pytest --junitxml tests/verification`, one for each platform; without them the tests run here.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import api_pages  # in the folder of this script, which Python puts on its path
import case_file_page
import gallery_pages

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
SOURCE, SITE = ROOT / "output" / "site-source", ROOT / "output" / "site"


def readme():
    """README, with its pictures, and without links to files that the site does not have."""
    text = (ROOT / "README.md").read_text()
    for name in re.findall(r"!\[[^]]*\]\((demos/[^)]+)\)", text):
        (SOURCE / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, SOURCE / name)
    return re.sub(r"(?<!!)\[([^]]+)\]\((?:tests|demos|forms|fx_membrane)/[^)]+\)", r"\1", text)


def verification(reports):
    """Table of verification, of reports or of a run."""
    command = [sys.executable, "tests/benchmarks/verification.py", *(["--reports", *reports] if reports else [])]
    table = subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
    return f"""# Verification

Every file of `tests/verification`: a value beside its exact one, and the order in which the error falls as the mesh is
refined. Errors are relative to the exact value, or absolute where that is zero. `tests/benchmarks/verification.py` made
this table of the tests themselves.

{table}"""


def main():
    """Write the pages and build the site; a warning of Sphinx is an error."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--records", nargs="+", default=[], help="reports of pytest --junitxml tests/verification")
    parser.add_argument("--without-demos", action="store_true", help="show the demos without running them")
    options = parser.parse_args()
    for name in ("how-to", "gallery", "api"):
        shutil.rmtree(SOURCE / name, ignore_errors=True)
    shutil.copytree(
        HERE, SOURCE, dirs_exist_ok=True, ignore=shutil.ignore_patterns("__pycache__", "*_page*.py", "build.py")
    )
    (SOURCE / "readme.md").write_text(readme())
    (SOURCE / "verification.md").write_text(verification([str(Path(name).resolve()) for name in options.records]))
    (SOURCE / "case-file.md").write_text(case_file_page.page())
    gallery_pages.write(ROOT / "demos", SOURCE / "gallery", run=not options.without_demos)
    api_pages.write(SOURCE / "api")
    print("Building the site", flush=True)
    cache = str(SITE.parent / "site-cache")
    sphinx = [
        sys.executable,
        "-m",
        "sphinx",
        "-q",
        "-W",
        "--keep-going",
        "-b",
        "html",
        "-d",
        cache,
        *([] if (SITE / "searchindex.js").exists() else ["-a"]),  # a build that was stopped lacks some pages
        str(SOURCE),
        str(SITE),
    ]
    path = os.pathsep.join(filter(None, [str(ROOT / "demos"), os.environ.get("PYTHONPATH")]))  # demos import each other
    sys.exit(subprocess.run(sphinx, check=False, env={**os.environ, "PYTHONPATH": path}).returncode)


if __name__ == "__main__":
    main()
