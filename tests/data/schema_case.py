"""The published JSON Schemas, and changes of documents that they must refuse."""

import copy
import json
from pathlib import Path

import jsonschema

FORMATS = Path(__file__).resolve().parents[2] / "docs" / "formats"
REMOVED = object()


def json_of(path: Path):
    return json.loads(path.read_text(encoding="utf-8"))


def changed(document, path, value):
    """A copy of `document` with the member at `path` set to `value`, or taken away where that is REMOVED."""
    document = copy.deepcopy(document)
    parent = document
    for key in path[:-1]:
        parent = parent[key]
    if value is REMOVED:
        del parent[path[-1]]
    else:
        parent[path[-1]] = value
    return document


def validator_of(name: str):
    """Of a file of docs/formats/."""
    path = FORMATS / f"{name}.schema.json"
    schema = json_of(path)
    jsonschema.Draft202012Validator.check_schema(schema)
    resolver = jsonschema.RefResolver(base_uri=path.as_uri(), referrer=schema)
    return jsonschema.Draft202012Validator(schema, resolver=resolver)
