"""Names of compiled code that FFCx looks for on the disk."""

import ffcx.codegeneration.jit
import pytest


@pytest.fixture
def searches(monkeypatch):
    """Names of compiled modules that are looked for on the disk."""
    asked, find = [], ffcx.codegeneration.jit.get_cached_module

    def get_cached_module(name, *args):
        asked.append(name)
        return find(name, *args)

    monkeypatch.setattr(ffcx.codegeneration.jit, "get_cached_module", get_cached_module)
    return asked
