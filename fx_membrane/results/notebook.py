"""Results as HTML, which notebooks show."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

from ..runtime.notebook_pictures import picture_html, table
from .plain_numbers import plain
from .plain_summary import summary
from .state_checks import checks
from .states import StageResult

COLOURS = {"PASS": "#1c7c4a", "WARN": "#a35c00", "FAIL": "#b3261e"}


def state_html(result: StageResult) -> str:
    """Show a state: its checks, the extremes of each part, and a picture."""
    judged = [
        [f'<b style="color:{COLOURS[check.verdict.value]}">{check.verdict.value}</b>']
        + [escape(text) for text in (check.name, check.found, check.limit, check.advice)]
        for check in checks(result)
    ]
    return (
        f"<b>Stage {escape(repr(result.name))}</b>"
        + table(["", "check", "found", "limit", "remedy"], judged)
        + table(["part", "quantity", "least", "largest", "in cell"], _extremes(result))
        + picture_html(result)
    )


def states_html(results: Sequence[StageResult], length: str) -> str:
    """Show a list of stages: increments, iterations, largest displacement, remarks; and a picture of the last."""
    rows = [
        [
            escape(result.name),
            str(len(result.increments)),
            str(sum(entry.total_iterations for entry in result.increments)),
            plain(result.largest_displacement),
            "<br>".join(escape(remark) for remark in result.remarks),
        ]
        for result in results
    ]
    heads = ["stage", "increments", "iterations", f"largest displacement [{escape(length)}]", "remarks"]
    return table(heads, rows) + (picture_html(results[-1]) if results else "")


def _extremes(result: StageResult) -> Iterator[list[str]]:
    parts: dict[str, dict[str, Any]] = summary(result)["parts"]
    for name, part in parts.items():
        for quantity, ends in part.items():
            if isinstance(ends, dict):
                least, largest = ends["least"], ends["largest"]
                yield [escape(name), quantity, plain(least["value"]), plain(largest["value"]), str(largest["cell"])]
