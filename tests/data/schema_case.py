"""The published JSON Schemas, and changes of documents that they must refuse."""

import json
from pathlib import Path

import jsonschema

FORMATS = Path(__file__).resolve().parents[2] / "docs" / "formats"
REMOVED = object()


def json_of(path: Path):
    return json.loads(path.read_text(encoding="utf-8"))


def changed(document, path, value):
    """`document` with the member at `path` set to `value`, or taken away where that is REMOVED; all else is shared."""
    document, (key, *rest) = document.copy(), path
    if rest:
        document[key] = changed(document[key], rest, value)
    elif value is REMOVED:
        del document[key]
    else:
        document[key] = value
    return document


def validator_of(name: str):
    """Of a file of docs/formats/."""
    path = FORMATS / f"{name}.schema.json"
    schema = json_of(path)
    jsonschema.Draft202012Validator.check_schema(schema)
    resolver = jsonschema.RefResolver(base_uri=path.as_uri(), referrer=schema)
    return jsonschema.Draft202012Validator(schema, resolver=resolver)
