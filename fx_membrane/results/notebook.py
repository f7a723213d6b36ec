"""Results as HTML, which notebooks show."""

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any

from .checks import checks
from .states import StageResult
from .summary import summary

COLOURS = {"PASS": "#1c7c4a", "WARN": "#a35c00", "FAIL": "#b3261e"}


def state_html(result: StageResult) -> str:
    """Show a state: its checks, and the extremes of each part."""
    judged = [
        [f'<b style="color:{COLOURS[check.verdict.value]}">{check.verdict.value}</b>']
        + [escape(text) for text in (check.name, check.found, check.limit, check.advice)]
        for check in checks(result)
    ]
    return (
        f"<b>Stage {escape(repr(result.name))}</b>"
        + _table(["", "check", "found", "limit", "remedy"], judged)
        + _table(["part", "quantity", "least", "largest", "in cell"], _extremes(result))
    )


def states_html(results: Sequence[StageResult]) -> str:
    """Show a list of stages: increments, iterations, largest displacement, remarks."""
    rows = [
        [
            escape(result.name),
            str(len(result.increments)),
            str(sum(len(entry.iterations) - 1 + entry.extra_iterations for entry in result.increments)),
            f"{result.largest_displacement:.5g}",
            "<br>".join(escape(remark) for remark in result.remarks),
        ]
        for result in results
    ]
    return _table(["stage", "increments", "iterations", "largest displacement", "remarks"], rows)


def _extremes(result: StageResult) -> Iterator[list[str]]:
    parts: dict[str, dict[str, Any]] = summary(result)["parts"]
    for name, part in parts.items():
        for quantity, ends in part.items():
            if isinstance(ends, dict):
                least, largest = ends["least"], ends["largest"]
                yield [escape(name), quantity, f"{least['value']:.5g}", f"{largest['value']:.5g}", str(largest["cell"])]


def _table(heads: Sequence[str], rows: Any) -> str:
    head = "".join(f"<th>{text}</th>" for text in heads)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
