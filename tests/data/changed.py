"""Documents with one change, for tests that a schema refuses it."""

import copy

REMOVED = object()


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
