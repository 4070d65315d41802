#!/usr/bin/python3
"""The extract of recorded contact problems that is kept here: extract.py FULL_SET.jsonl.gz > contact_problems.jsonl.gz

Scenes are kept whole, because tests compare the records of a scene with each other: every scene whose problems have
at most 10 rows, and of the others, in the order of their first records, each fifth. Records stay as they are."""

import gzip
import json
import sys

_SMALL = 10  # rows
_EACH = 5


def extract(lines):
    records = [json.loads(line) for line in lines]
    most_rows = {}  # by scene, in the order of first records
    for record in records:
        most_rows[record["scene"]] = max(most_rows.get(record["scene"], 0), record["n"])
    large = [scene for scene, rows in most_rows.items() if rows > _SMALL]
    kept = set(most_rows) - set(large) | set(large[::_EACH])
    return [line for line, record in zip(lines, records) if record["scene"] in kept]


if __name__ == "__main__":
    with gzip.open(sys.argv[1]) as full:
        kept = b"".join(extract(full.readlines()))
    sys.stdout.buffer.write(gzip.compress(kept, 9, mtime=0))  # without a time: the same bytes again
