"""Workflow of continuous integration: each job that runs the suite has the browser of its tests."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
WORKFLOW = ROOT / ".github" / "workflows" / "test.yml"


def jobs():
    """Commands by job, in order."""
    text = WORKFLOW.read_text().split("\njobs:\n")[1]
    names, bodies = re.findall(r"(?m)^  (\w+):", text), re.split(r"(?m)^  \w+:", text)[1:]
    return {name: re.findall(r"- run: (.*)", body) for name, body in zip(names, bodies, strict=True)}


@pytest.mark.skipif(not WORKFLOW.exists(), reason="the sources are not a clone")
def test_jobs_with_the_suite_install_its_browser_first():
    suites = re.compile(r"\.ci/suite|make test\b")
    found = {name: commands for name, commands in jobs().items() if any(map(suites.search, commands))}
    assert {"setup", "debian", "wheel"} <= found.keys()
    for name, commands in found.items():
        first = next(row for row, command in enumerate(commands) if suites.search(command))
        assert ".ci/browser" in commands[:first], name


@pytest.mark.skipif(not WORKFLOW.exists(), reason="the sources are not a clone")
def test_jobs_of_debian_install_the_optional_packages():
    installed = " ".join(jobs()["debian"])
    for name in ("debian-packages", "debian-optional"):
        assert f"<.ci/{name}" in installed
        assert (ROOT / ".ci" / name).read_text().split()
