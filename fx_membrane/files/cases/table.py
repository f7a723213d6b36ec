"""Tables of case files: keys that are not known are refused, and those with a fault leave the others to be checked."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    ValidatorFunctionWrapHandler,
    WrapValidator,
    model_validator,
)


class Broken:
    """Placeholder of a table, or of a value, that has a fault of its own: the others can be checked."""

    def __repr__(self) -> str:
        return "BROKEN"


BROKEN: Any = Broken()


def _lenient(info: ValidationInfo) -> bool:
    return bool(info.context and info.context.get("lenient"))


def _kept(value: Any, handler: ValidatorFunctionWrapHandler, info: ValidationInfo) -> Any:
    if value is BROKEN:
        return BROKEN
    try:
        return handler(value)
    except ValidationError:
        if not _lenient(info):
            raise
        return BROKEN


Kept = WrapValidator(_kept)  # with context["lenient"] a table with a fault becomes BROKEN


class Model(BaseModel):
    """A table of a case file: keys that it does not know are refused.

    With context["lenient"] these are left out, and values with a fault are BROKEN, as those of missing keys.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    @model_validator(mode="wrap")
    @classmethod
    def _without_faults(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        try:
            return handler(data)
        except ValidationError:
            if not _lenient(info) or not isinstance(data, dict):
                raise
        asked = [name for name, field in cls.model_fields.items() if name in data or field.is_required()]
        return cls.model_construct(**{name: cls._value(name, data.get(name, BROKEN), info.context) for name in asked})

    @classmethod
    def _value(cls, name: str, value: Any, context: Any) -> Any:
        if value is BROKEN:
            return BROKEN
        try:
            return _adapter(cls, name).validate_python(value, context=context)
        except ValidationError:
            return BROKEN


@cache
def _adapter(model: type[Model], name: str) -> TypeAdapter[Any]:
    """Make the validator of the value of one key."""
    field = model.model_fields[name]
    kind: Any = field.annotation
    if field.discriminator:
        kind = Annotated[kind, Field(discriminator=field.discriminator)]
    for entry in field.metadata:
        kind = Annotated[kind, entry]
    return TypeAdapter(kind)


def is_whole(value: Any) -> bool:
    """Tell if nothing of a value, table or list is BROKEN."""
    if isinstance(value, Model):
        return all(is_whole(getattr(value, name)) for name in value.model_fields_set)
    if isinstance(value, dict):
        return all(map(is_whole, value.values()))
    return all(map(is_whole, value)) if isinstance(value, list | tuple) else value is not BROKEN


def given(table: Model, *without: str) -> dict[str, Any]:
    """Values that a table gives, apart from some keys: the package has the defaults."""
    return {name: getattr(table, name) for name in table.model_fields_set if name not in without}


def one_of(table: Any, *keys: str, needed: bool = False) -> str:
    """Refuse a table that gives several of some keys, or none; return the one given, empty for none.

    Raises:
        ValueError: It does.
    """
    found = [key for key in keys if getattr(table, key) is not None]
    if len(found) > 1 or (needed and not found):
        raise ValueError(f"give one of {', '.join(keys)}" + (f", not {' and '.join(found)}" if found else ""))
    return found[0] if found else ""


def sound(tables: Any) -> Any:
    """Entries of a dictionary, or numbered ones of a list, that have no fault of their own."""
    if tables is BROKEN:
        return []
    entries = tables.items() if isinstance(tables, dict) else enumerate(tables)
    return [entry for entry in entries if entry[1] is not BROKEN]
