"""Keys that a table of a case file may have, by the path of the table in the JSON schema."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any

from .schema import json_schema


def keys_at(data: Any, path: tuple[str | int, ...]) -> list[str]:
    """Keys of a table of a file; of all kinds that it can be if it does not say its own.

    Args:
        data: The tables of the file.
        path: Keys and rows of the table from the top.
    """
    schemas = [_schema()]
    for step in (None, *path):
        if step is not None:
            schemas = [entry for schema in schemas for entry in _below(schema, step)]
            try:
                data = data[step]
            except (KeyError, IndexError, TypeError):
                data = None
        schemas = [entry for schema in schemas for entry in _alternatives(schema, data)]
    return list(dict.fromkeys(key for schema in schemas for key in schema.get("properties", ())))


@cache
def _schema() -> dict[str, Any]:
    return json_schema()


def _below(schema: dict[str, Any], step: str | int) -> list[Any]:
    """Schemas of an entry of a table or a list."""
    if isinstance(step, int):
        found = schema.get("items")
    else:
        found = schema.get("properties", {}).get(step) or schema.get("additionalProperties")
    return [found] if isinstance(found, dict) else []


def _alternatives(schema: dict[str, Any], data: Any) -> Iterator[dict[str, Any]]:
    """Schemas without references and choices; that of its kind for a table that says it."""
    if "$ref" in schema:
        yield from _alternatives(_schema()["$defs"][schema["$ref"].rpartition("/")[2]], data)
        return
    mapping = schema.get("discriminator", {})
    kind = data.get(mapping.get("propertyName")) if isinstance(data, dict) else None
    if isinstance(kind, str) and kind in mapping.get("mapping", {}):
        yield from _alternatives({"$ref": mapping["mapping"][kind]}, data)
        return
    choices = [*schema.get("oneOf", ()), *schema.get("anyOf", ())]
    if not choices:
        yield schema
    for choice in choices:
        yield from _alternatives(choice, data)
