"""Words for readers who have files of results, and perhaps no script: sentences without calls of Python."""

from __future__ import annotations

import re

CALLS = (
    (re.compile(r"; (?:`equilibrium_path`|a path) shows the way there"), "; more increments show the way there"),
    (re.compile(r"; `equilibrium_path` shows the limit point"), "; more increments show where"),
    (re.compile(r"; stability\(state\) shows how it gives way"), ""),
    (re.compile(r", as Newton\(rtol=\.\.\.\)"), " (rtol of the solver)"),
    (re.compile(r" \(\w+\((rtol|max_iterations)=\.\.\.\)\)"), r" (\1 of the solver)"),
    (re.compile(r"\b\w+\((rtol|max_iterations)=\.\.\.\)"), r"\1 of the solver"),
    (re.compile(r"\b(Newton|ConjugateGradient|SteepestDescent)\(\)"), r"the solver \1"),
    (re.compile(r" \(force_density, updated_reference\)"), ""),
    (re.compile(r" \(WorkLimit\)"), " (the table work)"),
    (re.compile(r"see in its iterations, `failed`, whether"), "see in the lines of progress whether"),
)


def for_readers(words: str) -> str:
    """Put a sentence on results in words that need no script."""
    for call, by in CALLS:
        words = call.sub(by, words)
    return words
