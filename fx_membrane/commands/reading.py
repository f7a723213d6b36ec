"""Commands on saved results, mesh files and versions."""

from __future__ import annotations

from pathlib import Path

import click

from .group import FILE, say

RESULTS = click.Path(path_type=Path)  # a folder, or the archive in it


@click.command()
@click.argument("source", type=FILE)
@click.argument("target", type=FILE)
@click.option("--unit", help="Unit of length of the target, as m or mm; for a source that names its own, as DXF.")
def convert(source: Path, target: Path, unit: str | None) -> None:
    """Convert a mesh file: from dxf, obj, stl, ply, json or msh to msh, obj or dxf, group by group."""
    from ..files.conversion import convert as converted  # noqa: PLC0415

    converted(source, target, unit)
    say(f"Wrote {target}")


@click.command()
@click.argument("results", type=RESULTS)
@click.option("--html", type=FILE, help="Write an interactive scene, one page for browsers, in the place of text.")
def show(results: Path, html: Path | None) -> None:
    """Print checks and extremes of saved results, a form, or a cutting pattern: the folder, or an archive in it."""
    from ..files.form_words import form_at, form_text  # noqa: PLC0415
    from ..files.patterns.saved_patterns import pattern_at, pattern_text, scene_of  # noqa: PLC0415
    from ..files.run_results import results_of  # noqa: PLC0415
    from ..files.scene.write import write_scene  # noqa: PLC0415
    from ..results.states import StageResults  # noqa: PLC0415
    from ..results.table_of_run import states_and_checks  # noqa: PLC0415

    if pattern := pattern_at(results):
        if html:
            write_scene(scene_of(pattern), html)
        say(f"Wrote {html}" if html else pattern_text(pattern))
        return
    found = form_at(results) or results_of(results)
    if html:
        write_scene(found, html)
        say(f"Wrote {html}")
        return
    say(states_and_checks(found) if isinstance(found, StageResults) else form_text(found))


@click.command()
@click.argument("results", type=RESULTS)
@click.argument("target", type=FILE)
@click.option("--title", help="Title of the report; that of the case if not given.")
@click.option("--scene", type=FILE, help="Write an interactive scene, too, and link the report to it.")
def report(results: Path, target: Path, title: str | None, scene: Path | None) -> None:
    """Write a report of saved results, the folder of a run or its results.fxm, or of a proof.fxm, as .html or .pdf."""
    from ..files.patterns.proof_files import pattern_folder  # noqa: PLC0415
    from ..files.patterns.saved_patterns import assembly, proof_at  # noqa: PLC0415
    from ..files.report.write import write_report  # noqa: PLC0415
    from ..files.run_results import results_of  # noqa: PLC0415
    from ..files.scene.write import write_scene  # noqa: PLC0415

    proof = proof_at(results)
    found = assembly(proof) if proof else results_of(results)
    if scene:
        write_scene(found, scene, title=title)
    write_report(found, target, title=title, scene=scene, patterns=proof or pattern_folder(results))
    say(f"Wrote {target}")


@click.command()
@click.argument("archive", type=FILE, required=False)
def info(archive: Path | None) -> None:
    """Print the versions of everything that computes, for a report of a problem; of an archive, those that wrote it."""
    if archive:
        _tell_origin(archive)
        return
    from ..runtime.package_versions import versions  # noqa: PLC0415

    for name, version in versions().items():
        say(f"{name:14} {version}")


def _tell_origin(archive: Path) -> None:
    from ..files.archive import origin_of  # noqa: PLC0415

    found = origin_of(archive)
    if not found:
        raise ValueError(f"{archive} is no archive of results; give a file of `save_results`, as results.fxm.")
    for name, words in found.items():
        say(f"{name:14} {words}")
