"""Words of the commands: files that are missing, cases that compute nothing, names that would steer a terminal."""

import os
import signal

import pytest

from roof_case import ROOF

pytest.importorskip("pydantic", "2")
pytest.importorskip("pint")

from by_command import said
from fx_membrane.files.cases import case

IDLE = ROOF.split("[[stages]]", maxsplit=1)[0]

PLAIN = """\
format = 1
[geometry]
kind = "file"
file = "a.obj"
[materials.film]
kind = "fabric"
Et = 500e3
nu = 0.3
[parts.sail]
kind = "membrane"
group = "sail"
material = "film"
prestress = 1e3
[[supports]]
nodes = [0, 1, 2]
[[stages]]
name = "prestress"
"""


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["check", "none.toml"],
            "There is no case file 'none.toml' (No such file or directory); fx-membrane init writes one.",
        ),
        (
            ["run", "there/none.toml"],
            "There is no case file 'there/none.toml' (No such file or directory); there is there/roof.toml.",
        ),
        (["check", "there"], "'there' is a folder, and no case file; there is there/roof.toml."),
        (
            ["check", "no/roof.toml"],
            "There is no folder 'no', so no case file 'no/roof.toml' (No such file or directory); correct the name.",
        ),
        (["show", "none"], "There is no folder and no archive 'none'; give the folder of a run."),
        (["show", "there/roof.toml"], "there/roof.toml is a case, not its results; give the folder of its run"),
        (["report", "there", "a.html"], "The folder there has no results.fxm; run a case first"),
    ],
)
def test_missing_files_are_told_with_what_is_there(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "roof.toml").write_text(ROOF, encoding="utf-8")
    code, told = said(*arguments)
    assert code == 2
    assert told.startswith(words)


def test_case_that_computes_nothing_is_told(tmp_path):
    (tmp_path / "a.toml").write_text(IDLE, encoding="utf-8")
    code, told = said("check", tmp_path / "a.toml")
    assert code == 0
    assert "computes nothing" in told
    code, told = said("run", tmp_path / "a.toml")
    assert (code, "computes nothing" in told) == (2, True)
    assert not (tmp_path / "a").exists()


def test_names_cannot_steer_a_terminal(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = ROOF.replace('"edge, left"', '"e\\u001b[31md\\u202ege"').replace('"lift"', '"li\\u001b[2Jft\\nnext"')
    (tmp_path / "a.toml").write_text(text + "paraview = false\n", encoding="utf-8")
    for arguments in (["check", "a.toml"], ["run", "a.toml"], ["show", "out"], ["show", "\x1b[31m"], ["demo", "\x1b"]):
        told = said(*arguments)[1]
        assert "\x1b" not in told
        assert "\u202e" not in told
    (tmp_path / "a.toml").write_text(text.replace("nu = 0.3", 'nu = 3\n"\\u001b[31m" = 1'), encoding="utf-8")
    code, told = said("check", "a.toml")
    assert (code, "\x1b" in told) == (2, False)


def test_commands_that_come_next_can_be_copied(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "fx-membrane run 'my roof.toml'" in said("init", "my roof.toml")[1]


@pytest.mark.parametrize(
    ("folder", "words"), [("a\\u0000b", "zero bytes"), ("a" * 300, "too long"), ("", None), ("a/b/", None)]
)
def test_folder_that_no_system_allows_is_told_by_check(folder, words, tmp_path):
    (tmp_path / "a.toml").write_text(ROOF.replace('folder = "out"', f'folder = "{folder}"'), encoding="utf-8")
    code, told = said("check", tmp_path / "a.toml")
    assert code == (2 if words else 0)
    assert words is None or ("a.toml:77: output.folder: " in told and words in told)


def test_file_without_the_ending_of_a_mesh_file_is_told_by_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.txt").touch()
    code, told = said("convert", "a.txt", "b.obj")
    assert (code, told.split(";")[0]) == (2, "'a.txt' has no ending of a mesh file")


def test_unit_of_a_file_without_one_is_told_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.obj").write_text("v -2 -2 0\nv 2 -2 0\nv 2 2 0\no grid\nf 1 2 3\n")
    code, told = said("convert", "a.obj", "b.obj", "--unit", "m")
    assert (code, told.count("\n")) == (2, 1)
    head, rest = ROOF.split("[geometry]")[0], "[materials" + ROOF.split("[materials", 1)[1]
    text = head + '[geometry]\nkind = "file"\nfile = "a.obj"\n' + rest.replace("nodes = [20, 24]", "nodes = [1]")
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    for command in ("check", "run"):  # the case has the one meant
        assert "unit of length" not in said(command, "a.toml")[1]


def test_lack_of_all_units_is_told_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.obj").write_text("v -2 -2 0\nv 2 -2 0\nv 2 2 0\no sail\nf 1 2 3\n")
    (tmp_path / "a.toml").write_text(PLAIN, encoding="utf-8")
    said("check", "a.toml")
    for command in ("check", "run"):
        code, told = said(command, "a.toml")
        assert code == 0, told
        assert told.count("Neither a.obj nor the case names a unit of length") == 1
    assert "Neither" not in said("run", "a.toml", "--quiet", "--overwrite")[1]


class PanicException(BaseException):
    """Stands for that of compiled Rust, which is no Exception either."""


@pytest.mark.parametrize("kind", [RuntimeError, PanicException])
@pytest.mark.parametrize(
    ("sent", "code", "words"), [(signal.SIGTERM, 143, "Ended by SIGTERM."), (signal.SIGINT, 130, "Stopped.")]
)
def test_signal_that_compiled_code_turns_into_its_own_error_ends_with_words(
    sent, code, words, kind, tmp_path, monkeypatch
):
    def turned(*_):
        try:
            os.kill(os.getpid(), sent)
        except KeyboardInterrupt as stop:
            raise kind("SchemaError") from stop

    signal.signal(signal.SIGINT, signal.default_int_handler)  # background jobs ignore it
    monkeypatch.setattr(case, "parsed", turned)
    (tmp_path / "a.toml").write_text(ROOF, encoding="utf-8")
    assert said("check", tmp_path / "a.toml") == (code, f"{words}\n")
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
