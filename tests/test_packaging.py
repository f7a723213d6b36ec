"""Installed packages: a wheel and an sdist with the forms in them, which run from anywhere."""

import importlib.util
import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import numpy as np
import pytest

import fx_membrane

pytestmark = pytest.mark.skipif(not importlib.util.find_spec("pip"), reason="needs pip to build and install")
ROOT = Path(__file__).parent.parent
PAGES = {".html", ".css", ".js"}
FORMS = {path.name for path in (ROOT / "forms").glob("*.py")}


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def sources(tmp_path_factory):
    """Copy the sources, so that nothing is left behind in the working tree."""
    copy = tmp_path_factory.mktemp("sources")
    names = ["pyproject.toml", "README.md", "LICENSE", "forms", "fx_membrane"]
    run("tar", "cf", str(copy / "all.tar"), "--exclude=__pycache__", "-C", str(ROOT), *names)
    run("tar", "xf", "all.tar", cwd=copy)
    return copy


@pytest.fixture(scope="module")
def wheel(sources):
    run(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", "dist", ".", cwd=sources)
    return next((sources / "dist").glob("*.whl"))


def test_names_of_the_package_are_its_own():
    """No module of Python's own among them."""
    public = {name for name in dir(fx_membrane) if not name.startswith("_")}
    submodules = {name for name in public if f"fx_membrane.{name}" in sys.modules}
    assert public - submodules <= set(fx_membrane.__all__)


def test_every_folder_of_modules_is_packed():
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"]
    folders = {path.parent.relative_to(ROOT) for path in (ROOT / "fx_membrane").rglob("*.py")}
    assert {str(folder).replace("/", ".") for folder in folders} | {"fx_membrane.forms"} == set(listed)


@pytest.mark.skipif(Path(sys.prefix) != ROOT / ".venv", reason="for the environment that .ci/setup makes")
def test_pip_keeps_the_numpy_that_dolfinx_is_built_for(tmp_path):
    """Neither `pip install pandas` nor a request for the next numpy brings another major version into .venv."""
    later = f"{int(np.__version__.split('.')[0]) + 1}.0"
    for package in (f"numpy-{later}", "wanting-1.0"):
        name, version = package.split("-")
        needs = f"Requires-Dist: numpy>={later}\n" if name == "wanting" else ""
        with zipfile.ZipFile(tmp_path / f"{package}-py3-none-any.whl", "w") as archive:
            folder = f"{package}.dist-info"
            archive.writestr(f"{folder}/METADATA", f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n{needs}")
            archive.writestr(f"{folder}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
            archive.writestr(f"{folder}/RECORD", "")
    pip = [sys.executable, "-m", "pip", "install", "--dry-run", "--no-index", "--find-links", str(tmp_path)]
    for wanted in (f"numpy=={later}", "wanting"):
        refused = subprocess.run([*pip, wanted], capture_output=True, text=True, check=False)
        assert refused.returncode != 0
        assert "constraint" in refused.stdout + refused.stderr
    run(*pip, wanted, env={**os.environ, "PIP_CONSTRAINT": os.devnull})  # the constraint is the reason for the refusal


def test_wheel_has_the_forms_as_files(wheel):
    with zipfile.ZipFile(wheel) as archive:
        inside = {Path(name).name for name in archive.namelist() if name.startswith("fx_membrane/forms/")}
        assert inside == FORMS
        assert b"def green_lagrange" in archive.read("fx_membrane/forms/kinematics.py")


def test_wheel_has_the_pages(wheel):
    """Templates, styles and scripts of reports and scenes."""
    pages = {str(path.relative_to(ROOT)) for path in (ROOT / "fx_membrane").rglob("*.*") if path.suffix in PAGES}
    with zipfile.ZipFile(wheel) as archive:
        assert {name for name in archive.namelist() if Path(name).suffix in PAGES} == pages
        assert len(pages) > 8


def test_sdist_has_the_forms_as_files(sources):
    script = "import setuptools.build_meta as b, sys; sys.stdout = sys.stderr; b.build_sdist('dist')"
    run(sys.executable, "-c", script, cwd=sources)
    with tarfile.open(next((sources / "dist").glob("*.tar.gz"))) as archive:
        members = [member for member in archive.getmembers() if "/fx_membrane/forms/" in member.name]
        assert {Path(member.name).name for member in members} == FORMS
        assert all(member.isfile() for member in members)
        assert any(member.name.endswith("/files/scene/page/traces.js") for member in archive.getmembers())


def test_installed_wheel_runs_the_demo_from_another_folder(wheel, tmp_path):
    venv.create(tmp_path / "env", system_site_packages=True)
    python = str(tmp_path / "env/bin/python")
    run(sys.executable, "-m", "pip", "-q", "--python", python, "install", "--no-deps", "--no-index", str(wheel))
    site = Path(run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip())
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib"))  # packages of the tests themselves
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    libraries = [f"{sys.prefix}/lib", os.environ.get("LD_LIBRARY_PATH", "")]  # the first is that of the MPI wheel
    environment["LD_LIBRARY_PATH"] = ":".join(filter(None, libraries))
    where = run(python, "-c", "import fx_membrane; print(fx_membrane.__file__)", cwd=elsewhere, env=environment)
    assert Path(where.strip()).is_relative_to(site)
    demo = str(ROOT / "demos/square_membrane.py")
    assert "Check passed" in run(python, demo, "--no-pictures", cwd=elsewhere, env=environment)
    command = str(tmp_path / "env/bin/fx-membrane")
    assert "square_membrane" in run(command, "demo", cwd=elsewhere, env=environment)  # with the files of the package


def test_types_are_seen_through_an_editable_install(sources, tmp_path):
    """As .ci/setup installs it; an install by import hook hides all types from mypy."""
    pytest.importorskip("mypy")
    options = re.search(r"pip install (.*) --editable", (ROOT / ".ci/setup").read_text())[1].split()
    venv.create(tmp_path / "env", system_site_packages=True)
    python = str(tmp_path / "env/bin/python")
    site = Path(run(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip())
    (site / "dependencies.pth").write_text(sysconfig.get_path("purelib"))  # setuptools, and packages with types
    offline = ["--no-deps", "--no-index", "--no-build-isolation"]
    run(sys.executable, "-m", "pip", "--python", python, "install", *options, *offline, "--editable", str(sources))
    script = tmp_path / "script.py"
    script.write_text("from fx_membrane import Fabric\nreveal_type(Fabric(1e5, 0.3).Et)\nFabric('soft', 0.3)\n")
    # `make lint` reads the other modules, and numpy, which take half a minute.
    (tmp_path / "mypy.ini").write_text(
        "[mypy]\nfollow_imports = skip\n[mypy-fx_membrane,fx_membrane.model.fabrics]\nfollow_imports = normal\n"
    )
    command = [sys.executable, "-m", "mypy", "--python-executable", python, "--cache-dir", os.devnull, str(script)]
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MYPYPATH")}
    found = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path, env=environment).stdout
    assert 'Revealed type is "float"' in found
    assert 'Argument 1 to "Fabric" has incompatible type "str"' in found


def test_citation_is_of_this_version():
    citation = dict(re.findall(r"^([\w-]+): (.*)$", (ROOT / ".github" / "CITATION.cff").read_text(), re.MULTILINE))
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert citation["cff-version"] == "1.2.0"
    assert citation["version"] == project["version"]
    assert citation["license"] == project["license"]["text"]
    assert citation["title"].strip('"').startswith("fx_membrane: ")
