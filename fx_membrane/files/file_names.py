"""Names of files made of names of users."""

from __future__ import annotations

import re
import unicodedata


def safe_name(number: int, name: str) -> str:
    """Name of a file for a thing: its number, and of its name letters, digits and hyphens, at most forty."""
    words = re.sub(r"[^0-9A-Za-z]+", "-", unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode())
    return "-".join(filter(None, (f"{number:02d}", words[:40].strip("-").lower())))
