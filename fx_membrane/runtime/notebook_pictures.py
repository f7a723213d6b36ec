"""Pictures of objects in notebooks, as HTML and as PNG.

`plot` draws them. It is above all that is drawn, and is loaded only when a notebook asks for a picture.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable
from html import escape
from importlib import import_module


def picture_png(thing: object) -> bytes | None:
    """PNG of a state, a form, a structure or a path; None where nothing can draw."""
    found: bytes | None = _drawn(thing)[0]
    return found


def picture_html(thing: object) -> str:
    """Picture of the same as HTML, or the reason for its lack."""
    png, reason = _drawn(thing)
    if png is None:
        return f"<p><small>{escape(reason)}</small></p>"
    return f'<img style="max-width:100%" alt="picture" src="data:image/png;base64,{base64.b64encode(png).decode()}">'


def table(heads: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Table of HTML; the cells are HTML already."""
    head = "".join(f"<th>{text}</th>" for text in heads)
    body = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _drawn(thing: object) -> tuple[bytes | None, str]:
    try:
        found: tuple[bytes | None, str] = import_module("fx_membrane.plot.inline").drawn(thing)
    except ImportError as error:
        return None, f"No picture: {error}"
    return found
