"""A published JSON Schema, documents that it accepts, and changes of one of them that it must refuse."""

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


class SchemaCase:
    """Tests of a unittest.TestCase that has `schema` (a name), `valid` (files), `base`, `malformed` [(path, value)]."""

    def test_every_document_is_valid(self):
        validator = validator_of(self.schema)
        self.assertGreaterEqual(len(self.valid), 6)
        for path in self.valid:
            with self.subTest(path.name):
                self.assertEqual([error.message for error in validator.iter_errors(json_of(path))], [])

    def test_malformed_documents_are_refused(self):
        validator = validator_of(self.schema)
        validator.validate(self.base)
        for path, value in self.malformed:
            with self.subTest("/".join(map(str, path)), value=value):
                self.assertFalse(validator.is_valid(changed(self.base, path, value)))
