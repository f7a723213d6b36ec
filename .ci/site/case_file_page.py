"""Reference of the case file, from its JSON schema."""

import json

from fx_membrane.files.cases.schema import json_schema


def link(reference):
    """Link to the table that a reference of the schema points at."""
    name = reference.rsplit("/", 1)[-1]
    return f"[{name}](#{name.lower()})"


def kind(entry):
    """Values that a key takes, in words."""
    form = next((name for name in WORDS if name in entry), "type")
    return WORDS[form](entry)


def typed(entry):
    """Words for a plain type, a list, or a table by name."""
    if entry.get("type") == "array":
        return f"list of {kind(entry.get('items', {}))}"
    if entry.get("type") == "object" and isinstance(entry.get("additionalProperties"), dict):
        return f"table by name of {kind(entry['additionalProperties'])}"
    words = entry.get("type", "any value")
    examples = ", ".join(f"`{json.dumps(value)}`" for value in entry.get("examples", []))
    return (words if isinstance(words, str) else " or ".join(words)) + (f", as {examples}" if examples else "")


def one_of(choices):
    """Words for several choices; null is only the default of optional keys."""
    return " or ".join(dict.fromkeys(kind(one) for one in choices if one.get("type") != "null"))


WORDS = {
    "$ref": lambda entry: link(entry["$ref"]),
    "anyOf": lambda entry: one_of(entry["anyOf"]),
    "oneOf": lambda entry: one_of(entry["oneOf"]),
    "const": lambda entry: f"`{json.dumps(entry['const'])}`",
    "enum": lambda entry: ", ".join(f"`{json.dumps(value)}`" for value in entry["enum"]),
    "prefixItems": lambda entry: "[" + ", ".join(kind(one) for one in entry["prefixItems"]) + "]",
    "type": typed,
}


def table(model):
    """Keys of a model: value, default, description."""
    lines = ["| key | value | default |", "|---|---|---|"]
    required = model.get("required", [])
    for key, entry in model.get("properties", {}).items():
        if key in required:
            default = "required"
        else:
            default = "" if entry.get("default") in (None, [], {}) else f"`{json.dumps(entry['default'])}`"
        words = kind(entry).replace("|", "\\|")
        note = f"; {entry['description']}" if entry.get("description") else ""
        lines.append(f"| `{key}` | {words}{note} | {default} |")
    return "\n".join(lines)


def page():
    """Markdown of the whole reference."""
    whole = json_schema()
    blocks = [
        "# Case file\n\nA case file is TOML. `fx-membrane schema` prints the JSON schema from which this page is made; "
        '`fx-membrane init` writes a small case to begin with. Numbers with units are texts, as `"2 kN/m"`; plain '
        "numbers are in the units of the table `units`. `fx-membrane check` tells all faults at once, in the order of "
        "their lines, as `file:line: key: value, remedy`; rows of lists count from 0, as in `stages.0.loads.1.part`.\n",
        f"## Tables of the file\n\n{table(whole)}\n",
    ]
    for name, model in sorted(whole["$defs"].items()):
        blocks.append(f"## {name}\n\n{model.get('description', '')}\n\n{table(model)}\n")
    return "\n".join(blocks)
