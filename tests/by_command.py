"""Commands in this process, and files without the pictures that take most of their time."""

from click.testing import CliRunner

from fx_membrane.cli import main
from fx_membrane.files.patterns import write as patterns
from fx_membrane.files.report import write as reports
from fx_membrane.plot import proof_pictures


def said(*arguments):
    """Exit code and text of a command, which ends without a traceback."""
    ended = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert ended.exception is None or isinstance(ended.exception, SystemExit)
    return ended.exit_code, ended.output


def leave_out_pictures(monkeypatch):
    """Write empty pictures into reports, and none of proofs; leave out sheets of patterns."""
    monkeypatch.setattr(reports, "small_picture", lambda _, __, file: file.touch())
    for name in ("draw_pattern", "small_picture"):
        monkeypatch.setattr(proof_pictures, name, lambda *_: None)
    for name in ("write_pdf", "write_svg"):
        monkeypatch.setattr(patterns, name, lambda *_: None)
