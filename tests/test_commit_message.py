"""Commit messages in a clone: an imperative of at most 60 characters, and why; switched on by `.ci/install-hooks`."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

CI = Path(__file__).parent.parent / ".ci"
WHY = "\n\nThe reason."

pytestmark = pytest.mark.skipif(not (CI.exists() and shutil.which("git")), reason="needs git and the folder .ci")


def git(folder, *arguments):
    """Run git without the user's settings."""
    mine = {key: value for key, value in os.environ.items() if not key.startswith("GIT_")}
    who = {f"GIT_{role}_{what}": "tester@example.org" for role in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    environment = mine | who | {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_SYSTEM": os.devnull}
    return subprocess.run(["git", *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)


def copy(folder):
    """Copy what `make setup` uses for the hooks into a folder."""
    (folder / ".ci").mkdir(parents=True)
    shutil.copytree(CI / "hooks", folder / ".ci" / "hooks")
    shutil.copy2(CI / "install-hooks", folder / ".ci")
    return folder


def install(folder):
    subprocess.run([folder / ".ci" / "install-hooks"], check=True, timeout=60)
    return folder


def configured(folder):
    return git(folder, "config", "--local", "core.hooksPath").stdout.strip()


@pytest.fixture(scope="module")
def clone(tmp_path_factory):
    folder = copy(tmp_path_factory.mktemp("a clone"))
    git(folder, "init", "-q", "-b", "main")
    return install(folder)


def commit(folder, message):
    return git(folder, "commit", "-q", "--allow-empty", "-m", message)


@pytest.mark.parametrize(
    "message",
    [
        "Add a law" + WHY,
        "Process needs of cables" + WHY,
        "Feed the line search" + WHY,
        "Bring back the prestress" + WHY,
        "Nämn längden på kabeln" + "ö" * 38 + WHY,
        'Revert "Add a law"\n\nThis reverts a commit.',
        "fixup! Add a law",
    ],
)
def test_good_message_passes(clone, message):
    done = commit(clone, message)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("message", "fact"),
    [
        ("Added a law" + WHY, "'Added'"),
        ("Fixes the law" + WHY, "'Fixes'"),
        ("Adding a law" + WHY, "'Adding'"),
        ("add a law" + WHY, "'add'"),
        ("README: say how" + WHY, "'README:'"),
        ("The law is found" + WHY, "'The'"),
        ("Add a law." + WHY, "full stop"),
        ("Add " + "x" * 57 + WHY, "61 characters"),
        ("Add a law\nThe reason.", "second line"),
        ("Add a law", "no body"),
    ],
)
def test_bad_message_is_refused_with_its_fault(clone, message, fact):
    done = commit(clone, message)
    assert done.returncode != 0
    assert fact in done.stderr
    assert len(done.stderr.strip().splitlines()) == 1 + (fact == "second line")


def test_comments_of_the_editor_are_no_body(clone):
    (clone / "message").write_text("Add a law\n\n# Please enter the commit message for your changes.\n")
    assert "no body" in git(clone, "commit", "--allow-empty", "-q", "--cleanup=strip", "-F", "message").stderr


def test_merges_pass(clone):
    assert commit(clone, "Add a law" + WHY).returncode == 0
    git(clone, "checkout", "-q", "-b", "side")
    assert commit(clone, "Add a load" + WHY).returncode == 0
    git(clone, "checkout", "-q", "main")
    merged = git(clone, "merge", "-q", "--no-ff", "--no-edit", "side")
    assert merged.returncode == 0, merged.stderr


def test_folder_without_git_is_left_alone(tmp_path):
    folder = install(copy(tmp_path / "from an archive"))
    assert [entry.name for entry in folder.iterdir()] == [".ci"]


def test_clone_of_another_project_around_it_is_left_alone(tmp_path):
    git(tmp_path, "init", "-q")
    install(copy(tmp_path / "vendored"))
    assert configured(tmp_path) == ""


def test_own_hooks_are_left_alone(tmp_path):
    folder = copy(tmp_path / "clone")
    git(folder, "init", "-q")
    git(folder, "config", "core.hooksPath", "my hooks")
    assert configured(install(folder)) == "my hooks"
