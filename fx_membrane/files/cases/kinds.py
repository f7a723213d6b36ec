"""Kinds of tables that do not say theirs, or say it wrongly: the nearest one, so that the other keys can be checked."""

from __future__ import annotations

import copy
import difflib
from collections.abc import Mapping
from typing import Any, get_args

from pydantic import ValidationError

from .faults import OTHER_NAMES, without_tags
from .schema import CaseModel
from .table import Model
from .units import Units

MAX_NESTING = 4  # tables of a kind within each other


def with_kinds(data: Mapping[str, Any], units: Units | None) -> dict[str, Any]:
    """Copy of the data where tables without a known kind have the one of nearest name and keys."""
    guessed: dict[str, Any] = copy.deepcopy(dict(data))
    for _ in range(2 * MAX_NESTING):
        try:
            CaseModel.model_validate(guessed, context={"units": units})
        except ValidationError as error:
            wrong = [entry for entry in error.errors(include_url=False) if entry["type"].startswith("union_tag_")]
            mended = [_mended(entry, guessed) for entry in wrong]
            if not any(mended):
                return guessed
    return guessed


def _mended(entry: Any, data: Any) -> bool:
    """Give one table a kind; False if it is no table."""
    for key in without_tags(entry["loc"], data, False):
        data = data[key]
    tag = entry["ctx"]["discriminator"].strip("'")
    if not isinstance(data, dict):
        return False
    if tag not in data or not isinstance(data[tag], str):
        data[tag] = ""  # the next error names those that are expected
        return True
    if entry["type"] == "union_tag_not_found":
        return False
    expected = entry["ctx"]["expected_tags"].replace("'", "").split(", ")
    other = OTHER_NAMES.get(data[tag])
    data[tag] = other if other in expected else max(expected, key=lambda kind: _likeness(kind, tag, data))
    return True


def _likeness(kind: str, tag: str, table: Mapping[str, Any]) -> float:
    """Likeness of a kind to a table: by its name, and by the keys that they share or lack."""
    fields = next(
        model.model_fields
        for model in _models(Model)
        if tag in model.model_fields and kind in get_args(model.model_fields[tag].annotation)
    )
    lacking = sum(field.is_required() for name, field in fields.items() if name not in table)
    near = difflib.SequenceMatcher(None, kind, table[tag]).ratio()
    return 3 * near + len(fields.keys() & table.keys()) - lacking


def _models(model: type[Model]) -> list[type[Model]]:
    return [entry for child in model.__subclasses__() for entry in (child, *_models(child))]
