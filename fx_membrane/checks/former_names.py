"""Former names of the package, told in the place of their absence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

NAMES = {
    "DeadLoad": "DistributedLoad",
    "trace": "equilibrium_path",
    "ContinuationError": "PathError",
    "edges_on": "edges_where",
    "boundary": "boundary_edges",
}


def telling(get: Callable[[str], Any]) -> Callable[[str], Any]:
    """Wrap the look-up of public names, so that it tells the new ones of former ones."""

    def look_up(name: str) -> Any:
        if name in NAMES:
            raise AttributeError(f"fx_membrane.{name} is now {NAMES[name]}; see 'Changes since 0.1.0' in the README")
        return get(name)

    return look_up
